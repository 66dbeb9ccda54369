// Bad input of every kind: a clear message, the right exit code, never a crash or a hang.
#include <catch2/catch.hpp>
#include <filesystem>
#include <random>

#include "tests/tools/run_shell.h"

using pmac::test::program;
using pmac::test::ToolResult;
using pmac::test::Workspace;

namespace {

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("programs with errors are refused with place and remedy, exit 1", "[tools]") {
  struct Row { const char* text; const char* place; const char* message; };
  const Row rows[] = {
      {"open prog 1\nlinear\nwhile (P1 < 3) {\nX10\nclose\n", "bad.pmc:5:1: error:", "missing }"},
      {"open prog 1\nlinaer\nX10\nclose\n", "bad.pmc:2:1: error:", "did you mean 'linear'"},
      {"open prog 1\nX(Speed)\nclose\n", "bad.pmc:2:3: error:", "'Speed' is not declared"},
      {"open prog 1\nX10 E5\nclose\n", "bad.pmc:2:5: error:", "axis"},
      {"open prog 1\nX1\nopen prog 2\nX10\nclose\n", "bad.pmc:3:1: error:", "open inside an open buffer"},
      {"open prog 1\ncircle1 X10 Y0\nclose\n", "bad.pmc:2:9: error:", "without a centre"},
      {"open prog 1\nF-50\nclose\n", "bad.pmc:2:2: error:", "negative"},
      {"open prog 1\nif (P1=3) X5\nclose\n", "bad.pmc:2:7: error:", "=="},
  };
  const Workspace w;
  for (const Row& row : rows) {
    INFO(row.text);
    w.write("bad.pmc", row.text);
    for (const char* tool : {"pmacc", "pmac-run"}) {
      const ToolResult r = w.run(tool, "bad.pmc");
      CHECK(r.code == 1);
      INFO(r.err);
      CHECK(contains(r.err, row.place));
      CHECK(contains(r.err, row.message));
      CHECK(contains(r.err, "^"));  // the caret under the source line
    }
  }
}

TEST_CASE("all errors of a file come in one run", "[tools]") {
  const Workspace w;
  w.write("bad.pmc", "open prog 1\nX(One)\nX(Two)\nlinaer\nF-1\nclose\n");
  const ToolResult r = w.run("pmacc", "--check bad.pmc");
  CHECK(r.code == 1);
  for (const char* place : {"bad.pmc:2:3", "bad.pmc:3:3", "bad.pmc:4:1", "bad.pmc:5:2"}) CHECK(contains(r.err, place));
}

TEST_CASE("an error in a macro shows both places", "[tools]") {
  const Workspace w;
  w.write("bad.pmc", "#define WRONG X10 )\nopen prog 1\nWRONG\nclose\n");
  const ToolResult r = w.run("pmacc", "--check bad.pmc");
  CHECK(r.code == 1);
  CHECK(contains(r.err, "bad.pmc:3:1: error"));
  CHECK(contains(r.err, "bad.pmc:1:"));
  CHECK(contains(r.err, "WRONG"));
}

TEST_CASE("the traps of the published examples are warnings with a correction", "[tools]") {
  const Workspace w;
  w.write("a.pmc", "#define lookahead 3000\n/*****\nopen prog 1\nX10\nclose\n*****/\n");
  const ToolResult r = w.run("pmacc", "--check a.pmc");
  CHECK(r.code == 0);
  CHECK(contains(r.err, "a.pmc:1:1: warning"));
  CHECK(contains(r.err, "&1 define lookahead 3000"));
  CHECK(contains(r.err, "a.pmc:2:1: warning"));
}

TEST_CASE("a division by zero in a move is a fault at its line, exit 3", "[tools]") {
  const Workspace w;
  w.write("a.pmc", "&1 #1->1000X\nopen prog 1\nX5\nX(10/P1)\nclose\n");
  const ToolResult r = w.run("pmac-run", "a.pmc -e '&1b1r' --json=summary");
  CHECK(r.code == 3);
  CHECK(contains(r.err, "a.pmc:4: fault"));
  CHECK(contains(r.err, "axis X"));
  CHECK(contains(r.out, "\"status\": \"fault\""));
}

TEST_CASE("words that do not belong to the mode are a fault, never ignored", "[tools]") {
  const Workspace w;
  w.write("a.pmc", "&1 #1->1000X #2->1000Y Coord[1].SegMoveTime=5\nopen prog 1\nlinear F10\nX5:3\nclose\n");
  CHECK(contains(w.run("pmac-run", "a.pmc -e '&1b1r'").err, "a.pmc:4"));
  w.write("b.pmc", "&1 #1->1000X #2->1000Y Coord[1].SegMoveTime=5\nopen prog 1\nF10 normal k-1\ncircle1 X10 Y0 II5 JJ0\nclose\n");
  CHECK(contains(w.run("pmac-run", "b.pmc -e '&1b1r'").err, "b.pmc:4"));
}

TEST_CASE("a computed negative feed rate is a fault, exit 3", "[tools]") {
  const Workspace w;
  w.write("a.pmc", "&1 #1->1000X\nopen prog 1\nF(P1-5)\nX5\nclose\n");
  const ToolResult r = w.run("pmac-run", "a.pmc -e '&1b1r'");
  CHECK(r.code == 3);
  CHECK(contains(r.err, "a.pmc:3: fault"));
}

TEST_CASE("an endless empty loop ends at the time limit with its place, exit 4, and everything written", "[tools]") {
  const Workspace w;
  w.write("a.pmc", "&1 #1->1000X\nopen prog 1\nX1\nwhile(1){}\nclose\n");
  const ToolResult r = w.run("pmac-run", "a.pmc -e '&1b1r' --max-time 5 --record r.csv --json");
  CHECK(r.code == 4);
  CHECK(contains(r.err, "time limit"));
  CHECK(contains(r.err, "prog 1 at a.pmc:4"));
  CHECK(contains(r.out, "\"status\": \"time-limit\""));
  const std::string csv = w.read("r.csv");
  CHECK(std::count(csv.begin(), csv.end(), '\n') == 1 + 1 + 11294);  // names, t = 0, ceil(5000 ms / 0.44274211 ms) ticks
}

TEST_CASE("an endless loop of assignments ends at the time limit, too", "[tools]") {
  const Workspace w;
  w.write("a.pmc", "open prog 1\nwhile(1){P1=P1+1 goto 5 N5:}\nclose\n");
  CHECK(w.run("pmac-run", "a.pmc -e '&1b1r' --max-time 2").code == 4);
  w.write("b.pmc", "open prog 1\nN1: dwell 0 goto 1\nclose\n");
  CHECK(w.run("pmac-run", "b.pmc -e '&1b1r' --max-time 2").code == 4);
}

TEST_CASE("truncated and bit-flipped object files are refused, exit 2", "[tools]") {
  const Workspace w;
  REQUIRE(w.run("pmacc", program("07_oval_lookahead.pmc") + " -o whole.pmx").code == 0);
  const std::string whole = w.read("whole.pmx");
  REQUIRE(whole.size() > 500);
  CHECK(w.run("pmac-run", "whole.pmx -e '&1b5r'").code == 0);
  for (const std::size_t length : {std::size_t{0}, std::size_t{1}, std::size_t{16}, whole.size() / 2, whole.size() - 1}) {
    w.write("cut.pmx", whole.substr(0, length));
    const ToolResult r = w.run("pmac-run", "cut.pmx");
    CHECK(r.code == 2);
    CHECK(contains(r.err, "cut.pmx"));
  }
  std::mt19937 random(42);
  for (int i = 0; i < 30; ++i) {
    std::string flipped = whole;
    flipped[random() % flipped.size()] ^= static_cast<char>(1u << random() % 8);
    w.write("flipped.pmx", flipped);
    const ToolResult r = w.run("pmac-run", "flipped.pmx");
    CHECK(r.code == 2);
    CHECK_FALSE(r.err.empty());
  }
}

TEST_CASE("usage and files that cannot be read: exit 2", "[tools]") {
  const Workspace w;
  CHECK(w.run("pmac-run", "nofile.pmc").code == 2);
  CHECK(w.run("pmac-run", ".").code == 2);
  CHECK(w.run("pmac-run", "--no-such-option x.pmc").code == 2);
  CHECK(w.run("pmac-run", "").code == 2);
  CHECK(w.run("pmacc", "nofile.pmc").code == 2);
  w.write("a.pmc", "open prog 1\nclose\n");
  CHECK(w.run("pmac-run", "a.pmc --at soon 'P1=1'").code == 2);
  CHECK(w.run("pmac-run", "a.pmc --record table.xyz").code == 2);
  CHECK(w.run("pmac-run", "a.pmc --record /no/such/folder/r.csv").code == 2);
  CHECK(w.run("pmac-run", "--help").code == 0);
  CHECK(contains(w.run("pmac-run", "--help").out, "Examples:"));
  CHECK(contains(w.run("pmacc", "--help").out, "Examples:"));
}

TEST_CASE("moves that take no time, without end, are a fault and no hang", "[tools]") {
  const Workspace w;
  w.write("a.pmc", "&1 #1->1000X\nopen prog 1\nlinear ta0 ts0 F10\nwhile(1){X0}\nclose\n");
  const ToolResult r = w.run("pmac-run", "a.pmc -e '&1b1r' --max-time 1");
  CHECK(r.code == 3);
  CHECK(contains(r.err, "took no time"));
}

TEST_CASE("a move that would need millions of segments, a speed of 0 and a set-up of nan are named", "[tools]") {
  const Workspace w;
  w.write("a.pmc", "&1 #1->1000X Coord[1].SegMoveTime=5\nopen prog 1\nlinear F10 X1e9\nclose\n");
  CHECK(w.run("pmac-run", "a.pmc -e '&1b1r'").code == 3);
  w.write("b.pmc", "&1 #1->1000X Motor[1].MaxSpeed=0\nopen prog 1\nrapid X10\nclose\n");
  const ToolResult r = w.run("pmac-run", "b.pmc -e '&1b1r' --json=summary");
  CHECK(r.code == 3);
  CHECK(contains(r.err, "MaxSpeed"));
  CHECK(contains(r.out, "\"final\": 0.0"));
  CHECK(contains(w.run("pmac-run", "b.pmc -e 'Motor[1].JogTa=0/0'").err, "error #23"));
  CHECK(contains(w.run("pmac-run", "b.pmc -e 'Motor[1].JogSpeed=0 #1j=100'").err, "JogSpeed"));
}

TEST_CASE("very long lines and deep macro calls are refused quickly", "[tools]") {
  const Workspace w;
  std::string line = "open prog 1\n";
  for (int i = 0; i < 100000; ++i) line += "X1 ";
  w.write("line.pmc", line + "\nclose\n");
  CHECK(w.run("pmacc", "--check line.pmc").code == 1);
  std::string calls = "#define F(x) x\nP1=";
  for (int i = 0; i < 20000; ++i) calls += "F(";
  calls += "1" + std::string(20000, ')') + "\n";
  w.write("macro.pmc", calls);
  CHECK(w.run("pmacc", "--check macro.pmc").code == 1);
}

TEST_CASE("an output never replaces an input or another output", "[tools]") {
  const Workspace w;
  w.write("a.csv", "&1 #1->X\nopen prog 1\nX1\nclose\n");
  CHECK(w.run("pmac-run", "a.csv -e '&1b1r' --record a.csv").code == 2);
  CHECK(w.run("pmac-run", "a.csv -e '&1b1r' --record r.csv --gather r.csv").code == 2);
  CHECK(w.run("pmacc", "a.csv -o a.csv").code == 2);
  CHECK(contains(w.read("a.csv"), "open prog 1"));
}

TEST_CASE("refused commands are named with the controller's number, exit 3, and the rest goes on", "[tools]") {
  const Workspace w;
  w.write("a.pmc", "&1 #1->1000X\nopen prog 1\nX1\nclose\n");
  const ToolResult r = w.run("pmac-run", "a.pmc -e '&1b77r' -e 'nonsense' -e '&1b1r' --json=summary");
  CHECK(r.code == 3);
  CHECK(contains(r.err, "error #22"));
  CHECK(contains(r.err, "error #20"));
  CHECK(contains(w.run("pmac-run", "a.pmc --at 0.001 'Out3=1'").err, "'Out3' is not declared"));
  CHECK(contains(r.out, "\"final\": 1000.0"));
}

TEST_CASE("a circle without segmentation is said to be a straight line", "[tools]") {
  const Workspace w;
  w.write("a.pmc", "&1 #1->1000X #2->1000Y\nopen prog 1\nF10 normal k-1\ncircle1 X10 Y0 I5 J0\nclose\n");
  const ToolResult r = w.run("pmac-run", "a.pmc -e '&1b1r' --json");
  CHECK(r.code == 0);
  CHECK(contains(r.err, "a.pmc:4: warning"));
  CHECK(contains(r.err, "SegMoveTime"));
}

TEST_CASE("pmacc writes to a device and leaves it one", "[tools]") {
  const Workspace w;
  w.write("a.pmc", "open prog 1\nlinear\nX1\nclose\n");
  std::filesystem::create_symlink("/dev/full", w.path("full.pmx"));
  const ToolResult full = w.run("pmacc", "a.pmc -o full.pmx");
  CHECK(full.code == 2);
  CHECK(contains(full.err, "cannot write"));
  CHECK(std::filesystem::is_character_file("/dev/full"));
  CHECK(w.run("pmacc", "a.pmc -o /dev/null").code == 0);
  CHECK(std::filesystem::is_character_file("/dev/null"));
}

TEST_CASE("a register script without a write is an error", "[tools]") {
  const Workspace w;
  for (const std::string& text : {std::string(), std::string("\0\1\2", 3), std::string("; a comment alone\n")}) {
    w.write("n.mcx", text);
    const ToolResult r = w.run("pmac-run", "n.mcx");
    CHECK(r.code == 1);
    CHECK(contains(r.err, "n.mcx:1:1: error: this script writes no register"));
  }
}

TEST_CASE("a whole circle from a point of an axis is one drive command", "[tools]") {
  const Workspace w;
  w.write("q.pmc", "&1 #1->X #2->Y\nCoord[1].SegMoveTime=5\nopen prog 1\nnormal K-1 abs ta0 ts0 F1000\ncircle2 X0 Y0 I1000 J0\nclose\n");
  const ToolResult r = w.run("pmac-run", "q.pmc -e '&1b1r' --drive mcx514 --emit=frames");
  CHECK(r.code == 0);
  CHECK(contains(r.out, "WR0 <- 0065h"));
  CHECK_FALSE(contains(r.out, "WR0 <- 0061h"));
}
