// Any motion as a table: samples in, corners and ramps out, limits kept.
#include <catch2/catch.hpp>

#include <cmath>
#include <functional>

#include "runtime/drives/silverlode/motion_table.h"
#include "runtime/drives/silverlode/path_table.h"
#include "runtime/drives/silverlode/servo.h"
#include "runtime/drives/silverlode/units.h"

using namespace pmac::drives::silverlode;

namespace {

constexpr double kPeriod_ms = 0.5;

/// A motion of two motors, sampled.
Commanded motion_of(double duration_s, const std::function<std::pair<double, double>(double)>& at) {
  Commanded motion;
  const int count = static_cast<int>(std::ceil(duration_s * 1000 / kPeriod_ms)) + 1;
  std::vector<double> position;
  for (int axis = 0; axis < 2; ++axis)
    for (int k = 0; k < count; ++k) {
      const auto [x, y] = at(std::min(k * kPeriod_ms / 1000, duration_s));
      position.push_back(axis == 0 ? x : y);
    }
  const std::vector<int> motors{3, 5};
  const std::vector<double> home{0, 0};
  motion.take({0, kPeriod_ms, count, motors, position, position, home});
  const std::vector<double> scale{1};
  motion.finish(scale);
  return motion;
}

/// Distance after a time of a trapezoid of speed from 0 to 0: length in duration, ramps of ramp_s.
double trapezoid(double t, double length, double duration_s, double ramp_s) {
  const double speed = length / (duration_s - ramp_s);
  if (t < ramp_s) return speed * t * t / (2 * ramp_s);
  if (t > duration_s - ramp_s) return length - speed * (duration_s - t) * (duration_s - t) / (2 * ramp_s);
  return speed * (t - ramp_s / 2);
}

struct Executed { double path_error = 0, timed_error = 0, end_error = 0, most_speed = 0, most_accel = 0; };

/// The table of a fit on servos that are fed in time.
Executed execute_fit(const MotionFit& made) {
  const SplineFit& fit = made.fit;
  const std::size_t n = fit.ramp_ticks.size() - 2;
  Sheet sheet = empty_sheet({"X", "Y"}, n);
  for (std::size_t a = 0; a < 2; ++a) {
    for (std::size_t i = 0; i <= n; ++i) {
      sheet.axis[a].position[i] = fit.corner_counts[a][i];
      if (i > 0) sheet.axis[a].delta[i] = fit.corner_counts[a][i] - fit.corner_counts[a][i - 1];
    }
    sheet.axis[a].position[n + 1] = sheet.axis[a].position[n];
  }
  PathTable path;
  path.ramp_ticks = fit.ramp_ticks;
  path.makes_up = true;
  path.limits.assign(2, {4000, 1e6});
  REQUIRE_FALSE(fill_closed(sheet, path));
  const auto table = table_from(sheet);
  REQUIRE(table.index() == 0);
  Executed result;
  std::vector<Profile> before;
  execute(std::get<Table>(table), [&](std::int64_t tick, std::span<const Profile> servos) {
    const double t = (static_cast<double>(tick) + 0.5) * kTick_s / made.stretch;
    const std::vector<double> at{static_cast<double>(servos[0].position) / kUnitsPerCount, static_cast<double>(servos[1].position) / kUnitsPerCount};
    result.timed_error = std::max(result.timed_error, std::hypot(at[0] - made.motion.position(0, t), at[1] - made.motion.position(1, t)));
    result.path_error = std::max(result.path_error, made.motion.distance(at, t));
    result.end_error = std::hypot(at[0] - made.motion.position(0, 1e9), at[1] - made.motion.position(1, 1e9));
    for (std::size_t a = 0; a < servos.size(); ++a) {
      result.most_speed = std::max(result.most_speed, std::abs(static_cast<double>(servos[a].velocity)) / kUnitsPerCount / kTick_s);
      if (!before.empty()) result.most_accel = std::max(result.most_accel, std::abs(static_cast<double>(servos[a].velocity - before[a].velocity)) / kUnitsPerCount / kTick_s / kTick_s);
    }
    before.assign(servos.begin(), servos.end());
  });
  return result;
}

MotionFit fitted(const Commanded& motion, const std::vector<CountLimits>& limits, const FitSetup& setup = {}) {
  auto made = fit_within(motion, limits, setup);
  REQUIRE(made.index() == 0);
  return std::move(std::get<MotionFit>(made));
}

std::vector<CountLimits> both(double speed, double accel) { return {{speed, accel}, {speed, accel}}; }

/// Once round a circle of radius 10,000 counts in 2 s, ramps of 0.2 s.
Commanded circle() {
  return motion_of(2, [](double t) {
    const double angle = trapezoid(t, 2 * std::acos(-1.0), 2, 0.2);
    return std::pair(10'000 * std::cos(angle) - 10'000, 10'000 * std::sin(angle));
  });
}

}  // namespace

TEST_CASE("fit: a trapezoid of speed is met by the ramps it consists of", "[silverlode]") {
  const Commanded motion = motion_of(3, [](double t) { return std::pair(trapezoid(t, 50'000, 3, 0.5), trapezoid(t, -20'000, 3, 0.5)); });
  const MotionFit made = fitted(motion, both(1e5, 1e6));
  CHECK_FALSE(made.is_slowed);
  CHECK(made.fit.ramp_ticks.size() < 40);
  const Executed run = execute_fit(made);
  CHECK(run.timed_error < 0.6);
  CHECK(run.end_error < 0.1);
}

TEST_CASE("fit: a circle is followed as a curve, far closer than by chords of the same length", "[silverlode]") {
  const MotionFit made = fitted(circle(), both(1e6, 1e7));
  const Executed run = execute_fit(made);
  const double chord_ticks = 2 / kTick_s / static_cast<double>(made.fit.ramp_ticks.size());
  const double sagitta = 10'000 * (1 - std::cos(std::acos(-1.0) * chord_ticks * kTick_s / 2));
  CHECK(run.path_error < 1.0);
  CHECK(run.path_error < sagitta / 3);
  CHECK(run.end_error < 0.01);
}

TEST_CASE("fit: entries are never shorter than the line needs", "[silverlode]") {
  FitSetup setup;
  setup.tolerance_counts = 0;
  setup.least_ticks = 500;
  const MotionFit made = fitted(circle(), both(1e6, 1e7), setup);
  for (std::size_t i = 1; i < made.fit.ramp_ticks.size(); ++i) {
    CHECK(made.fit.ramp_ticks[i] >= 500);
    CHECK(std::fmod(made.fit.ramp_ticks[i], 2) == 0);
  }
}

TEST_CASE("fit: a motion beyond the limits is slowed down along its path and keeps them at every tick", "[silverlode]") {
  // In the circle v = 2 pi r / 1.8 s = 34907 counts/s and v^2 / r = 121,847 counts/s^2.
  for (const double accel : {100'000.0, 30'000.0, 3'000.0}) {
    const MotionFit made = fitted(circle(), both(20'000, accel));
    CAPTURE(accel, made.stretch);
    const Executed run = execute_fit(made);
    CHECK(made.is_slowed);
    CHECK(run.most_speed <= 20'000 * 1.0001);
    CHECK(run.most_accel <= accel * 1.002);
    CHECK(run.path_error < 1);
    CHECK(run.end_error < 0.05);
    // Never longer than at a constant speed that keeps the limits in the curve, with ramps.
    const double speed = std::min(20'000.0, std::sqrt(accel * 10'000));
    CHECK(made.motion.duration_s() < 2 * std::acos(-1.0) * 10'000 / speed + 2 * speed / accel * 1.5);
  }
}

TEST_CASE("fit: a corner that is taken at speed is slowed down for", "[silverlode]") {
  const Commanded motion = motion_of(2, [](double t) { return t < 1 ? std::pair(10'000 * trapezoid(t + 0.1, 1, 2.2, 0.1), 0.0) : std::pair(10'000 * trapezoid(1.1, 1, 2.2, 0.1), 10'000 * (t - 1)); });
  const MotionFit made = fitted(motion, both(1e5, 1e5));
  const Executed run = execute_fit(made);
  CHECK(made.is_slowed);
  CHECK(run.most_accel <= 1e5 * 1.002);
  CHECK(run.path_error < 15);
}

TEST_CASE("commanded motion: motors that stand are left out, rest before and after is cut off", "[silverlode]") {
  const Commanded motion = motion_of(3, [](double t) { return std::pair(7.0, trapezoid(std::clamp(t - 1, 0.0, 1.0), 1000, 1, 0.2)); });
  CHECK(motion.motors() == std::vector<int>{5});
  CHECK(motion.start_s() == Approx(1).margin(0.001));
  CHECK(motion.duration_s() == Approx(1).margin(0.002));
  CHECK(motion.position(0, -5) == 0);
  CHECK(motion.position(0, 50) == Approx(1000));
  CHECK(motion.position(0, 0.5) == Approx(500).margin(0.5));
}

TEST_CASE("commanded motion: nothing that moves is no motion", "[silverlode]") {
  CHECK_FALSE(motion_of(1, [](double) { return std::pair(1.0, 2.0); }).moves());
}

TEST_CASE("commanded motion: the distance from the path does not count where along it", "[silverlode]") {
  const Commanded motion = motion_of(1, [](double t) { return std::pair(1000 * t, 0.0); });
  // Y never moves: one axis is left.
  REQUIRE(motion.axes() == 1);
  const Commanded slanted = motion_of(1, [](double t) { return std::pair(1000 * t, 1000 * t); });
  const std::vector<double> beside{500 + 3, 500 - 3};
  CHECK(slanted.distance(beside, 0.4) == Approx(std::sqrt(18.0)).epsilon(1e-6));
}

TEST_CASE("fit: limits that would make the motion last for hours are refused", "[silverlode]") {
  const auto made = fit_within(circle(), both(1, 1e7), {});
  REQUIRE(made.index() == 1);
  CHECK(std::get<std::string>(made).find("too long to be encoded") != std::string::npos);
}
