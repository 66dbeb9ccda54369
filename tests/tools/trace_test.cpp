// --trace: where it goes, how it is bounded, and that it changes nothing.
#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <string>

#include "tests/tools/run_shell.h"

using pmac::test::program;
using pmac::test::ToolResult;
using pmac::test::Workspace;

namespace {

std::ptrdiff_t line_count(const std::string& text) { return std::count(text.begin(), text.end(), '\n'); }

}  // namespace

TEST_CASE("option trace writes to standard output or to a file, and the run stays the same", "[tools]") {
  const Workspace w;
  const std::string run = program("02_basic_moves.pmc") + " -e '&1b1r'";
  const ToolResult shown = w.run("pmac-run", run + " --trace --record traced.csv");
  REQUIRE(shown.code == 0);
  REQUIRE(w.run("pmac-run", run + " --trace=trace.txt --json=summary").code == 0);
  CHECK(w.read("trace.txt") == shown.out);
  REQUIRE(w.run("pmac-run", run + " --record plain.csv").code == 0);
  CHECK(w.read("traced.csv") == w.read("plain.csv"));
}

TEST_CASE("option trace is bounded: the run goes on to its end without it", "[tools]") {
  const Workspace w;
  w.write("loop.pmc", "open prog 1\nP1 = 0\nwhile (P1 < 5000) P1++\nsend 1 \"done\"\nclose\n");
  const ToolResult r = w.run("pmac-run", "loop.pmc -e '&1b1r' --trace=trace.txt --trace-limit 100 -e 'Coord[1].GoBack=100000'");
  CHECK(r.code == 0);
  CHECK(line_count(w.read("trace.txt")) == 101);
  CHECK(r.err.find("the trace ends after 100 records") != std::string::npos);
  CHECK(r.out.find("done") != std::string::npos);
}

TEST_CASE("option trace ends with the line of a fault", "[tools]") {
  const Workspace w;
  w.write("fault.pmc", "&1 #1->1000X\nopen prog 1\nP1 = -5\nlinear abs F(P1)\nX10\nclose\n");
  const ToolResult r = w.run("pmac-run", "fault.pmc -e '&1b1r' --trace=trace.txt");
  CHECK(r.code == 3);
  const std::string trace = w.read("trace.txt");
  const std::size_t last = trace.rfind('\n', trace.size() - 2) + 1;
  CHECK(trace.substr(last).find("fault.pmc:4:") != std::string::npos);
}

TEST_CASE("option trace refuses what it cannot share or write", "[tools]") {
  const Workspace w;
  const std::string run = program("02_basic_moves.pmc") + " -e '&1b1r'";
  CHECK(w.run("pmac-run", run + " --trace --json").code == 2);
  CHECK(w.run("pmac-run", run + " --trace --emit=path").code == 2);
  CHECK(w.run("pmac-run", run + " --trace-instructions").code == 2);
  CHECK(w.run("pmac-run", run + " --trace=no_such_folder/trace.txt").code == 2);
  CHECK(w.run("pmac-run", run + " --trace=same.csv --record same.csv").code == 2);
}
