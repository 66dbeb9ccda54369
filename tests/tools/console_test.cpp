// pmac-run --console: a client's session over a pipe.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <vector>

#include "tests/tools/run_shell.h"

using pmac::test::ToolResult;
using pmac::test::Workspace;

namespace {

constexpr const char* kSetUp = "&1 #1->1000X #2->1000Y\nMotor[1].InvAmax=0.1 Motor[2].InvAmax=0.1 Motor[1].MaxSpeed=1000\n";

/// Answers by input line: what stands before each ACK.
std::vector<std::string> replies(const std::string& out) {
  std::vector<std::string> result;
  std::istringstream lines(out);
  std::string line, reply;
  std::getline(lines, line);
  REQUIRE(line.ends_with("STDIN Open for ASCII Input"));
  while (std::getline(lines, line)) {
    if (line != "\x06") {
      reply += line + "\n";
      continue;
    }
    result.push_back(reply);
    reply.clear();
  }
  CHECK(reply.empty());
  return result;
}

/// The numbers of a recording, without its heading.
std::vector<double> numbers(const std::string& csv) {
  std::vector<double> result;
  std::istringstream cells(csv.substr(csv.find('\n') + 1));
  for (std::string row; std::getline(cells, row);) {
    std::istringstream columns(row);
    for (std::string cell; std::getline(columns, cell, ',');) result.push_back(std::stod(cell));
  }
  return result;
}

std::vector<std::string> session(const Workspace& w, const std::string& input, const std::string& options = "") {
  w.write("set_up.pmc", kSetUp);
  w.write("input.txt", input);
  const ToolResult r = w.run("pmac-run", "set_up.pmc --console " + options + " < input.txt");
  INFO(r.err);
  CHECK(r.code == 0);
  return replies(r.out);
}

}  // namespace

TEST_CASE("console: every line is acknowledged, after answers and after errors", "[tools]") {
  const Workspace w;
  const auto r = session(w, "echo7\nSys.MaxMotors\n\nMotor[1].JogSpeed Motor[2].JogTa\nfoo\n  Motor[1].JogSped=3\n&1 b99 r\necho 0\nMotor[1].JogSpeed\n");
  REQUIRE(r.size() == 9);
  CHECK(r[0].empty());
  CHECK(r[1] == "33\n");
  CHECK(r[2].empty());
  CHECK(r[3] == "32\n-10\n");
  CHECK(r[4].starts_with("stdin:5:1: error #20: ILLEGAL CMD: "));
  CHECK(r[5].starts_with("stdin:6:3: error #20: ILLEGAL CMD: unknown element Motor[].JogSped; did you mean Motor[].JogSpeed?"));
  CHECK(r[6].starts_with("stdin:7:1: error #22: PROGRAM NOT IN BUFFER"));
  CHECK(r[8] == "Motor[1].JogSpeed=32\n");
}

TEST_CASE("console: a client sends a program, runs it and polls until it has ended", "[tools]") {
  // the commands of a public client's run_and_wait: names in lower case, begin and r in one word, name=value answers
  std::string input = "&1abort\nclose all buffers\nopen prog 10\nlinear abs ta100 ts0 F10\nX10\nclose\n&1begin10r\n";
  const int polls = 200;
  for (int i = 0; i < polls; ++i) input += "coord[1].progactive\n";
  input += "coord[1].errorstatus\n#1p\n";
  const Workspace w;
  const auto r = session(w, input);
  REQUIRE(r.size() == 7u + polls + 2u);
  CHECK(r[7] == "Coord[1].ProgActive=1\n");
  // 10 units at 10 units/s and 100 ms of acceleration: 1.1 s, 110 lines of 10 ms
  CHECK(r[7 + 100] == "Coord[1].ProgActive=1\n");
  CHECK(r[7 + 125] == "Coord[1].ProgActive=0\n");
  CHECK(r[7 + polls] == "Coord[1].ErrorStatus=0\n");
  CHECK(r[7 + polls + 1] == "10000\n");
}

TEST_CASE("console: lines of a buffer keep their numbers in errors and in list", "[tools]") {
  const Workspace w;
  const auto r = session(w, "P1=1\nopen prog 3\nlinear\nX10 E5\nclose\nopen prog 4\nlinear   // here\nX1\nclose\nlist prog 4\nlist prog 3\n");
  REQUIRE(r.size() == 11);
  CHECK(r[1].empty());
  CHECK(r[4].starts_with("stdin:4:5: error #"));
  CHECK(r[8].empty());
  CHECK(r[9] == "linear   // here\nX1\n");
  CHECK(r[10].starts_with("stdin:11:1: error #22: PROGRAM NOT IN BUFFER"));
}

TEST_CASE("console: simulated time passes between lines, and as much as is asked for", "[tools]") {
  const Workspace w;
  const auto r = session(w, "Sys.Time\nSys.Time\nwait 990\nSys.Time\n#1j=1000\nwait idle\n#1p\n", "--console-step 5");
  REQUIRE(r.size() == 7);
  CHECK(r[0] == "Sys.Time=0\n");
  CHECK(std::stod(r[1].substr(9)) == Approx(0.005).margin(0.0005));
  CHECK(std::stod(r[3].substr(9)) == Approx(1.0).margin(0.0005));
  CHECK(r[6] == "1000\n");
}

TEST_CASE("console: the recording goes on through the session and behind it", "[tools]") {
  const Workspace w;
  session(w, "#1j=1000\n#1p\n", "--record run.csv");
  w.write("set_up2.pmc", std::string(kSetUp) + "#1j=1000\n");
  CHECK(w.run("pmac-run", "set_up2.pmc --record straight.csv").code == 0);
  // the times of samples are summed from where a piece begins: equal but for the last digits
  const auto piecewise = numbers(w.read("run.csv")), straight = numbers(w.read("straight.csv"));
  REQUIRE(piecewise.size() > 1000);
  REQUIRE(piecewise.size() == straight.size());
  double worst = 0;
  for (std::size_t i = 0; i < straight.size(); ++i) worst = std::max(worst, std::abs(piecewise[i] - straight[i]));
  CHECK(worst < 1e-9);
}

TEST_CASE("console: input may end anywhere", "[tools]") {
  const Workspace w;
  CHECK(session(w, "P1=5\nP1").back() == "P1=5\n");
  CHECK(session(w, "P1=5\x04P1=6\n").size() == 1);
  CHECK(session(w, "").empty());
  w.write("input.txt", "open prog 5\nX1\n");
  const ToolResult r = w.run("pmac-run", "--console < input.txt");
  CHECK(r.code == 0);
  CHECK(r.out.find("error #") != std::string::npos);
  CHECK(w.run("pmac-run", "--realtime x.pmc").code == 2);
}

TEST_CASE("console: a wait is acknowledged when it is over, also by the limit of the run", "[tools]") {
  const Workspace w;
  w.write("set_up.pmc", kSetUp);
  w.write("input.txt", "wait 5\nwait\nwait 10ms\nwait .5 ;\nquit\nwait 99999\nP1\n");
  const ToolResult r = w.run("pmac-run", "set_up.pmc --console --max-time 1 < input.txt");
  CHECK(r.code == 4);
  const auto answers = replies(r.out);
  REQUIRE(answers.size() == 6);   // what stands behind the limit is not read
  CHECK(answers[0].empty());
  CHECK(answers[1] == "stdin:2:1: error #21: ILLEGAL PARAMETER: wait takes simulated milliseconds, or idle: wait 500, wait idle\n");
  CHECK(answers[2].empty());
  CHECK(answers[3].empty());
  CHECK(answers[4].find("error #20: ILLEGAL CMD: quit is no command; Ctrl-D") != std::string::npos);
  CHECK(answers[5].find("the limit of the run is reached") != std::string::npos);
}

TEST_CASE("console: warnings name the line that was typed", "[tools]") {
  const Workspace w;
  w.write("set_up.pmc", std::string(kSetUp) + "Sim.Motor[1].TriggerPos=-5 Sim.Motor[2].TriggerPos=-5\n");
  w.write("input.txt", "P1=1\n#1hm\n\n#2hm #1j/ #2j/\n");
  const ToolResult r = w.run("pmac-run", "set_up.pmc --console < input.txt");
  CHECK(r.code == 0);
  CHECK(r.err.find("stdin:2: warning: motor 1 moves away") != std::string::npos);
  CHECK(r.err.find("stdin:4: warning: motor 2 moves away") != std::string::npos);
}

TEST_CASE("console: list takes its operand and no more", "[tools]") {
  const Workspace w;
  const auto r = session(w, "open prog Main\nX1\nX2\nclose\nlist prog Main P1\nlist prog main\nlist prog Main list plc 3\nlist\n&1bMain r\nlist pc,\nlist pc,1\n");
  REQUIRE(r.size() == 11);
  CHECK(r[4] == "X1\nX2\nP1=0\n");
  CHECK(r[5].find("error #22: PROGRAM NOT IN BUFFER: there is no prog main") != std::string::npos);
  CHECK(r[6].starts_with("X1\nX2\nstdin:7:"));
  CHECK(r[7].find("error #21") != std::string::npos);
  CHECK(r[8].empty());
}

TEST_CASE("console: an unknown element is refused every time", "[tools]") {
  const Workspace w;
  const auto r = session(w, "Motor[1].Foo\nMotor[2].Foo=1 Motor[3].Foo\nP1=Motor[1].Foo\n");
  REQUIRE(r.size() == 3);
  for (std::size_t line = 0; line < r.size(); ++line) CHECK(r[line].find("error #20: ILLEGAL CMD: unknown element Motor[].Foo") != std::string::npos);
}

TEST_CASE("console: no input ends it by a crash", "[tools]") {
  const Workspace w;
  std::string input;
  for (const std::string rest : {"close", "clear", "cx X", "#1->", "a..b", "open prog 5", "%", "motor[1", "motor[31]..", ""})
    for (const std::string word : {"backup", "system", "undefine", "list", "list prog", "define", "delete", "echo"}) input += word + " " + rest + "\n";
  input += std::string(100'000, '#') + "\n" + std::string("P1\0P2\n", 6) + "\xff\xfe\x80\n" + std::string(3000, '(') + "\n#1..99999999p\nP1..99999999\nM1..5\nclose\nP1\n";
  w.write("input.txt", input);
  const ToolResult r = w.run("pmac-run", "--console < input.txt");
  CHECK(r.code == 0);
  CHECK(r.out.find("\nP1=0\n") != std::string::npos);
}
