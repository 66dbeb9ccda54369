// A run that is ended from outside: by a signal, by a reader that goes away, by a full disk.
#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <string>

#include "tests/tools/run_shell.h"

using pmac::test::program;
using pmac::test::ToolResult;
using pmac::test::Workspace;

namespace {

constexpr const char* kMachine = "&1 #1->1000X #2->1000Y\nMotor[1].MaxSpeed=500 Motor[2].MaxSpeed=500 Motor[1].InvAmax=1 Motor[2].InvAmax=1\n";

/// A million right angles with a lookahead that wants to know 200,000 segments before anything moves.
std::string long_planning() {
  return std::string(kMachine) + "&1 define lookahead 200000,100\nCoord[1].SegMoveTime=1 Coord[1].LHDistance=200000\n"
         "open prog 1\nlinear abs ta1 ts0 F100\nP1=0\nwhile(P1<1000000){X(P1) Y(P1&1) P1++}\nclose\n";
}

struct Interrupted { ToolResult result; double seconds_after_signal = 0; };

/// SIGTERM some time after the run has opened its trace, which it does before anything else.
Interrupted interrupt(const Workspace& w, const std::string& arguments) {
  Interrupted run;
  run.result = w.shell("pmac-run " + arguments + " --trace=trace.txt --trace-limit 100 & run=$!\n"
                       "for i in $(seq 300); do ls trace.txt.partial-* >.found 2>/dev/null && break; sleep 0.1; done\n"
                       "sleep 1; kill -TERM $run; date +%s.%N > .signalled; wait $run; code=$?; date +%s.%N > .ended; exit $code");
  run.seconds_after_signal = std::stod(w.read(".ended")) - std::stod(w.read(".signalled"));
  return run;
}

/// Every row, the last one too, has as many cells as the first and ends its line.
void check_whole_table(const std::string& text) {
  REQUIRE_FALSE(text.empty());
  CHECK(text.back() == '\n');
  const std::size_t last = text.rfind('\n', text.size() - 2) + 1;
  const auto commas = [](const std::string& line) { return std::count(line.begin(), line.end(), ','); };
  CHECK(commas(text.substr(0, text.find('\n'))) == commas(text.substr(last)));
}

bool leaves_partial_files(const Workspace& w) {
  for (const auto& entry : std::filesystem::directory_iterator(w.path("")))
    if (entry.path().string().find("partial") != std::string::npos) return true;
  return false;
}

}  // namespace

TEST_CASE("a signal ends endless script loops and long planning within about a second, and what was written is whole", "[tools]") {
  const Workspace w;
  w.write("script_loop.pmc", std::string(kMachine) + "open prog 1\nwhile(1){P1++}\nclose\n");
  w.write("plc_loop.pmc", std::string(kMachine) + "open plc 1\nwhile(1){P1++}\nclose\nenable plc 1\n");
  w.write("empty_dwells.pmc", std::string(kMachine) + "open prog 1\nwhile(1){dwell 0}\nclose\n");
  w.write("one_long_move.pmc", std::string(kMachine) + "open prog 1\nlinear abs F0.001\nX1000\nclose\n");
  w.write("planning.pmc", long_planning());
  for (const std::string name : {"script_loop", "plc_loop", "empty_dwells", "one_long_move", "planning"}) {
    INFO(name);
    const Interrupted run = interrupt(w, name + ".pmc -e 'Coord[1].GoBack=2000000000 &1b1r' --until 1e8 --max-time 1e9 --record " + name + ".csv");
    CHECK(run.result.code == 130);
    CHECK(run.seconds_after_signal < 15);   // about one, and the machine that tests may be busy
    CHECK(run.result.err.find("interrupted at") != std::string::npos);
    check_whole_table(w.read(name + ".csv"));
  }
  CHECK_FALSE(leaves_partial_files(w));
}

TEST_CASE("a signal in the middle of jerk-limited planning leaves whole files", "[tools]") {
  const Workspace w;
  w.write("planning.pmc", long_planning());
  const Interrupted run = interrupt(w, "planning.pmc -e '&1b1r' --limit-jerk --record r.csv");
  CHECK(run.result.code == 130);
  CHECK(run.seconds_after_signal < 15);
  check_whole_table(w.read("r.csv"));
  CHECK(w.read("trace.txt").back() == '\n');
}

TEST_CASE("a reader that goes away ends the run with a message", "[tools]") {
  const Workspace w;
  w.write("one_long_move.pmc", std::string(kMachine) + "open prog 1\nlinear abs F0.001\nX1000\nclose\n");
  const ToolResult r = w.shell("set -o pipefail; pmac-run one_long_move.pmc -e '&1b1r' --max-time 1e9 --emit=servo | head -1");
  CHECK(r.code == 2);
  CHECK(r.err.find("standard output") != std::string::npos);
}

TEST_CASE("a full disk is an error with its name", "[tools]") {
  const Workspace w;
  const std::string run = program("02_basic_moves.pmc") + " -e '&1b1r'";
  std::filesystem::create_symlink("/dev/full", w.path("full.csv"));
  const ToolResult record = w.run("pmac-run", run + " --record full.csv");
  CHECK(record.code == 2);
  CHECK(record.err.find("No space left on device") != std::string::npos);
  const ToolResult trace = w.run("pmac-run", run + " --trace=/dev/full");
  CHECK(trace.code == 2);
  CHECK(trace.err.find("No space left on device") != std::string::npos);
  CHECK(w.shell("pmac-run " + run + " --trace > /dev/full").code == 2);
  CHECK(w.shell("pmac-run " + run + " --json > /dev/full").code == 2);
}
