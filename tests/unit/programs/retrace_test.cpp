// Retracing the stored path with < and going on with >: on the path, within the motors' limits at servo rate, and once only.
#include <cmath>

#include "tests/unit/programs/bench.h"

using pmac::test::ProgramBench;

namespace {

// 0.1 mu/ms^2 and 20 mu/ms; 1000 mu a millimetre. 5 ms segments.
std::string set_up(int lookahead_segments, int buffer_segments) {
  return "Sys.ServoPeriod=1\n&1 #1->1000X #2->1000Y\nCoord[1].SegMoveTime=5 Coord[1].LHDistance=" + std::to_string(lookahead_segments) +
         "\ndefine lookahead " + std::to_string(buffer_segments) +
         "\nMotor[1].MaxSpeed=50 Motor[2].MaxSpeed=50 Motor[1].InvAmax=10 Motor[2].InvAmax=10\nCoord[1].FeedHoldSlew=0.01\n"
         "open prog 1\nlinear abs ta0 ts0 F20 X60\nclose\n"
         "open prog 2\nP10=0\nlinear abs ta0 ts0 F20 X20\ncircle2 X20 Y20 I0 J10\nP10==P10+1\nlinear X0\ncircle2 X0 Y0 I0 J-10\nclose\n";
}

double position_mu(const ProgramBench& bench, double time_ms, std::size_t motor = 1) {
  return bench.motor_mu.at(static_cast<std::size_t>(std::lround(time_ms)))[motor];
}

/// Distance from the outline of prog 2: two lines and two half circles of 10 mm.
double off_the_oval_mu(double x, double y) {
  if (x >= 0 && x <= 20000) return std::min(std::abs(y), std::abs(y - 20000));
  return std::abs(std::hypot(x < 0 ? x : x - 20000, y - 10000) - 10000);
}

}  // namespace

TEST_CASE("retracing a line takes the times and distances of the acceleration limit", "[programs]") {
  ProgramBench bench("a.pmc", set_up(60, 1000));
  const std::string status = "Coord[1].LookAheadStop Coord[1].LookAheadDir Coord[1].ProgProceeding";
  bench.machine->at(1000, "&1 <");
  bench.machine->at(1600, status);
  bench.machine->at(1800, "&1 \\");
  bench.machine->at(2100, status);
  bench.machine->at(2200, "&1 >");
  bench.machine->at(2300, status);
  bench.run("&1 b1r");
  REQUIRE(bench.refusals.empty());
  REQUIRE(bench.faults.empty());
  // 20 mu/ms are reached after 200 ms and 2000 mu: 18000 mu at 1000 ms. From 20 to -20 mu/ms takes 400 ms: back at 18000 mu, 1400 ms; one
  // tick to look back. Then 400 ms at -20 mu/ms, 2000 mu to stop, 2000 mu to be at speed again.
  CHECK(position_mu(bench, 1200) == Approx(20000).margin(45));
  CHECK(position_mu(bench, 1400) == Approx(18000).margin(90));
  CHECK(position_mu(bench, 1500) - position_mu(bench, 1600) == Approx(2000).margin(0.01));
  CHECK(position_mu(bench, 2000) == Approx(18000 - 8000 - 2000).margin(90));
  CHECK(position_mu(bench, 2100) == position_mu(bench, 2200));
  CHECK(position_mu(bench, 2404) - position_mu(bench, 2200) == Approx(2000).margin(90));
  CHECK(bench.motor(1).max_accel_mu_ms2 <= 0.1001);
  CHECK(bench.motor(1).final_mu == 60000);
  std::string bits;
  for (const std::string& answer : bench.answers) bits += answer.back();
  CHECK(bits == "011100001");
}

TEST_CASE("retracing anywhere keeps the limits and the path, and what follows is the whole path, once", "[programs]") {
  double worst_accel = 0, worst_off = 0;
  for (double back_ms = 120; back_ms < 5200; back_ms += 170) {
    ProgramBench bench("a.pmc", set_up(60, 2000));
    bench.machine->at(back_ms, "&1 <");
    bench.machine->at(back_ms + 900, "&1 >");
    bench.machine->at(back_ms + 1000, "&1 <");
    bench.machine->at(back_ms + 1700, "&1 %50");
    bench.machine->at(back_ms + 2500, "&1 \\");
    bench.machine->at(back_ms + 2900, "&1 %100 r");
    bench.run("&1 b2r");
    INFO(back_ms);
    REQUIRE(bench.faults.empty());
    REQUIRE(bench.refusals.empty());
    worst_accel = std::max({worst_accel, bench.motor(1).max_accel_mu_ms2, bench.motor(2).max_accel_mu_ms2});
    for (const auto& row : bench.motor_mu) worst_off = std::max(worst_off, off_the_oval_mu(row[1], row[2]));
    CHECK(bench.motor(1).final_mu == Approx(0).margin(1e-6));
    CHECK(bench.motor(2).final_mu == Approx(0).margin(1e-6));
    bench.machine->command("P10", "-e");
    CHECK(bench.answers == std::vector<std::string>{"P10=1"});
    CHECK(bench.moves.size() == 4);
  }
  CHECK(worst_accel <= 0.1001);
  CHECK(worst_off < 0.5);   // segments of an arc are cubics through its points
}

TEST_CASE("retracing ends where the path begins", "[programs]") {
  ProgramBench bench("a.pmc", set_up(60, 2000));
  bench.machine->at(3000, "&1 <");
  bench.machine->at(8000, "Coord[1].LookAheadStop Coord[1].ProgRunning");
  bench.machine->at(8001, "&1 >");
  bench.run("&1 b2r");
  REQUIRE(bench.refusals.empty());
  CHECK(position_mu(bench, 8000) == Approx(0).margin(1e-6));
  CHECK(position_mu(bench, 8000, 2) == Approx(0).margin(1e-6));
  CHECK(bench.answers == std::vector<std::string>{"Coord[1].LookAheadStop=1", "Coord[1].ProgRunning=1"});
  CHECK(bench.motor(1).max_accel_mu_ms2 <= 0.1001);
  CHECK(bench.moves.size() == 4);
}

TEST_CASE("retracing stops where the stored path ends", "[programs]") {
  ProgramBench bench("a.pmc", set_up(60, 100));   // 40 segments of 5 ms at 20 mu/ms: 4000 mu, and 2000 mu to stop
  bench.machine->at(2000, "&1 <");
  bench.machine->at(3500, "&1 >");
  bench.run("&1 b1r");
  REQUIRE(bench.refusals.empty());
  CHECK(position_mu(bench, 3400) == Approx(38000 - 4000 - 2000).margin(201));   // whole segments
  CHECK(position_mu(bench, 3400) == position_mu(bench, 3490));
  CHECK(bench.motor(1).max_accel_mu_ms2 <= 0.1001);
  CHECK(bench.motor(1).final_mu == 60000);
}

TEST_CASE("LHDistance 1 stores the path for retracing alone", "[programs]") {
  ProgramBench bench("a.pmc", set_up(1, 1000));
  bench.machine->at(1000, "&1 <");
  bench.machine->at(1500, "&1 \\");
  bench.machine->at(1800, "&1 r");
  bench.run("&1 b1r");
  REQUIRE(bench.refusals.empty());
  // FeedHoldSlew 0.01 a tick: 100 ms and 1000 mu between 20 mu/ms and rest.
  CHECK(position_mu(bench, 1100) == Approx(21000).margin(25));
  CHECK(position_mu(bench, 1700) == Approx(21000 - 1000 - 300 * 20 - 1000).margin(45));
  CHECK(bench.motor(1).final_mu == 60000);
}

TEST_CASE("a feed hold stops retracing by its own slew", "[programs]") {
  ProgramBench bench("a.pmc", set_up(60, 1000));
  bench.machine->at(1000, "&1 <");
  bench.machine->at(1600, "&1 h");
  bench.machine->at(1800, "&1 Coord[1].FeedHold %0");
  bench.machine->at(1801, "&1 <");
  bench.machine->at(2000, "&1 %100");
  bench.machine->at(2100, "&1 >");
  bench.run("&1 b1r");
  REQUIRE(bench.refusals.empty());
  CHECK(position_mu(bench, 1700) == Approx(18000 - 4000 - 1000).margin(90));   // 100 ms from 20 mu/ms to rest
  CHECK(position_mu(bench, 2000) == position_mu(bench, 1720));                 // 0 %: it goes back when the time base lets it
  CHECK(position_mu(bench, 2100) < position_mu(bench, 2000) - 100);
  CHECK(bench.answers == std::vector<std::string>{"Coord[1].FeedHold=1"});
  CHECK(bench.motor(1).final_mu == 60000);
}

TEST_CASE("what cannot be retraced is refused, and an abort on the way back stops there", "[programs]") {
  ProgramBench no_store("a.pmc", set_up(60, 60));
  no_store.machine->at(500, "&1 <");
  no_store.run("&1 b1r");
  REQUIRE(no_store.refusals.size() == 1);
  CHECK(no_store.refusals[0].find("no path is stored to retrace") != std::string::npos);

  ProgramBench at_rest("a.pmc", set_up(60, 100));
  at_rest.run("&1 <");
  REQUIRE(at_rest.refusals.size() == 1);
  CHECK(at_rest.refusals[0].find("on no path") != std::string::npos);

  ProgramBench aborted("a.pmc", set_up(60, 1000) + "Motor[1].AbortTa=-10 Motor[1].AbortTs=0\n");
  aborted.machine->at(1000, "&1 <");
  aborted.machine->at(1600, "&1 a");
  aborted.run("&1 b1r");
  CHECK(aborted.refusals.empty());
  CHECK(aborted.motor(1).final_mu == Approx(18000 - 4000 - 2000).margin(90));
  CHECK(aborted.motor(1).max_accel_mu_ms2 <= 0.1001);
}
