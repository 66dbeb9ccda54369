// pmac-run with ACR1000 cards. Times of the contour are closed forms: 20000, 47124, 47124, 20000 and 68284 pulses at 10000 pulses/s.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>
#include <vector>

#include "tests/tools/run_shell.h"

using nlohmann::json;
using pmac::test::program;
using pmac::test::ToolResult;
using pmac::test::Workspace;

namespace {

std::string acr(const std::string& name) { return program("acr1000/" + name); }

std::vector<std::vector<double>> rows_of(const std::string& csv, std::string& header) {
  std::vector<std::vector<double>> rows;
  std::istringstream lines(csv);
  std::getline(lines, header);
  for (std::string line; std::getline(lines, line);) {
    rows.emplace_back();
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(std::stod(cell));
  }
  return rows;
}

std::string ids(const json& notices) {
  std::string text;
  for (const json& notice : notices) text += (text.empty() ? "" : " ") + notice["id"].get<std::string>();
  return text;
}

}  // namespace

TEST_CASE("ACR1000: the contour of two files begins its moves at 0, 2, 6.7124, 11.4248 and 13.4248 s", "[tools]") {
  const Workspace w;
  const ToolResult r = w.run("pmac-run", acr("4_contour.x.acr") + " " + acr("4_contour.y.acr") + " --json --record r.csv");
  INFO(r.err);
  REQUIRE(r.code == 0);
  const json j = json::parse(r.out);
  CHECK(j["status"] == "idle");
  CHECK(j["time_s"].get<double>() == Approx(20.2532).epsilon(1e-9));
  CHECK(j["faults"].empty());
  CHECK(j["warnings"].empty());
  REQUIRE(j["moves"].size() == 10);
  const double starts[] = {0, 2, 6.7124, 11.4248, 13.4248, 20.2532};
  for (std::size_t k = 0; k < 10; ++k) {
    const json& move = j["moves"][k];
    CHECK(move["card"] == (k % 2 == 0 ? "X" : "Y"));
    CHECK(move["start_s"].get<double>() == Approx(starts[k / 2]).margin(1e-9));
    CHECK(move["end_s"].get<double>() == Approx(starts[k / 2 + 1]).margin(1e-9));
    CHECK(move["mode"] == (k / 2 == 1 || k / 2 == 2 ? "circle" : "linear"));
  }
  CHECK(j["moves"][2]["length"] == 47124);
  CHECK(j["moves"][0]["length"] == 0);

  std::string header;
  const auto rows = rows_of(w.read("r.csv"), header);
  CHECK(header == "time_s,X,Y");
  REQUIRE(rows.size() == 20255);               // 0 to 20.254 s, the first millisecond at or after the end
  CHECK(rows.back()[0] == 20.254);
  CHECK(rows.back()[1] == 0);
  CHECK(rows[2000][2] == 20000);
  for (std::size_t k = 2001; k < 6712; ++k) {  // on the first arc
    CHECK(rows[k][0] == Approx(static_cast<double>(k) / 1000));
    REQUIRE(std::abs(std::hypot(rows[k][1] - 20000, rows[k][2] - 20000) / 20000 - 1) < 1e-9);
  }
}

TEST_CASE("ACR1000: sections of one file are the same cards", "[tools]") {
  const Workspace w;
  const std::string files = "AXIS X\n" + std::string("VEL 10000\nP28=20000\nMOV 0\n") + "AXIS Y\nVEL 10000\nP28=20000\nMOV 20000\n";
  w.write("two.acr", files);
  const json j = json::parse(w.run("pmac-run", "two.acr --json").out);
  CHECK(j["time_s"].get<double>() == Approx(2));
  CHECK(j["moves"].size() == 2);
  CHECK(j["cards"]["Y"]["final"] == 20000);
}

TEST_CASE("ACR1000: every program of the course runs", "[tools]") {
  struct Run { std::string files; double time_s; int code; };
  const std::vector<Run> runs = {{acr("1_line.x.acr") + " " + acr("1_line.y.acr"), 10, 0},
                                 {acr("2_sine.x.acr"), 6.2832, 0},
                                 {acr("3_circle.acr"), 6.2832, 0},
                                 {acr("5_ellipse.acr"), 12.5664, 0},
                                 {acr("6_ramps.x.acr") + " --max-time 784.846923", 784.846923, 4},
                                 {acr("8_variables.x.acr") + " --max-time 10000", 2 * (2000 + 100), 0},  // length / VEL + VEL / ramp
                                 {acr("9_blocks.acr"), 6.7124, 0},
                                 {acr("10_sine_wave.acr"), 8, 0}};
  const Workspace w;
  for (const Run& run : runs) {
    CAPTURE(run.files);
    const ToolResult r = w.run("pmac-run", run.files + " --json");
    INFO(r.err);
    CHECK(r.code == run.code);
    const json j = json::parse(r.out);
    CHECK(j["time_s"].get<double>() == Approx(run.time_s).epsilon(1e-6));
    CHECK(j["faults"].empty());
  }
}

TEST_CASE("ACR1000: the looping example keeps VEL 2000 from its second pass on", "[tools]") {
  const Workspace w;
  const json j = json::parse(w.run("pmac-run", acr("6_ramps.x.acr") + " --json --max-time 1100").out);
  CHECK(j["status"] == "time-limit");
  CHECK(ids(j["warnings"]) == "ACR-W08");
  const double durations[] = {150, 144.948974, 489.897949, 141.421356, 141.421356};
  const int lines[] = {50, 80, 100, 50, 80};
  for (std::size_t k = 0; k < 5; ++k) {
    CHECK(j["moves"][k]["end_s"].get<double>() - j["moves"][k]["start_s"].get<double>() == Approx(durations[k]).epsilon(1e-7));
    CHECK(j["moves"][k]["line"] == lines[k]);
  }
}

TEST_CASE("ACR1000: indexing goes on until the host sets the fault relay", "[tools]") {
  const Workspace w;
  const ToolResult r = w.run("pmac-run", acr("7_index.x.acr") + " --json --at 100 'SET 1'");
  CHECK(r.code == 0);
  const json j = json::parse(r.out);
  CHECK(r.err.find("**FAULT**") != std::string::npos);
  REQUIRE(j["moves"].size() == 2);
  const double once = 2 * std::sqrt(12345.0 / 10);   // a triangle at 10 pulses/s^2
  CHECK(j["moves"][0]["end_s"].get<double>() == Approx(once).epsilon(1e-9));
  CHECK(j["moves"][1]["start_s"].get<double>() == Approx(once).epsilon(1e-9));
  CHECK(j["cards"]["X"]["final"] == 24690);
}

TEST_CASE("ACR1000: faults between cards have a name each, and none hangs", "[tools]") {
  const Workspace w;
  w.write("early.acr", "AXIS X\n10 VEL 1000\n20 P28=1000\n30 MOV 1000\n40 MOV 2000\nAXIS Y\n10 VEL 1000\n20 P28=1000\n30 MOV 500\n");
  const ToolResult early = w.run("pmac-run", "early.acr --json");
  CHECK(early.code == 3);
  json j = json::parse(early.out);
  CHECK(j["status"] == "fault");
  REQUIRE(ids(j["faults"]) == "ACR-E13");
  CHECK(j["faults"][0]["card"] == "X");
  CHECK(j["faults"][0]["line"] == 40);
  CHECK(j["faults"][0]["text"].get<std::string>().find("axis Y has ended") != std::string::npos);

  w.write("stops.acr", "AXIS X\n10 VEL 1000\n20 P28=1000\n30 MOV 1000\n40 MOV 2000\nAXIS Y\n10 VEL 1000\n20 P28=1000\n30 MOV 500\n40 VEL 0\n50 MOV 600\n");
  j = json::parse(w.run("pmac-run", "stops.acr --json").out);
  CHECK(ids(j["faults"]) == "ACR-E11 ACR-E13");

  w.write("waits.acr", "AXIS X\n10 VEL 1000\n20 P28=1000\n30 MOV 1000\nAXIS Y\n10 IF 5 THEN 30\n20 GOTO 10\n30 VEL 1000\n");
  j = json::parse(w.run("pmac-run", "waits.acr --json").out);
  CHECK(ids(j["faults"]) == "ACR-E13");

  w.write("differs.acr", "AXIS X\n10 VEL 1000\n20 P28=1000\n30 MOV 1000\nAXIS Y\n10 VEL 1000\n20 P28=2000\n30 MOV 1000\n");
  const ToolResult differs = w.run("pmac-run", "differs.acr --json");
  CHECK(differs.code == 0);
  j = json::parse(differs.out);
  CHECK(ids(j["warnings"]) == "ACR-W04");
  CHECK(j["time_s"].get<double>() == Approx(2));

  const ToolResult halted = w.run("pmac-run", acr("4_contour.x.acr") + " " + acr("4_contour.y.acr") + " --json --at 3 'Y> HALT'");
  CHECK(halted.code == 3);
  j = json::parse(halted.out);
  CHECK(ids(j["faults"]) == "ACR-E13");
  CHECK(j["time_s"].get<double>() == Approx(6.7124));
  CHECK(j["faults"][0]["text"].get<std::string>().find("axis Y was stopped by HALT") != std::string::npos);
}

TEST_CASE("ACR1000: run-time errors of the language stop the card and are named", "[tools]") {
  const Workspace w;
  const std::vector<std::pair<std::string, std::string>> programs = {
      {"10 GOTO 1000\n", "ACR-E07"}, {"10 RET\n", "ACR-E08"}, {"10 GSB 10\n", "ACR-E08"}, {"10 P30=-1\n20 VEL P30\n", "ACR-E04"},
      {"10 VEL 100\n20 P30=2\n30 CIRCLE P30,100,100,0,628\n", "ACR-E10"}, {"10 MOV 5\n", "ACR-E11"}};
  for (const auto& [text, id] : programs) {
    CAPTURE(text);
    w.write("p.x.acr", text);
    const ToolResult r = w.run("pmac-run", "p.x.acr --json");
    CHECK(r.code == 3);
    CHECK(ids(json::parse(r.out)["faults"]) == id);
  }
}

TEST_CASE("ACR1000: a file of move blocks streams into its card", "[tools]") {
  const Workspace w;
  const std::string there("\x04\x80\x10\x27\xA0\x86\x01\x00\xA8\x61\x00\x00", 12), back("\x04\x80\x10\x27\xA0\x86\x01\x00\x00\x00\x00\x00", 12);
  w.write("cut.x.bin", there + "\x0c" + back + there.substr(0, 7));
  const ToolResult r = w.run("pmac-run", "cut.x.bin --json");
  CHECK(r.code == 3);
  const json j = json::parse(r.out);
  CHECK(j["moves"].size() == 2);
  CHECK(j["cards"]["X"]["counter"] == 2);
  REQUIRE(ids(j["faults"]) == "ACR-E12");
  CHECK(j["faults"][0]["text"].get<std::string>().find("5 bytes are missing") != std::string::npos);
  CHECK(r.err.find("00000001") != std::string::npos);   // the answer to ctrl-L
}

TEST_CASE("ACR1000: a file's program runs first, its blocks follow", "[tools]") {
  const Workspace w;
  w.write("both.x.acr", "VEL 1000\nMOV 1000\n");
  w.write("both.x.bin", "\x04\r0\r3000\r");
  const json j = json::parse(w.run("pmac-run", "both.x.acr both.x.bin --json").out);
  CHECK(j["moves"].size() == 2);
  CHECK(j["time_s"].get<double>() == Approx(3));
}

TEST_CASE("ACR1000: the sample period, in ms or with a unit", "[tools]") {
  const Workspace w;
  w.write("p.x.acr", "VEL 1000\nMOV 1005\n");
  std::string header;
  for (const auto& [option, count] : std::vector<std::pair<std::string, std::size_t>>{{"", 1006}, {"--period 10", 102}, {"--period 0.5", 2011}, {"--period 500us", 2011}, {"--period 0.5s", 4}}) {
    CAPTURE(option);
    REQUIRE(w.run("pmac-run", "p.x.acr --record r.csv " + option).code == 0);
    const auto rows = rows_of(w.read("r.csv"), header);
    CHECK(rows.size() == count);
    CHECK(rows.back()[1] == 1005);
  }
  CHECK(w.run("pmac-run", "p.x.acr --period 0").code == 2);
  CHECK(w.run("pmac-run", "p.x.acr --period 1h").code == 2);
}

TEST_CASE("ACR1000: every stage prints", "[tools]") {
  const Workspace w;
  w.write("p.x.acr", "10 VEL 1000:ACC 2000:STP 1000\n20 MOV 2000\n");
  CHECK(w.run("pmac-run", "p.x.acr --emit=commands").out.find("X line 20 0 mov to 2000 P28=0 VEL=1000 ACC=2000 DEC=0 STP=1000") != std::string::npos);
  const std::string path = w.run("pmac-run", "p.x.acr --emit=path").out;
  CHECK(path.find("faster 0 0.5 250 1000 250") != std::string::npos);   // 0.5 s, 250 pulses
  CHECK(path.find("stop 1.75 1 2000 0 2000") != std::string::npos);
  CHECK(w.run("pmac-run", "p.x.acr --emit=servo --period 1000").out == "time_s X\n0 0\n1 750\n2 1718.75\n3 2000\n");
  CHECK(w.run("pmac-run", "p.x.acr --emit=lookahead").code == 2);
  CHECK(w.run("pmac-run", "p.x.acr --emit=lookahead --lookahead --axis-limit X=500,1000").out.find("# command line") == 0);
}

TEST_CASE("ACR1000: limits are checked, and kept by the lookahead on the same path", "[tools]") {
  const Workspace w;
  const std::string files = acr("4_contour.x.acr") + " " + acr("4_contour.y.acr") + " --axis-limit '*=8000,40000' --check-limits --json --record ";
  CHECK(w.run("pmac-run", files + "plain.csv").code == 3);
  const ToolResult kept = w.run("pmac-run", files + "kept.csv --lookahead");
  INFO(kept.err);
  CHECK(kept.code == 0);
  const json j = json::parse(kept.out);
  CHECK(j["limits"]["X"]["ok"] == true);
  CHECK(j["limits"]["Y"]["speed"]["share"].get<double>() <= 1.001);
  CHECK(j["time_s"].get<double>() > 20.2532);
  CHECK(j["moves"].back()["end_s"].get<double>() == Approx(j["time_s"].get<double>()));
  std::string header;
  for (const auto& row : rows_of(w.read("kept.csv"), header)) {
    const double x = row[1], y = row[2];
    const double lines = std::min({std::abs(x), std::abs(y), std::abs(x - 68284)});
    const double arcs = std::min(std::abs(std::hypot(x - 20000, y - 20000) - 20000), std::abs(std::hypot(x - 48284, y - 20000) - 19999.81));
    REQUIRE(std::min(lines, arcs) < 0.3);   // whole-pulse I, J and P29 are a quarter of a pulse off
  }
}

TEST_CASE("ACR1000: gathered columns, pictures and statistics", "[tools]") {
  const Workspace w;
  const ToolResult r = w.run("pmac-run", acr("3_circle.acr") + " --gather g.csv --plot p.svg --stats");
  REQUIRE(r.code == 0);
  CHECK(w.read("g.csv").find("time_s,X,X.speed,X.accel,X.master,X.counter,X.busy,Y,") == 0);
  CHECK(w.has("p.svg"));
  CHECK(r.out.find("idle after 6.283200 s simulated: 2 moves") != std::string::npos);
}

TEST_CASE("ACR1000: options that mean nothing to cards, and files that are not there", "[tools]") {
  const Workspace w;
  w.write("p.x.acr", "VEL 1000\nMOV 1005\n");
  CHECK(w.run("pmac-run", "p.x.acr --limit-jerk").code == 2);
  CHECK(w.run("pmac-run", "p.x.acr --trace=t.txt").code == 2);
  CHECK(w.run("pmac-run", "p.x.acr --lookahead").code == 2);
  CHECK(w.run("pmac-run", "p.x.acr --axis-limit Q=5").code == 2);
  CHECK(w.run("pmac-run", "none.x.acr").code == 2);
  CHECK(w.run("pmac-run", "none.x.bin").code == 2);
  w.write("bad.x.acr", "10 JUMP 5\n");
  CHECK(w.run("pmac-run", "bad.x.acr").code == 1);
  const ToolResult refused = w.run("pmac-run", "p.x.acr -e 'FLY 5'");
  CHECK(refused.code == 3);
  CHECK(w.run("pmac-run", "p.x.acr -e 'Q> MOV 5'").code == 3);
}

TEST_CASE("ACR1000: a line of the host is executed while the program waits for a motion", "[tools]") {
  const Workspace w;
  w.write("p.x.acr", "10 VEL 1000\n20 MOV 1000\n30 MOV 2000\n40 IF 5 THEN 60\n50 MOV 3000\n60 PRINT \"DONE\"\n");
  const ToolResult r = w.run("pmac-run", "p.x.acr --json --at 0.5 'SET 5' --at 0.6 'MOV 7' --at 0.7 'LIST'");
  CHECK(r.code == 3);
  const json j = json::parse(r.out);
  CHECK(j["cards"]["X"]["final"] == 2000);
  REQUIRE(j["refused"].size() == 2);
  CHECK(j["refused"][0]["command"] == "MOV 7");
  CHECK(j["refused"][1]["text"].get<std::string>().find("console") != std::string::npos);
}

TEST_CASE("ACR1000: a loop without an end is named with its line", "[tools]") {
  const Workspace w;
  w.write("p.x.acr", "10 VEL 1000\n20 MOV 1000\n30 GOTO 40\n40 GOTO 30\n");
  const ToolResult r = w.run("pmac-run", "p.x.acr --json");
  CHECK(r.code == 0);
  const json j = json::parse(r.out);
  CHECK(j["status"] == "idle");
  REQUIRE(j["loops"].size() == 1);
  CHECK(j["loops"][0]["line"] == 30);
}

TEST_CASE("ACR1000: two calls of a subroutine with a way back in it are no endless loop", "[tools]") {
  const Workspace w;
  w.write("p.x.acr", "10 VEL 1000\n20 GSB 100\n30 GSB 100\n40 MOV 500\n50 GOTO 130\n100 GOTO 120\n110 RET\n120 GOTO 110\n130 REM\n");
  const json j = json::parse(w.run("pmac-run", "p.x.acr --json").out);
  CHECK(j["cards"]["X"]["final"] == 500);
  CHECK(j["loops"].empty());
}

TEST_CASE("ACR1000: commands of the host go to one card or to all", "[tools]") {
  const Workspace w;
  w.write("two.acr", "AXIS X\nVEL 1000\nAXIS Y\nVEL 1000\n");
  const json j = json::parse(w.run("pmac-run", "two.acr --json -e 'X> MOV 500' -e 'MOV 2000'").out);
  CHECK(j["cards"]["X"]["final"] == 2000);
  CHECK(j["cards"]["Y"]["counter"] == 1);
  CHECK(j["time_s"].get<double>() == Approx(2));
}

TEST_CASE("ACR1000: random bytes as a stream never crash the run", "[tools]") {
  const Workspace w;
  std::uint32_t seed = 5;
  for (int run = 0; run < 6; ++run) {
    std::string bytes;
    for (int k = 0; k < 3000; ++k) {
      seed = seed * 1664525u + 1013904223u;
      const char usual[] = "MOV P28=VEL10GSB:IF\r\x04\x0c";
      bytes += (seed >> 28) < 8 ? usual[(seed >> 8) % (sizeof usual - 1)] : static_cast<char>(seed >> 16);
    }
    w.write("noise.x.bin", bytes);
    const ToolResult r = w.run("pmac-run", "noise.x.bin --json=summary --max-time 100 --max-instructions 1000000");
    CAPTURE(run);
    CHECK((r.code == 0 || r.code == 3 || r.code == 4));
    CHECK_NOTHROW(json::parse(r.out));
  }
}

namespace {

using Points = std::vector<std::array<double, 2>>;

/// Two columns of a table.
Points path_of(const std::string& csv, std::size_t x, std::size_t y) {
  Points points;
  std::istringstream lines(csv);
  std::string line, cell;
  for (std::getline(lines, line); std::getline(lines, line);) {
    std::vector<double> row;
    for (std::istringstream cells(line); std::getline(cells, cell, ',');) row.push_back(std::stod(cell));
    points.push_back({row.at(x), row.at(y)});
  }
  return points;
}

double distance_to_segment(const std::array<double, 2>& p, const std::array<double, 2>& a, const std::array<double, 2>& b) {
  const double dx = b[0] - a[0], dy = b[1] - a[1], length2 = dx * dx + dy * dy;
  const double share = length2 > 0 ? std::clamp(((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / length2, 0.0, 1.0) : 0.0;
  return std::hypot(p[0] - a[0] - share * dx, p[1] - a[1] - share * dy);
}

/// Largest distance of a point from the path; both run the same way, so the nearest place is looked for near the last one.
double largest_distance(const Points& points, const Points& path) {
  double worst = 0;
  std::size_t near = 0;
  for (const auto& p : points) {
    double best = 1e300;
    std::size_t best_at = near;
    for (std::size_t i = near > 20 ? near - 20 : 0; i + 1 < path.size() && i < near + 400; ++i)
      if (const double d = distance_to_segment(p, path[i], path[i + 1]); d < best) best = d, best_at = i;
    near = best_at;
    worst = std::max(worst, best);
  }
  return worst;
}

}  // namespace

TEST_CASE("ACR1000: the motion program of --emit=pmc runs to the same contour within a pulse", "[tools]") {
  const Workspace w;
  w.write("start.acr", "AXIS X START=5000\n10 VEL 10000\n20 P28=10000\n30 MOV /10000\nAXIS Y START=-300\n10 VEL 10000\n20 P28=10000\n30 MOV /-400\n");
  const std::vector<std::string> sets = {acr("4_contour.x.acr") + " " + acr("4_contour.y.acr"), acr("1_line.x.acr") + " " + acr("1_line.y.acr"), acr("3_circle.acr"), "start.acr"};
  for (const std::string& set : sets) {
    INFO(set);
    REQUIRE(w.shell("pmacc --emit=pmc " + set + " > same.pmc").code == 0);
    REQUIRE(w.run("pmac-run", set + " --record cards.csv --period 0.1").code == 0);
    const ToolResult r = w.run("pmac-run", "same.pmc -e '&1 b1r' --record program.csv");
    INFO(r.err);
    REQUIRE(r.code == 0);
    const Points cards = path_of(w.read("cards.csv"), 1, 2), motors = path_of(w.read("program.csv"), 3, 4);
    REQUIRE(cards.size() > 500);
    CHECK(largest_distance(motors, cards) < 1);
    CHECK(std::hypot(motors.back()[0] - cards.back()[0], motors.back()[1] - cards.back()[1]) < 1e-6);
  }
}

TEST_CASE("ACR1000: two files for one axis are refused, not mixed", "[tools]") {
  const Workspace w;
  for (const char* name : {"a.x.acr", "b.x.acr"}) w.write(name, "10 VEL 1000\n20 MOV 500\n");
  for (const char* tool : {"pmacc", "pmac-run"}) {
    const ToolResult r = w.run(tool, "a.x.acr b.x.acr");
    CHECK(r.code == 1);
    CHECK(r.err.find("b.x.acr:1:1: error: another file has the program of axis X already") != std::string::npos);
  }
}

TEST_CASE("ACR1000: --emit=pmc says where P29 is not where the CIRCLE ends", "[tools]") {
  const Workspace w;
  w.write("bad.acr", "AXIS X\n10 VEL 1000:P28=15708:P29=-9000\n20 CIRCLE 1,10000,10000,0,15708\nAXIS Y\n10 VEL 1000:P28=15708:P29=-10000\n20 CIRCLE 1,10000,0,-10000,15708\n");
  const ToolResult r = w.run("pmacc", "--emit=pmc bad.acr");
  CHECK(r.code == 0);
  CHECK(r.err.find("bad.acr:3:4: warning: P29 is 1000 pulses from where the CIRCLE comes to") != std::string::npos);
}
