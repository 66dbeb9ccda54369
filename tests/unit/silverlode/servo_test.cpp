// The profile of one servo: loop against closed form, and moves to a position.
#include <catch2/catch.hpp>

#include <random>

#include "runtime/drives/silverlode/servo.h"
#include "runtime/drives/silverlode/units.h"

using namespace pmac::drives::silverlode;

TEST_CASE("servo: the loop covers v t + a t (t + 1) / 2 in a ramp, and v a tick after it", "[silverlode]") {
  std::mt19937 random(7);
  const auto between = [&random](std::int64_t low, std::int64_t high) { return std::uniform_int_distribution<std::int64_t>(low, high)(random); };
  for (int k = 0; k < 500; ++k) {
    const std::int64_t from = between(-400'000'000, 400'000'000), acc = between(1, 1'000'000), steps = between(0, 400);
    const std::int64_t to = from + (k % 2 == 0 ? 1 : -1) * acc * steps, slew = between(0, 300);
    Profile profile{between(-1'000'000, 1'000'000), from};
    const std::int64_t start = profile.position;
    const AxisMove move{static_cast<std::int32_t>(to < 0 ? -kFarPosition : kFarPosition), static_cast<std::int32_t>(acc), static_cast<std::int32_t>(std::abs(to))};
    for (std::int64_t i = 0; i < steps + slew; ++i) step(profile, move);
    CHECK(profile.velocity == to);
    CHECK(full_ramp_ticks(from, to, acc) == steps);
    CHECK(profile.position - start == ramp_distance(from, to < from ? -acc : acc, steps) + slew * to);
  }
}

TEST_CASE("servo: an acceleration of 0 keeps the velocity", "[silverlode]") {
  Profile profile{0, 12345};
  for (int i = 0; i < 10; ++i) step(profile, {kFarPosition, 0, 999});
  CHECK(profile.velocity == 12345);
  CHECK(profile.position == 123450);
}

TEST_CASE("servo: a move to a position stops on it within its acceleration and never passes it", "[silverlode]") {
  std::mt19937 random(11);
  const auto between = [&random](std::int64_t low, std::int64_t high) { return static_cast<std::int32_t>(std::uniform_int_distribution<std::int64_t>(low, high)(random)); };
  for (int k = 0; k < 200; ++k) {
    const AxisMove move{between(-5000, 5000), between(1000, 2'000'000), between(1'000'000, 300'000'000)};
    Profile profile;
    const std::int64_t target = std::int64_t{move.pos} * kUnitsPerCountInt;
    std::int64_t before = 0, ticks = 0;
    bool within = true, passed = false;
    for (; ticks < 2'000'000 && (profile.position != target || profile.velocity != 0); ++ticks) {
      step(profile, move);
      within = within && std::abs(profile.velocity - before) <= move.acc && std::abs(profile.velocity) <= move.vel;
      passed = passed || std::abs(profile.position) > std::abs(target);
      before = profile.velocity;
    }
    CAPTURE(k, move.pos, move.acc, move.vel);
    CHECK(profile.position == target);
    CHECK(profile.velocity == 0);
    CHECK(within);
    CHECK_FALSE(passed);
  }
}

TEST_CASE("servo: a position that cannot be reached without passing it is come back to", "[silverlode]") {
  const AxisMove move{10, 100'000, 50'000'000};
  Profile profile{0, 60'000'000};    // far too fast to stop within 10 counts
  std::int64_t furthest = 0;
  for (int i = 0; i < 20'000; ++i) {
    step(profile, move);
    furthest = std::max(furthest, profile.position);
  }
  CHECK(furthest > 10 * kUnitsPerCountInt);
  CHECK(profile.position == 10 * kUnitsPerCountInt);
  CHECK(profile.velocity == 0);
}

TEST_CASE("servo: slowing down to rest takes v / a ticks", "[silverlode]") {
  Profile profile{0, 1000};
  int ticks = 0;
  for (; profile.velocity != 0; ++ticks) step_to_rest(profile, 10);
  CHECK(ticks == 100);
  CHECK(profile.position == 10 * 99 * 100 / 2);
  profile.velocity = 77;
  step_to_rest(profile, 0);
  CHECK(profile.velocity == 0);
}
