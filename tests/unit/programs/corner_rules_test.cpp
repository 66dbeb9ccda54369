// Corner rules and limits of the feed rate in whole programs. Expected values are closed forms: a blend of constant acceleration at a right
// angle passes its corner at dv * Ta / 8 with dv = sqrt(2) v, and a radius of (v^2 / 2) / (dv / Ta) half way.
#include <algorithm>
#include <cmath>

#include "tests/unit/programs/lines.h"

using namespace pmac::test;

namespace {

/// Distance of the samples from the corner at (10, 0); a stop lies up to half a tick from one, 3e-6.
double distance_from_corner(const ProgramBench& bench) {
  double nearest = 1e300;
  for (const auto& row : bench.motor_mu) nearest = std::min(nearest, std::hypot(row[1] / 1000 - 10, row[2] / 1000));
  return nearest;
}

const std::string kCorner = "X10\nY10";
const double kFree = std::sqrt(2.0) * 0.01 * 100 / 8;   // 10 mm/s, ta 100

}  // namespace

TEST_CASE("CornerError: the blend comes as near to the corner as it says", "[programs][corner]") {
  for (const char* segments : {"", "Coord[1].SegMoveTime=5 "}) {
    CHECK(distance_from_corner(Lines(kCorner, segments)) == Approx(kFree).epsilon(1e-3));
    CHECK(distance_from_corner(Lines(kCorner, std::string(segments) + "Coord[1].CornerError=0.05")) == Approx(0.05).epsilon(1e-2));
    CHECK(distance_from_corner(Lines(kCorner, std::string(segments) + "Coord[1].CornerError=0.5")) == Approx(kFree).epsilon(1e-3));
  }
  CHECK(distance_from_corner(Lines("ts50\n" + kCorner, "Coord[1].CornerError=0.05")) == Approx(0.05).epsilon(1e-2));
  const Lines bench(kCorner, "Coord[1].CornerError=0.05");
  CHECK(bench.moves[1].end_ms == Approx(2100.0).margin(1e-9));   // times stay
}

TEST_CASE("CornerError that the motors cannot keep while moving is a stop", "[programs][corner]") {
  const Lines bench(kCorner, "Coord[1].CornerError=0.05 Motor[1].InvAmax=5 Motor[2].InvAmax=5 Motor[1].InvDmax=5 Motor[2].InvDmax=5");   // 50 ms a ramp
  CHECK(distance_from_corner(bench) < 1e-5);
  CHECK(bench.moves[1].end_ms == Approx(2200.0).margin(1e-6));
}

TEST_CASE("CornerAccel and CornerRadius make the blend longer", "[programs][corner]") {
  const std::string segments = "Coord[1].SegMoveTime=5 ";
  const double dv = std::sqrt(2.0) * 0.01;
  // 70.7 mm/s^2 is half the acceleration of the free blend
  CHECK(distance_from_corner(Lines(kCorner, segments + "Coord[1].CornerAccel=70.7106781")) == Approx(2 * kFree).epsilon(1e-3));
  CHECK(distance_from_corner(Lines(kCorner, segments + "Coord[1].CornerAccel=1000")) == Approx(kFree).epsilon(1e-3));
  // radius 1: acceleration (0.01^2 / 2) / 1 a ms^2
  CHECK(distance_from_corner(Lines(kCorner, segments + "Coord[1].CornerRadius=1")) == Approx(dv * (dv / 5e-5) / 8).epsilon(1e-3));
  CHECK(distance_from_corner(Lines(kCorner, segments + "Coord[1].CornerRadius=1 Coord[1].CornerError=0.1")) == Approx(0.1).epsilon(1e-2));
}

TEST_CASE("NoCornerBp leaves corners alone that are no sharper", "[programs][corner]") {
  const std::string rule = "Coord[1].CornerError=0.001 Coord[1].NoCornerBp=";
  CHECK(distance_from_corner(Lines(kCorner, rule + "-0.1")) == Approx(kFree).epsilon(1e-3));   // cosine 0 is above
  CHECK(distance_from_corner(Lines(kCorner, rule + "0.1")) < 0.01);
}

TEST_CASE("CornerBlendBp: a corner sharper than it is a stop", "[programs][corner]") {
  const Lines stops(kCorner, "Coord[1].CornerBlendBp=0.1"), blends(kCorner, "Coord[1].CornerBlendBp=-0.1");
  CHECK(distance_from_corner(stops) < 1e-5);
  CHECK(stops.moves[1].end_ms == Approx(2200.0).margin(1e-9));
  CHECK(distance_from_corner(blends) == Approx(kFree).epsilon(1e-3));
}

TEST_CASE("MaxCirAccel: F on an arc is at most sqrt(MaxCirAccel * R)", "[programs][corner]") {
  // half a circle of radius 4: at F10 25 mm/s^2; 9 mm/s^2 is F6. Ramps of 100 ms: half of each beside the block's time.
  const std::string arc = "circle2 X0 Y8 I0 J4";
  const double length = 4 * std::acos(-1.0);
  CHECK(Lines(arc, "Coord[1].SegMoveTime=5").moves[0].end_ms == Approx(length / 10 * 1000 + 100).margin(1e-6));
  CHECK(Lines(arc, "Coord[1].SegMoveTime=5 Coord[1].MaxCirAccel=9").moves[0].end_ms == Approx(length / 6 * 1000 + 100).margin(1e-6));
  CHECK(Lines(arc, "Coord[1].SegMoveTime=5 Coord[1].MaxCirAccel=36").moves[0].end_ms == Approx(length / 10 * 1000 + 100).margin(1e-6));
  // a helix: 6 mm of Z on the way; the arc's share of F counts
  const double helix = std::hypot(length, 6);
  CHECK(Lines(arc + " Z6", "Coord[1].SegMoveTime=5 Coord[1].MaxCirAccel=9").moves[0].end_ms ==
        Approx(std::max(length / 6, helix / 10) * 1000 + 100).margin(1e-6));
}

TEST_CASE("a rapid move goes past a target that changes behind it, and comes back", "[programs][corner]") {
  // 10 mu/ms; at 500 ms the motor is at 4500 and told to go to 3000: one ramp of 100 ms from 10 to -10 would not do with times given
  ProgramBench bench("a.pmc", "Sys.ServoPeriod=1\n&1 #1->1000X\nMotor[1].MaxSpeed=10 Motor[1].JogTa=-10 Motor[1].JogTs=0\nopen plc 1\nLdata.Coord=1\n"
                              "if (P1 == 0) { pmatch abs X9 P1=1 }\nif (P1 == 1 && Sys.Time >= 0.5) { X3 P1=2 disable plc 1 }\nclose\n");
  bench.run("enable plc 1");
  REQUIRE(bench.faults.empty());
  CHECK(bench.motor(1).final_mu == 3000);
  CHECK(bench.motor(1).max_accel_mu_ms2 <= 0.1 + 1e-9);
  CHECK(bench.motor(1).max_mu == Approx(4500 + 500).margin(20));   // v^2 / 2a beyond; the PLC sees the time up to 1 ms late
}
