#include "runtime/motion/position_limits.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace pmac::motion {
namespace {

constexpr double kRounding_mu = 1e-6;  // that a path which ends at the limit may pass it by
constexpr int kBisections = 60;

/// Times in (0, duration) at which the motor turns round, ascending, then the duration.
std::array<double, 3> ends_of_monotone_parts(const MotorCubic& q, double duration_ms) {
  std::array<double, 3> ends{duration_ms, duration_ms, duration_ms};
  const double a = 3 * q.c3, b = 2 * q.c2, c = q.c1, discriminant = b * b - 4 * a * c;
  if (discriminant < 0) return ends;
  const double sum = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
  double first = a != 0 ? sum / a : duration_ms, second = sum != 0 ? c / sum : duration_ms;
  if (first > second) std::swap(first, second);
  if (second > 0 && second < duration_ms) ends[1] = second;
  ends[0] = first > 0 && first < duration_ms ? first : ends[1];
  return ends;
}

/// When q rises above the limit, or above its start where that lies beyond.
std::optional<double> rises_above(const MotorCubic& q, double limit_mu, double duration_ms) {
  const double bound_mu = std::max(limit_mu, q.c0);
  double from_ms = 0;
  for (const double end_ms : ends_of_monotone_parts(q, duration_ms)) {
    if (q.position(end_ms) > bound_mu + kRounding_mu) {
      double inside = from_ms, outside = end_ms;
      for (int i = 0; i < kBisections; ++i) {
        const double middle = (inside + outside) / 2;
        (q.position(middle) > bound_mu ? outside : inside) = middle;
      }
      return inside;
    }
    from_ms = end_ms;
  }
  return std::nullopt;
}

}  // namespace

std::optional<LimitCrossing> first_crossing(const Segment& segment, std::span<const MotorLimits> limits) {
  std::optional<LimitCrossing> first;
  const auto note = [&](std::optional<double> at_ms, std::size_t motor, bool plus) {
    if (at_ms && (!first || *at_ms < first->at_ms)) first = LimitCrossing{*at_ms, static_cast<int>(motor), plus};
  };
  for (std::size_t m = 0; m < segment.motor.size() && m < limits.size(); ++m) {
    const MotorCubic& q = segment.motor[m];
    if (std::isfinite(limits[m].max_position_mu)) note(rises_above(q, limits[m].max_position_mu, segment.duration_ms), m, true);
    if (std::isfinite(limits[m].min_position_mu))
      note(rises_above({-q.c0, -q.c1, -q.c2, -q.c3}, -limits[m].min_position_mu, segment.duration_ms), m, false);
  }
  return first;
}

}  // namespace pmac::motion
