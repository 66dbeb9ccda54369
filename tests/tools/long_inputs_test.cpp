// Inputs that once took time with the square of their length, or more: each entry answers them within a time that only grows with
// the length. The limit is one of processor time, far above what is needed and far below what the square would take.
#include <catch2/catch.hpp>

#include "tests/tools/run_shell.h"

using pmac::test::ToolResult;
using pmac::test::Workspace;

namespace {

std::string repeated(const std::string& part, int times) {
  std::string text;
  text.reserve(part.size() * static_cast<std::size_t>(times));
  for (int i = 0; i < times; ++i) text += part;
  return text;
}

std::string in_program(const std::string& text) { return "open prog 1\n" + text + "\nclose\n"; }

/// Every entry for script. 137 and 152 are the codes of a process that used up its processor time.
void check_every_entry(const std::string& what, const std::string& text, const std::string& limit_s = "60") {
  const Workspace w;
  w.write("long.pmc", text);
  for (const char* entry : {"pmacc long.pmc", "pmacc -E long.pmc", "pmacc fmt --stdout long.pmc", "pmac-run long.pmc", "pmac-run --console --max-time 1 < long.pmc"}) {
    INFO(what << ": " << entry);
    const ToolResult r = w.shell("ulimit -t " + limit_s + "; " + entry + " > out.txt 2> err.txt");
    CHECK(r.code <= 4);
  }
}

}  // namespace

TEST_CASE("long inputs: quotation marks that close nothing take no time with the square of their number", "[tools]") {
  check_every_entry("escaped marks", in_program(repeated("\\\"", 400'000)));
  check_every_entry("escaped marks over line ends", in_program(repeated("x\\\"\\\n", 400'000)));
}

TEST_CASE("long inputs: of two hundred thousand wrong drive writes of a register script the first hundred are shown", "[tools]") {
  const Workspace w;
  w.write("drives.mcx", repeated("WR0 <- 0061h\n", 200'000));
  const ToolResult r = w.shell("ulimit -t 30; pmac-run drives.mcx");
  CHECK(r.code == 1);
  CHECK(r.err.find("drives.mcx:100:1: error: ") != std::string::npos);
  CHECK(r.err.find("drives.mcx:101:") == std::string::npos);
  CHECK(r.err.find("199900 more problem(s) are not shown") != std::string::npos);
}

TEST_CASE("long inputs: comments and brackets on one line by the hundred thousand", "[tools]") {
  check_every_entry("comments", in_program(repeated("/**/", 400'000)));
  check_every_entry("comments that are not closed", in_program(repeated("/* ", 400'000)));
  check_every_entry("conditions that are not closed", in_program(repeated("if(", 400'000)));
  check_every_entry("calls and braces that are not closed", in_program(repeated("M({", 400'000)));
  check_every_entry("open without an end", in_program(repeated("open ", 400'000)));
}
