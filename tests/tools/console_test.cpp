// pmac-run --console: a client's session over a pipe.
#include <catch2/catch.hpp>

#include <algorithm>
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
  const std::string piecewise = w.read("run.csv"), straight = w.read("straight.csv");
  const std::size_t common = std::min(piecewise.size(), straight.size());
  CHECK(common > 10000);
  CHECK(piecewise.substr(0, common) == straight.substr(0, common));
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
