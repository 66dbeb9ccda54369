// Quick stop inside lookahead: on the path, within the motors' limits at servo rate, and as fast as they allow.
#include <cmath>

#include "tests/unit/programs/bench.h"

using pmac::test::ProgramBench;

namespace {

// 0.1 mu/ms^2 and 20 mu/ms; 1000 mu a millimetre.
const std::string kSetUp =
    "Sys.ServoPeriod=1\n&1 #1->1000X #2->1000Y\nCoord[1].SegMoveTime=5 Coord[1].LHDistance=60\ndefine lookahead 1000\n"
    "Motor[1].MaxSpeed=50 Motor[2].MaxSpeed=50 Motor[1].InvAmax=10 Motor[2].InvAmax=10\n"
    "open prog 1\nlinear abs ta0 ts0 F20 X60\nclose\n"
    "open prog 2\nlinear abs ta0 ts0 F20 X20\ncircle2 X20 Y20 I0 J10\nlinear X0\ncircle2 X0 Y0 I0 J-10\nclose\n";

double position_mu(const ProgramBench& bench, double time_ms, std::size_t motor = 1) {
  return bench.motor_mu[static_cast<std::size_t>(std::lround(time_ms))][motor];
}

/// Distance from the outline of prog 2: two lines and two half circles of 10 mm.
double off_the_oval_mu(double x, double y) {
  if (x >= 0 && x <= 20000) return std::min(std::abs(y), std::abs(y - 20000));
  return std::abs(std::hypot(x < 0 ? x : x - 20000, y - 10000) - 10000);
}

}  // namespace

TEST_CASE("a quick stop on a line takes the time and distance of the acceleration limit", "[programs]") {
  ProgramBench bench("a.pmc", kSetUp);
  const std::string status = "Coord[1].LookAheadStop Coord[1].FeedHold Coord[1].ProgProceeding";
  bench.machine->at(1000, "&1 \\");
  bench.machine->at(1100, status);
  bench.machine->at(1500, status);
  bench.machine->at(2000, "&1 >");
  bench.machine->at(2100, status);
  bench.machine->at(2500, status);
  bench.run("&1 b1r");
  REQUIRE(bench.refusals.empty());
  // 20 mu/ms are reached after 200 ms and 2000 mu: 18000 mu at 1000 ms. The stop takes 200 ms and 2000 mu; one tick to look back.
  CHECK(position_mu(bench, 1000) == Approx(18000).margin(1));
  CHECK(position_mu(bench, 1100) == Approx(18000 + 1500).margin(45));
  CHECK(position_mu(bench, 1210) == Approx(20000).margin(45));
  CHECK(position_mu(bench, 2000) == position_mu(bench, 1210));
  CHECK(position_mu(bench, 2203) - position_mu(bench, 2003) == Approx(2000).margin(45));
  CHECK(bench.motor(1).max_accel_mu_ms2 <= 0.1001);
  CHECK(bench.motor(1).final_mu == 60000);
  std::string bits;
  for (const std::string& answer : bench.answers) bits += answer.back();
  CHECK(bits == "131110021001");
}

TEST_CASE("quick stops anywhere keep the limits and the path, and what follows is the whole path", "[programs]") {
  double worst_accel = 0, worst_off = 0;
  for (double stop_ms = 300; stop_ms < 5200; stop_ms += 130) {
    ProgramBench bench("a.pmc", kSetUp);
    bench.machine->at(stop_ms, "&1 \\");
    bench.machine->at(stop_ms + 700, "&1 r");
    bench.run("&1 b2r");
    INFO(stop_ms);
    REQUIRE(bench.faults.empty());
    REQUIRE(bench.refusals.empty());
    CHECK(position_mu(bench, stop_ms + 690) == position_mu(bench, stop_ms + 650));   // it stands
    CHECK(position_mu(bench, stop_ms + 690, 2) == position_mu(bench, stop_ms + 650, 2));
    worst_accel = std::max({worst_accel, bench.motor(1).max_accel_mu_ms2, bench.motor(2).max_accel_mu_ms2});
    for (const auto& row : bench.motor_mu) worst_off = std::max(worst_off, off_the_oval_mu(row[1], row[2]));
    CHECK(bench.motor(1).final_mu == Approx(0).margin(1e-6));
    CHECK(bench.motor(2).final_mu == Approx(0).margin(1e-6));
  }
  CHECK(worst_accel <= 0.1001);
  CHECK(worst_off < 0.5);   // segments of an arc are cubics through its points
}

TEST_CASE("without lookahead a quick stop is a feed hold", "[programs]") {
  ProgramBench bench("a.pmc", kSetUp + "delete lookahead\nCoord[1].FeedHoldSlew=0.01\n");
  bench.machine->at(1000, "&1 \\");
  bench.machine->at(1500, "Coord[1].LookAheadStop Coord[1].FeedHold");
  bench.run("&1 b1r");
  REQUIRE(bench.refusals.empty());
  CHECK(bench.motor(1).final_mu == Approx(20000 + 1000).margin(1e-6));   // 20 mu/ms, 50 ms of path time more
  CHECK(bench.answers == std::vector<std::string>{"Coord[1].LookAheadStop=0", "Coord[1].FeedHold=1"});
}
