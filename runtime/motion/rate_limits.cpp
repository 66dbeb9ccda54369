#include "runtime/motion/rate_limits.h"

#include <algorithm>
#include <cmath>

namespace pmac::motion {
namespace {

/// x0 may lie on the border of what is possible, and beyond it by rounding; a band that hardly depends on x1 must not make
/// a small x1 of that.
constexpr double kRoundingRoom = 1e-6;
/// A band whose limit depends on x1 by less than this part of what it does on x0 stands upright.
constexpr double kUpright = 1e-9;

double largest_speed(const MotorCubic& q, double h) {
  double speed = std::max(std::abs(q.c1), std::abs(q.velocity(h)));
  const double extreme = q.c3 == 0 ? -1 : -q.c2 / (3 * q.c3);
  if (extreme > 0 && extreme < h) speed = std::max(speed, std::abs(q.velocity(extreme)));
  return speed;
}

/// |start * x0 + end * x1| <= 1.
void add_band(double start, double end, RateLimits& result) {
  const double by_start = std::abs(start), by_end = std::abs(end);
  if (by_start + by_end <= 1) return;
  if (by_end <= kUpright * by_start) {
    result.max_start_rate2 = std::min(result.max_start_rate2, (1 - std::min(1.0, by_end)) / by_start);
    return;
  }
  const double inverse = 1 / end;
  result.bands.push_back({-start * inverse, std::abs(inverse)});
}

void add_acceleration_bands(const MotorCubic& q, double h, double inv_accel, RateLimits& result) {
  const double k = inv_accel / (2 * h);
  if (q.c2 == 0 && q.c3 == 0) return add_band(-q.c1 * k, q.c1 * k, result);
  const double d0 = q.c1 * k, d1 = (q.c1 + h * q.c2) * k, d2 = q.velocity(h) * k;          // Bernstein coefficients of q'
  const double e0 = 2 * q.c2 * inv_accel, e1 = q.acceleration(h) * inv_accel;              // and of q''
  add_band(e0 - d0, d0, result);
  add_band(e1 / 2 - d1, e0 / 2 + d1, result);
  add_band(-d2, e1 + d2, result);
}

}  // namespace

/// What all bands leave of x1 at x0 lies between a convex polygon line from below and a concave one from above. From the right, Newton's method
/// comes to the place where they meet in a few steps: the next x0 is where the two lines meet that bind at this one.
double RateLimits::largest_start(double x0_max, double x1_max) const {
  double x0 = std::min(x0_max, max_start_rate2);
  for (std::size_t step = 0; step < 2 * bands.size() + 2; ++step) {
    double low = 0, low_slope = 0, low_offset = 0, high = x1_max, high_slope = 0, high_offset = x1_max;
    for (const RateBand& band : bands) {
      const double middle = band.slope * x0;
      if (middle + band.width < high) high = middle + band.width, high_slope = band.slope, high_offset = band.width;
      if (middle - band.width > low) low = middle - band.width, low_slope = band.slope, low_offset = -band.width;
    }
    if (low <= high) break;
    const double meet = (high_offset - low_offset) / (low_slope - high_slope);
    if (!(meet < x0)) break;
    x0 = std::max(0.0, meet);
  }
  return x0;
}

double RateLimits::largest_end(double x0, double x1_max) const {
  constexpr double kFull = 1 + kRoundingRoom;
  double x1 = x1_max;
  for (const RateBand& band : bands) x1 = std::min(x1, band.slope * x0 + kFull * band.width);
  return std::max(0.0, x1);
}

bool RateLimits::allows(double x0, double x1) const {
  constexpr double kFull = 1 + 2 * kRoundingRoom;
  if (std::max(x0, x1) > max_rate2 || x0 > max_start_rate2 * kFull) return false;
  return std::all_of(bands.begin(), bands.end(), [&](const RateBand& band) { return std::abs(x1 - band.slope * x0) <= kFull * band.width; });
}

RateLimits rate_limits(const Segment& segment, const std::vector<MotorLimits>& limits, double accel_share) {
  RateLimits result;
  const std::size_t motors = std::min(segment.motor.size(), limits.size());
  result.bands.reserve(3 * motors);
  for (std::size_t m = 0; m < motors; ++m) {
    const MotorCubic& q = segment.motor[m];
    const double inv_accel = limits[m].inv_amax_ms2_mu / accel_share, allowed = limits[m].max_speed_mu_ms;
    if (inv_accel > 0) add_acceleration_bands(q, segment.duration_ms, inv_accel, result);
    if (allowed <= 0) continue;
    const double speed = largest_speed(q, segment.duration_ms);
    if (speed > allowed) result.max_rate2 = std::min(result.max_rate2, (allowed / speed) * (allowed / speed));
  }
  return result;
}

}  // namespace pmac::motion
