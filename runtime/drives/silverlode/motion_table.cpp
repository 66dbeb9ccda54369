#include "runtime/drives/silverlode/motion_table.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "runtime/drives/silverlode/units.h"

namespace pmac::drives::silverlode {
namespace {

constexpr int kMostRounds = 10;
constexpr double kFirstRoom = 0.98;      // of the limits, where slowing down begins
constexpr double kUsable = 0.998;        // what rounding to servo units may add stays below the limit
constexpr double kLeastRoom = 0.02;

/// How much each ramp uses of the limits: the larger of acceleration and speed squared, 1 at a limit. [1..n+1]
std::vector<double> use_of(const SplineFit& fit, std::span<const CountLimits> limits) {
  const std::size_t ramps = fit.ramp_ticks.size() - 1;
  std::vector<double> use(ramps + 1, 0.0);
  for (std::size_t a = 0; a < limits.size(); ++a) {
    const auto speed = [&](std::size_t i) {     // of segment i, counts/s
      if (i == 0 || i >= ramps) return 0.0;
      return (fit.corner_counts[a][i] - fit.corner_counts[a][i - 1]) / ((fit.ramp_ticks[i] + fit.ramp_ticks[i + 1]) / 2 * kTick_s);
    };
    for (std::size_t i = 1; i <= ramps; ++i) {
      const double of_speed = std::abs(speed(i)) / (limits[a].speed_counts_s * kUsable);
      const double of_accel = std::abs(speed(i) - speed(i - 1)) / (fit.ramp_ticks[i] * kTick_s) / (limits[a].accel_counts_s2 * kUsable);
      use[i] = std::max({use[i], of_accel, of_speed * of_speed});
    }
  }
  return use;
}

/// Takes room away around every ramp that uses too much. commanded_s: by servo cycle of the fitted motion.
void narrow(std::vector<double>& room, const SplineFit& fit, const std::vector<double>& use, const std::vector<double>& commanded_s, double period_s) {
  std::vector<double> factor(room.size(), 1.0);
  const auto row_at = [&](double ticks) {
    const double row = std::clamp(ticks * kTick_s / period_s, 0.0, static_cast<double>(commanded_s.size() - 1));
    const double commanded_row = commanded_s[static_cast<std::size_t>(row)] / period_s;
    return static_cast<std::size_t>(std::clamp(commanded_row, 0.0, static_cast<double>(room.size() - 1)));
  };
  double begin = 0;
  for (std::size_t i = 1; i < use.size(); begin += fit.ramp_ticks[i], ++i) {
    if (use[i] <= 1) continue;
    const double before = i > 1 ? fit.ramp_ticks[i - 1] : 0, after = i + 1 < use.size() ? fit.ramp_ticks[i + 1] : 0;
    const std::size_t last = row_at(begin + fit.ramp_ticks[i] + after);
    for (std::size_t row = row_at(begin - before); row <= last; ++row) factor[row] = std::min(factor[row], std::max(0.98 / use[i], 0.3));
  }
  for (std::size_t row = 0; row < room.size(); ++row) room[row] = std::max(kLeastRoom, room[row] * factor[row]);
}

/// Longer ramps by one factor leave the path as it is.
void stretch_all(MotionFit& result, double factor) {
  result.stretch = factor;
  for (std::size_t i = 1; i < result.fit.ramp_ticks.size(); ++i) result.fit.ramp_ticks[i] = 2 * std::ceil(result.fit.ramp_ticks[i] * factor / 2 - 1e-9);
}

std::string too_long(const Slowed& slower) {
  return fmt::format("within max_speed and max_accel the motion would take {:.3g} s, which is too long to be encoded; raise them, or lower scale", slower.duration_s);
}

}  // namespace

std::variant<MotionFit, std::string> fit_within(const Commanded& motion, std::span<const CountLimits> limits, const FitSetup& setup) {
  std::vector<double> room(motion.rows(), kFirstRoom);
  MotionFit result{motion, {}, false, 1};
  std::vector<double> commanded_s;
  if (exceeds(motion, limits)) {
    Slowed slower = slowed_to(motion, limits, room);
    if (!slower.motion.moves()) return too_long(slower);
    result = {std::move(slower.motion), {}, true, 1};
    commanded_s = std::move(slower.commanded_s);
  } else {
    for (std::size_t row = 0; row < motion.rows(); ++row) commanded_s.push_back(static_cast<double>(row) * motion.period_s());
  }
  for (int round = 0;; ++round) {
    result.fit = fit_spline(result.motion, setup);
    const std::vector<double> use = use_of(result.fit, limits);
    const double most = *std::max_element(use.begin(), use.end());
    if (most <= 1) return result;
    if (round == kMostRounds) {
      stretch_all(result, std::sqrt(most) * 1.0001);
      return result;
    }
    narrow(room, result.fit, use, commanded_s, motion.period_s());
    Slowed slower = slowed_to(motion, limits, room);
    if (!slower.motion.moves()) return too_long(slower);
    result = {std::move(slower.motion), {}, true, 1};
    commanded_s = std::move(slower.commanded_s);
  }
}

}  // namespace pmac::drives::silverlode
