// Random motion programs (tests/reference/random_motion.h) through kinematic routines. PMAC_RANDOM_PROGRAMS: how many, 25 if not set;
// PMAC_RANDOM_SEED: where to begin. The routines are a plain one, which must do what axis definitions do, and a bent one whose inverse is a
// closed form:
//
//     motor 1 = 1000 X + 8 Y^2 - 3 Z Y        motor 2 = 1000 Y + 200 sin(X / 5)        motor 3 = 1000 Z + 4 X Y
//     forward: sixty steps of a contraction from (m1, m2, m3) / 1000
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <random>
#include <string>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "tests/property/motion_check.h"

using namespace pmac::test;
using pmac::reference::kMotionItemKinds;
using pmac::reference::MotionItem;
using pmac::reference::MotionSpec;
using pmac::reference::random_motion;
using pmac::reference::RandomMotion;

namespace {

using Point = std::array<double, 3>;

int from_environment(const char* name, int otherwise) {
  const char* text = std::getenv(name);
  return text ? std::atoi(text) : otherwise;
}

const std::string kDefinitions = "&1\n#1->1000X\n#2->1000Y\n#3->1000Z\n";

const std::string kPlain = R"(&1
#1->I
#2->I
#3->I
open inverse (1)
KinPosMotor1 = KinPosAxisX * 1000
KinPosMotor2 = KinPosAxisY * 1000
KinPosMotor3 = KinPosAxisZ * 1000
close
open forward (1)
KinPosAxisX = KinPosMotor1 / 1000
KinPosAxisY = KinPosMotor2 / 1000
KinPosAxisZ = KinPosMotor3 / 1000
KinAxisUsed = $1C0
close
)";

const std::string kBent = R"(&1
#1->I
#2->I
#3->I
open inverse (1)
KinPosMotor1 = 1000 * KinPosAxisX + 8 * KinPosAxisY * KinPosAxisY - 3 * KinPosAxisZ * KinPosAxisY
KinPosMotor2 = 1000 * KinPosAxisY + 200 * sin(KinPosAxisX / 5)
KinPosMotor3 = 1000 * KinPosAxisZ + 4 * KinPosAxisX * KinPosAxisY
close
open forward (1)
Ldata.GoBack = 100
L400 = KinPosMotor1 / 1000
L401 = KinPosMotor2 / 1000
L402 = KinPosMotor3 / 1000
L403 = 0
while (L403 < 60) {
  L404 = (KinPosMotor1 - 8 * L401 * L401 + 3 * L402 * L401) / 1000
  L405 = (KinPosMotor2 - 200 * sin(L404 / 5)) / 1000
  L402 = (KinPosMotor3 - 4 * L404 * L405) / 1000
  L400 = L404
  L401 = L405
  L403++
}
KinPosAxisX = L400
KinPosAxisY = L401
KinPosAxisZ = L402
KinAxisUsed = $1C0
close
)";

Point bent_motors(const Point& p) {
  const auto [x, y, z] = p;
  return {1000 * x + 8 * y * y - 3 * z * y, 1000 * y + 200 * std::sin(x / 5), 1000 * z + 4 * x * y};
}

MotionSpec random_spec(unsigned seed, bool lookahead) {
  std::mt19937 random(seed);
  const auto between = [&](int low, int high) { return std::uniform_int_distribution<int>(low, high)(random); };
  const auto one_of = [&](std::initializer_list<int> values) { return values.begin()[between(0, static_cast<int>(values.size()) - 1)]; };
  MotionSpec spec;
  spec.set_up.segment_ms = one_of({1, 2, 5, 5, 10});
  spec.set_up.lookahead = lookahead;
  spec.set_up.window = one_of({3, 20, 200, 2000});
  spec.set_up.ta_ms = one_of({5, 20, 50, 100});
  spec.set_up.ts_ms = one_of({0, 0, 5, 20});
  spec.set_up.td_ms = one_of({5, 20, 50, 100});
  spec.set_up.feed = between(10, 200);
  spec.set_up.accel = between(3, 40);
  spec.set_up.max_speed = one_of({40, 100, 500});
  for (int n = between(1, 8); n > 0; --n) {
    MotionItem item{between(0, kMotionItemKinds - 1), between(-150, 150), between(-150, 150), between(-150, 150), between(0, 300)};
    if (item.kind == 7 || item.kind == 13) item.kind = 0;   // rapid has limits of its own, spline none
    spec.items.push_back(item);
  }
  return spec;
}

MotionRun run_with(const RandomMotion& motion, const std::string& routines) {
  std::string text = motion.text;
  REQUIRE(text.starts_with(kDefinitions));
  MotionRun run = run_motion(text.replace(0, kDefinitions.size(), routines));
  INFO(text);
  CHECK(run.fault == "");
  return run;
}

void check_at(const MotionRun& run, const Point& motors_mu) {
  REQUIRE_FALSE(run.position_mu.empty());
  for (std::size_t m = 0; m < 3; ++m) CHECK(run.position_mu.back()[m] == Approx(motors_mu[m]).margin(1e-6));
}

/// The greatest distance of any motor's positions at the same time, and after the end of the shorter run.
double apart_mu(const MotionRun& a, const MotionRun& b) {
  double apart = 0;
  for (std::size_t i = 0; i < std::max(a.position_mu.size(), b.position_mu.size()); ++i)
    for (std::size_t m = 0; m < 3; ++m)
      apart = std::max(apart, std::abs(a.position_mu[std::min(i, a.position_mu.size() - 1)][m] - b.position_mu[std::min(i, b.position_mu.size() - 1)][m]));
  return apart;
}

template <class Check>
void for_random_programs(bool lookahead, const Check& check) {
  const unsigned first = static_cast<unsigned>(from_environment("PMAC_RANDOM_SEED", 1)) * 10'000;
  const unsigned count = static_cast<unsigned>(from_environment("PMAC_RANDOM_PROGRAMS", 25));
  for (unsigned seed = first; seed < first + count; ++seed) {
    const MotionSpec spec = random_spec(seed, lookahead);
    const RandomMotion motion = random_motion(spec);
    INFO("seed " << seed << "\n" << motion.text);
    check(spec, motion);
  }
}

}  // namespace

TEST_CASE("random motion through plain routines: ends, dwells, lengths and limits are those of axis definitions", "[property][kinematics]") {
  for (const bool lookahead : {false, true})
    for_random_programs(lookahead, [&](const MotionSpec& spec, const RandomMotion& motion) {
      const MotionRun run = run_with(motion, kPlain);
      CHECK(wrong_end(motion, run) == "");
      CHECK(wrong_dwell(motion, run) == "");
      CHECK(wrong_lengths(motion, run) == "");
      CHECK(wrong_times(run) == "");
      if (!lookahead) CHECK(wrong_pvt_times(motion, run) == "");
      // Both have the same nodes, and velocities that differ by dv move the positions between two of them by at most 4/27 h dv. They are the same
      // but for rounding on lines and pvt moves; in pieces of arcs with six nodes and more, at most 0.1 rad apart, dv is up to 0.1^5 / 6 of the
      // speed: 7e-4 mu at 300 mu/ms and nodes of 10 ms.
      const MotionRun by_definitions = run_motion(motion.text);
      if (!lookahead) CHECK(apart_mu(run, by_definitions) < 1e-3);
      // Straight lines of linear maps are longer segments: a short window sees further by as much.
      if (lookahead && spec.set_up.window >= 200) CHECK(static_cast<double>(run.position_mu.size()) == Approx(static_cast<double>(by_definitions.position_mu.size())).epsilon(1e-3).margin(1));
      if (lookahead) CHECK(broken_limit(spec.set_up, run) == "");
    });
}

TEST_CASE("random motion through bent routines: ends are exact, and lookahead keeps the motors' limits at servo rate", "[property][kinematics]") {
  for_random_programs(true, [](const MotionSpec& spec, const RandomMotion& motion) {
    const MotionRun run = run_with(motion, kBent);
    check_at(run, bent_motors(motion.end_uu));
    CHECK(wrong_lengths(motion, run) == "");
    CHECK(broken_limit(spec.set_up, run) == "");
    CHECK(difference(run, run_with(motion, kBent)) == "");
  });
}

TEST_CASE("random motion through bent routines: a larger window changes nothing once it covers the path", "[property][kinematics]") {
  for_random_programs(true, [](MotionSpec spec, const RandomMotion&) {
    spec.set_up.window = 20000;
    const MotionRun whole = run_with(random_motion(spec), kBent);
    spec.set_up.window = 15000;
    CHECK(difference(run_with(random_motion(spec), kBent), whole) == "");
  });
}
