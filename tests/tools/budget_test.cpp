// Every limit of a run and of a compilation, reached: exit code, the words, and what was written so far is whole.
#include <catch2/catch.hpp>

#include "tests/tools/run_shell.h"

using pmac::test::ToolResult;
using pmac::test::Workspace;

namespace {

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// Endless moves between two points.
constexpr const char* kEndless = "&1 #1->1000X\nCoord[1].SegMoveTime=5\nopen prog 1\nlinear abs ta1 ts0 F1000\nwhile (1)\n{\nX1\nX0\n}\nclose\n";

/// Rows of a table that all have as many values as the header has names; 0 where one has not.
std::size_t whole_rows(const std::string& csv) {
  if (csv.empty() || csv.back() != '\n') return 0;
  std::size_t rows = 0, commas = 0, expected = 0;
  for (const char c : csv) {
    commas += c == ',';
    if (c != '\n') continue;
    if (rows++ == 0) expected = commas;
    else if (commas != expected) return 0;
    commas = 0;
  }
  return rows - 1;
}

struct Limit { const char* options; const char* says; };

}  // namespace

TEST_CASE("budgets: each limit ends the run with exit 4, and the record is whole", "[tools]") {
  const Workspace w;
  w.write("endless.pmc", kEndless);
  const Limit limits[] = {
      {"--max-time 2", "the time limit of 2 s is reached (--max-time)"},
      {"--max-instructions 20000", "the limit of 20000 instructions is reached (--max-instructions)"},
      {"--max-moves 500", "the limit of 500 moves is reached (--max-moves)"},
      {"--max-output 1", "the limit of 1 MiB of output is reached (--max-output)"},
      {"--min-free 1073741824", "less than 1073741824 MiB are free on the disk of r.csv (--min-free)"},
      {"--max-memory 1", "the limit of 1 MiB of memory is reached (--max-memory)"},
  };
  for (const Limit& limit : limits) {
    INFO(limit.options);
    const ToolResult r = w.run("pmac-run", std::string("endless.pmc -e '&1 b1r' --record r.csv --json=summary ") + limit.options);
    INFO(r.err);
    CHECK(r.code == 4);
    CHECK(contains(r.err, limit.says));
    CHECK(contains(r.err, "still running: prog 1 at endless.pmc:"));
    CHECK(contains(r.out, "\"status\": "));
    CHECK(whole_rows(w.read("r.csv")) > 0);
  }
}

TEST_CASE("budgets: the limit of moves is kept closely", "[tools]") {
  const Workspace w;
  w.write("endless.pmc", kEndless);
  const ToolResult r = w.run("pmac-run", "endless.pmc -e '&1 b1r' --max-moves 500 --json");
  std::size_t moves = 0;
  for (std::size_t at = r.out.find("\"mode\""); at != std::string::npos; at = r.out.find("\"mode\"", at + 1)) ++moves;
  CHECK(moves > 500);
  CHECK(moves < 1500);
}

TEST_CASE("budgets: a disk of which little is free ends a run that prints to a file, and none that prints to a pipe", "[tools]") {
  const Workspace w;
  w.write("endless.pmc", kEndless);
  const std::string run = "endless.pmc -e '&1 b1r' --max-output 4 --min-free 1073741824 --emit=path";
  const ToolResult to_file = w.run("pmac-run", run);   // the shell of this test has files
  CHECK(to_file.code == 4);
  CHECK(contains(to_file.err, "free on the disk of standard output (--min-free)"));
  w.shell("pmac-run " + run + " 2> messages.txt | tail -n 1");
  CHECK(contains(w.read("messages.txt"), "the limit of 4 MiB of output is reached (--max-output)"));
}

TEST_CASE("budgets: printed stages count as output", "[tools]") {
  const Workspace w;
  w.write("endless.pmc", kEndless);
  const ToolResult r = w.run("pmac-run", "endless.pmc -e '&1 b1r' --emit=path --max-output 1");
  CHECK(r.code == 4);
  CHECK(r.out.size() > (1u << 20));
  CHECK(r.out.size() < (8u << 20));
  CHECK(r.out.back() == '\n');
}

TEST_CASE("budgets: depth of #include", "[tools]") {
  const Workspace w;
  w.write("a.pmc", "#include \"b.pmh\"\n");
  w.write("b.pmh", "#include \"c.pmh\"\n");
  w.write("c.pmh", "P1=1\n");
  for (const char* tool : {"pmacc", "pmac-run"}) {
    CHECK(w.run(tool, "a.pmc").code == 0);
    const ToolResult r = w.run(tool, "a.pmc --max-include-depth 1");
    CHECK(r.code == 1);
    CHECK(contains(r.err, "b.pmh:1:10: error: #include is nested more than 1 deep"));
  }
}

TEST_CASE("budgets: a limit that is no number is a usage error", "[tools]") {
  const Workspace w;
  w.write("a.pmc", "P1=1\n");
  for (const char* bad : {"--max-moves x", "--max-moves -1", "--max-memory 0", "--min-free -1", "--max-output 9999999999999", "--max-include-depth 0", "--max-include-depth 1000", "--max-time -1"}) {
    INFO(bad);
    CHECK(w.run("pmac-run", std::string("a.pmc ") + bad).code == 2);
  }
}
