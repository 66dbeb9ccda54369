// Feed-rate override, feed hold, pause, single steps and abort, against closed forms. The servo period is 1 ms, so that a slew of s ms a
// servo cycle changes the rate by s a ms.
#include <cmath>

#include "tests/unit/programs/bench.h"

using pmac::test::ProgramBench;

namespace {

const std::string kSetUp =
    "Sys.ServoPeriod=1\n&1 #1->1000X #2->1000Y\n"
    "Motor[1].InvAmax=0 Motor[2].InvAmax=0 Motor[1].InvDmax=0 Motor[2].InvDmax=0\n"
    "open prog 1\nlinear abs ta100 td100 ts0 F10\nX10\ndwell 100\nX0\nclose\n"
    "open prog 2\nlinear abs ta0 td0 ts0 F10\nX1\nX2\nX3\nX4\nclose\n";

pmac::runtime::RunLimits until(double ms) {
  pmac::runtime::RunLimits limits;
  limits.until_ms = ms;
  return limits;
}

double position_mu(const ProgramBench& bench, double time_ms, std::size_t motor = 1) {
  return bench.motor_mu[static_cast<std::size_t>(std::lround(time_ms))][motor];
}

/// Distance of prog 1's first move after s ms of path time, before it slows down: 10 mu/ms after a ramp of 100 ms.
double distance_mu(double s) { return s < 100 ? 0.05 * s * s : 10 * (s - 50); }

}  // namespace

TEST_CASE("at 50 % moves take twice their time and a dwell its own", "[programs]") {
  ProgramBench bench("a.pmc", kSetUp + "Coord[1].TimeBaseSlew=1000 Coord[1].DesTimeBase=0.5\n");
  bench.machine->at(10, "&1 b1r");
  bench.run("P1=0");
  REQUIRE(bench.refusals.empty());
  REQUIRE(bench.moves.size() == 3);
  // 10 mm at 10 mm/s and ramps of 100 ms: 1100 ms of path time; the slew has ended after 0.5 us
  const double t0 = bench.moves[0].start_ms;
  CHECK(bench.moves[0].end_ms - t0 == Approx(2200).margin(1e-6));
  CHECK(bench.moves[1].end_ms - bench.moves[1].start_ms == Approx(100).margin(1e-9));
  CHECK(bench.moves[2].end_ms - bench.moves[2].start_ms == Approx(2200).margin(1e-6));
  CHECK(bench.motor(1).max_speed_mu_ms == Approx(5).epsilon(1e-9));          // half the speed
  CHECK(bench.motor(1).max_accel_mu_ms2 == Approx(0.025).epsilon(1e-6));     // a quarter of the acceleration
}

TEST_CASE("the time base changes evenly at TimeBaseSlew", "[programs]") {
  ProgramBench bench("a.pmc", kSetUp + "Coord[1].TimeBaseSlew=0.001\n");
  bench.machine->at(200, "&1 %50");
  bench.run("&1 b1r", until(1000));
  // rate 1 - 0.001 (t - 200) for 500 ms, then 0.5
  for (const double t : {150.0, 300.0, 450.0, 699.0, 800.0}) {
    const double d = std::min(t - 200, 500.0);
    const double s = t <= 200 ? t : 200 + d - 0.0005 * d * d + 0.5 * std::max(0.0, t - 700);
    INFO(t);
    CHECK(position_mu(bench, t) == Approx(distance_mu(s)).margin(1e-6));
  }
}

TEST_CASE("above 100 % the program is calculated in time", "[programs]") {
  ProgramBench bench("a.pmc", kSetUp + "Coord[1].TimeBaseSlew=1000\n");
  bench.run("&1 %250 b2r");
  REQUIRE(bench.faults.empty());
  REQUIRE(bench.moves.size() == 4);
  CHECK(bench.moves[3].end_ms == Approx(160).margin(0.01));   // 4 mm at 25 mm/s; the rate is reached within 1.5 us
  CHECK(bench.motor(1).final_mu == 4000);
}

TEST_CASE("feed hold slews to a standstill at FeedHoldSlew and r goes on along the same path", "[programs]") {
  ProgramBench bench("a.pmc", kSetUp + "Coord[1].FeedHoldSlew=0.01\n");
  const std::string status = "Coord[1].FeedHold Coord[1].ProgProceeding Coord[1].ProgRunning Coord[1].ProgActive";
  bench.machine->at(300, "&1 h");
  bench.machine->at(340, status);
  bench.machine->at(500, status);
  bench.machine->at(500, "Motor[1].DesVel");
  bench.machine->at(900, "&1 r");
  bench.machine->at(950, status);
  bench.machine->at(1200, status);
  bench.run("&1 b1r");
  REQUIRE(bench.refusals.empty());
  // 1 to 0 in 100 ms: 50 ms of path time, and again while it goes on
  CHECK(position_mu(bench, 350) == Approx(distance_mu(300 + 50 - 12.5)).margin(1e-6));
  CHECK(position_mu(bench, 400) == Approx(3000).margin(1e-6));
  CHECK(position_mu(bench, 900) == Approx(3000).margin(1e-6));
  CHECK(position_mu(bench, 950) == Approx(distance_mu(362.5)).margin(1e-6));
  CHECK(bench.moves[0].start_ms == 0);
  CHECK(bench.moves[0].end_ms == Approx(1700).margin(1e-9));
  CHECK(bench.moves[1].end_ms == Approx(1800).margin(1e-9));
  CHECK(bench.moves[2].end_ms == Approx(2900).margin(1e-9));
  CHECK(bench.motor(1).final_mu == 0);
  const std::string names[] = {"Coord[1].FeedHold=", "Coord[1].ProgProceeding=", "Coord[1].ProgRunning=", "Coord[1].ProgActive="};
  const std::string values[] = {"3111", "1011", "0", "2111", "0111"};
  std::size_t at = 0;
  for (const std::string& value : values) {
    if (value.size() == 1) { CHECK(bench.answers[at++] == "Motor[1].DesVel=0"); continue; }
    for (std::size_t i = 0; i < 4; ++i) CHECK(bench.answers[at++] == names[i] + value[i]);
  }
}

TEST_CASE("a program that nobody can resume ends the run", "[programs]") {
  ProgramBench bench("a.pmc", kSetUp + "Coord[1].FeedHoldSlew=0.01\n");
  bench.machine->at(300, "&1 h");
  const auto outcome = bench.run("&1 b1r");
  CHECK(outcome.end == pmac::runtime::RunEnd::kIdle);
  CHECK(outcome.time_ms == Approx(410).margin(1e-9));
  REQUIRE(outcome.running.size() == 1);
}

TEST_CASE("an override after a hold that is over is no going on, and keeps no program from starting", "[programs]") {
  ProgramBench bench("a.pmc", kSetUp + "Coord[1].FeedHoldSlew=0.01\n");
  bench.machine->at(50, "&1 h");
  bench.machine->at(300, "&1 r");
  bench.machine->at(2000, "&1 %50");
  bench.machine->at(2010, "Coord[1].FeedHold");
  bench.machine->at(2020, "&1 r");
  bench.run("&1 b2r");
  CHECK(bench.refusals.empty());
  CHECK(bench.answers == std::vector<std::string>{"Coord[1].FeedHold=0"});
  CHECK(bench.moves.size() == 8);
}

TEST_CASE("a PLC program holds, looks and goes on", "[programs]") {
  ProgramBench bench("a.pmc", kSetUp + "Coord[1].FeedHoldSlew=0.01\nopen plc 1\n"
      "if (Sys.Time >= 0.3 && P1 == 0) { hold1 P1=1 }\nif (Sys.Time >= 0.9 && P1 == 1) { resume1 P1=2 disable plc 1 }\nclose\n");
  bench.run("enable plc 1 &1 b1r");
  REQUIRE(bench.faults.empty());
  CHECK(bench.moves[0].end_ms == Approx(1700).margin(1.5));   // a background scan a ms
  CHECK(bench.motor(1).final_mu == 0);
}

TEST_CASE("synchronous assignments keep to the path", "[programs]") {
  ProgramBench bench("a.pmc", "Sys.ServoPeriod=1\n&1 #1->1000X\nCoord[1].TimeBaseSlew=1000 Motor[1].InvAmax=0\nptr Lamp->u.io:$A0000C.0.1;\n"
                              "open prog 1\nlinear abs ta0 ts0 F10\nX1\nLamp == 1\nX2\nclose\n");
  bench.run("&1 %20 b1r");
  REQUIRE(bench.outputs.size() == 1);
  CHECK(bench.outputs[0].time_ms == Approx(500).margin(0.01));
}

TEST_CASE("rapid moves and jogs follow the time base of their coordinate system", "[programs]") {
  ProgramBench bench("a.pmc", kSetUp + "Coord[1].TimeBaseSlew=1000\nopen prog 3\nrapid abs X40\nclose\n");
  bench.run("&1 %50 b3r");
  REQUIRE(bench.moves.size() == 1);
  CHECK(bench.moves[0].end_ms == Approx(2 * 1575).margin(0.01));   // 32 mu/ms, 325 ms ramps
  bench.moves.clear();
  bench.run("#2j:40000");
  REQUIRE(bench.moves.size() == 1);
  CHECK(bench.moves[0].end_ms - bench.moves[0].start_ms == Approx(3150).margin(0.01));
}

TEST_CASE("pause finishes what is calculated and r goes on", "[programs]") {
  ProgramBench bench("a.pmc", kSetUp);
  bench.machine->at(50, "&1 q");
  bench.machine->at(60, "Coord[1].ProgRunning");
  bench.machine->at(400, "Coord[1].ProgRunning Coord[1].ProgActive");
  bench.machine->at(500, "&1 r");
  bench.run("&1 b2r");
  REQUIRE(bench.refusals.empty());
  CHECK(position_mu(bench, 300) == 3000);   // two moves are known beyond the executing one
  CHECK(position_mu(bench, 500) == 3000);
  CHECK(position_mu(bench, 550) == 3500);
  CHECK(bench.motor(1).final_mu == 4000);
  CHECK(bench.answers == std::vector<std::string>{"Coord[1].ProgRunning=1", "Coord[1].ProgRunning=0", "Coord[1].ProgActive=1"});
}

TEST_CASE("after a pause a motor that was jogged away has to come back", "[programs]") {
  ProgramBench bench("a.pmc", kSetUp);
  bench.machine->at(50, "&1 q");
  bench.machine->at(400, "#1j:500");
  bench.machine->at(1000, "&1 r");
  bench.machine->at(1100, "#1j=");
  bench.machine->at(2000, "&1 r");
  bench.run("&1 b2r");
  REQUIRE(bench.refusals.size() == 1);
  CHECK(bench.refusals[0].find("error #46") != std::string::npos);
  CHECK(bench.motor(1).final_mu == 4000);
  CHECK(position_mu(bench, 2050) == 3500);
}

TEST_CASE("a step is one move, and a step of a program that executes pauses it", "[programs]") {
  ProgramBench bench("a.pmc", kSetUp);
  for (const double t : {200.0, 400.0}) bench.machine->at(t, "&1 s");
  bench.machine->at(600, "&1 r");
  bench.machine->at(610, "&1 s");
  bench.machine->at(1000, "Coord[1].ProgActive");
  bench.run("&1 b2s");
  REQUIRE(bench.refusals.empty());
  CHECK(position_mu(bench, 200) == 1000);
  CHECK(position_mu(bench, 400) == 2000);
  CHECK(position_mu(bench, 600) == 3000);
  CHECK(position_mu(bench, 700) == 4000);
  REQUIRE(bench.answers.size() == 1);
}

TEST_CASE("a block from bstart to bstop is one step", "[programs]") {
  ProgramBench bench("a.pmc", kSetUp + "open prog 5\nlinear abs ta0 ts0 F10\nbstart\nX1\nX2\ndwell 100\nX3\nbstop\nX4\nclose\n");
  bench.machine->at(600, "&1 s");
  bench.machine->at(900, "&1 r");
  bench.run("&1 b5s");
  REQUIRE(bench.refusals.empty());
  CHECK(position_mu(bench, 200) == 2000);
  CHECK(position_mu(bench, 400) == 3000);
  CHECK(position_mu(bench, 599) == 3000);
  CHECK(position_mu(bench, 700) == 4000);
}

TEST_CASE("pmatch after a pause takes the place to which the motors were jogged", "[programs]") {
  ProgramBench bench("a.pmc", kSetUp);
  bench.machine->at(50, "&1 q");
  bench.machine->at(400, "#1j:-500");
  bench.machine->at(1000, "&1 pmatch");
  bench.machine->at(1100, "&1 r");
  bench.run("&1 b2r");
  REQUIRE(bench.refusals.empty());
  CHECK(position_mu(bench, 1100) == 2500);
  CHECK(position_mu(bench, 1200) == 3500);   // 1.5 mm at 10 mm/s
  CHECK(position_mu(bench, 1250) == 4000);
}

TEST_CASE("pause in a program stops behind the line", "[programs]") {
  ProgramBench bench("a.pmc", kSetUp + "open prog 4\nlinear abs ta0 ts0 F10\nX1\npause\nX2\nclose\n");
  bench.machine->at(500, "&1 resume");
  bench.run("&1 b4r");
  REQUIRE(bench.faults.empty());
  CHECK(position_mu(bench, 499) == 1000);
  CHECK(position_mu(bench, 600) == 2000);
}

TEST_CASE("abort slows every motor down with AbortTa and forgets the program", "[programs]") {
  ProgramBench bench("a.pmc", kSetUp + "Motor[1].AbortTa=-2\n");
  bench.machine->at(300, "&1 a");
  bench.machine->at(300, "Coord[1].ProgRunning Coord[1].ProgActive");
  bench.machine->at(400, "&1 resume");
  bench.run("&1 b1r");
  // 10 mu/ms at 0.5 mu/ms^2: 20 ms, 100 mu
  CHECK(position_mu(bench, 300) == Approx(2500));
  CHECK(position_mu(bench, 310) == Approx(2500 + 75));
  CHECK(position_mu(bench, 320) == Approx(2600));
  CHECK(bench.motor(1).final_mu == Approx(2600));
  CHECK(bench.answers == std::vector<std::string>{"Coord[1].ProgRunning=0", "Coord[1].ProgActive=0"});
  REQUIRE(bench.refusals.size() == 1);   // nothing to resume
  CHECK(bench.refusals[0].find("error #39") != std::string::npos);
  REQUIRE(bench.moves.size() == 1);
  CHECK(bench.moves[0].end_ms == 300);
}

TEST_CASE("abort in feed hold and at half speed starts from the speed that there is", "[programs]") {
  ProgramBench bench("a.pmc", kSetUp + "Motor[1].AbortTa=-2 Coord[1].FeedHoldSlew=0.01\n");
  bench.machine->at(300, "&1 h");
  bench.machine->at(350, "&1 a");
  bench.machine->at(350, "Coord[1].FeedHold");
  bench.run("&1 b1r");
  // 5 mu/ms: 10 ms, 25 mu
  CHECK(bench.motor(1).final_mu == Approx(distance_mu(337.5) + 25).margin(1e-6));
  CHECK(bench.answers == std::vector<std::string>{"Coord[1].FeedHold=0"});
}

TEST_CASE("without an override samples are the same to the last bit as with one that was taken back before the start", "[programs]") {
  ProgramBench plain("a.pmc", kSetUp), other("a.pmc", kSetUp + "Coord[1].TimeBaseSlew=0.1\n");
  plain.machine->at(100, "&1 b1r");
  other.machine->at(100, "&1 b1r");
  other.machine->at(20, "&1 %70");
  other.machine->at(40, "&1 %100");
  plain.run("P1=0");
  other.run("P1=0");
  CHECK(plain.motor_mu == other.motor_mu);
}

TEST_CASE("holds, pauses and time bases that cannot be are refused", "[programs]") {
  ProgramBench bench("a.pmc", kSetUp);
  bench.run("&1 h");
  bench.run("&1 q");
  bench.run("&1 resume");
  bench.run("&1 %-5");
  bench.run("&1 <");
  bench.run("Coord[1].TimeBaseSlew=0");
  bench.run("&1 %50");
  REQUIRE(bench.refusals.size() == 6);
  CHECK(bench.refusals[3].find("error #23") != std::string::npos);
  CHECK(bench.refusals[4].find("on no path") != std::string::npos);
  CHECK(bench.refusals[5].find("TimeBaseSlew") != std::string::npos);
}
