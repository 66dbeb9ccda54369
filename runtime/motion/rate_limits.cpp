#include "runtime/motion/rate_limits.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pmac::motion {
namespace {

/// x0 may lie on the border of what is possible, and beyond it by rounding; a band that hardly depends on x1 must not make
/// a small x1 of that.
constexpr double kRoundingRoom = 1e-6;
/// A band whose limit depends on x1 by less than this part of what it does on x0 stands upright.
constexpr double kUpright = 1e-9;

/// One motor over a stretch: velocity and acceleration at both of its ends, per programmed time.
struct MotorEnds { double v0, v1, a0, a1; };

MotorEnds ends_of(const MotorCubic& q, const Stretch& stretch) {
  const double to_ms = stretch.from_ms + stretch.duration_ms;
  return {q.velocity(stretch.from_ms), q.velocity(to_ms), q.acceleration(stretch.from_ms), q.acceleration(to_ms)};
}

double largest_speed(const MotorEnds& ends, double h) {
  const double speed = std::max(std::abs(ends.v0), std::abs(ends.v1));
  if (ends.a0 * ends.a1 >= 0) return speed;
  return std::max(speed, std::abs(ends.v0 + ends.a0 * ends.a0 * h / (2 * (ends.a0 - ends.a1))));   // the extreme between them
}

/// |start * x0 + end * x1| <= 1.
inline void add_band(double start, double end, RateLimits& result) {
  const double by_start = std::abs(start), by_end = std::abs(end);
  if (by_start + by_end <= 1) return;
  if (by_end <= kUpright * by_start) {
    result.max_start_rate2 = std::min(result.max_start_rate2, (1 - std::min(1.0, by_end)) / by_start);
    return;
  }
  const double inverse = 1 / end;
  result.bands.push_back({-start * inverse, std::abs(inverse)});
}

void add_acceleration_bands(const MotorEnds& ends, double h, double inv_accel, RateLimits& result) {
  const double k = inv_accel / (2 * h);
  if (ends.a0 == 0 && ends.a1 == 0) return add_band(-ends.v0 * k, ends.v0 * k, result);
  const double d0 = ends.v0 * k, d1 = (ends.v0 + h * ends.a0 / 2) * k, d2 = ends.v1 * k;   // Bernstein coefficients of q'
  const double e0 = ends.a0 * inv_accel, e1 = ends.a1 * inv_accel;                          // and of q''
  add_band(e0 - d0, d0, result);
  add_band(e1 / 2 - d1, e0 / 2 + d1, result);
  add_band(-d2, e1 + d2, result);
}

void limit_speed(double speed, double allowed, RateLimits& result) {
  if (allowed > 0 && speed > allowed) result.max_rate2 = std::min(result.max_rate2, (allowed / speed) * (allowed / speed));
}

/// Motors run straight at constant speed but for rounding: their own acceleration is nothing of their limit, and their speed is the same everywhere.
bool is_even(const Segment& segment, const std::vector<MotorLimits>& limits) {
  constexpr double kNoShare = 1e-7, kSameSpeed = 1e-6;
  double most = 0, fastest = 0;
  for (std::size_t m = 0; m < segment.motor.size(); ++m) {
    const MotorCubic& q = segment.motor[m];
    const double accel = std::max(std::abs(q.acceleration(0)), std::abs(q.acceleration(segment.duration_ms)));
    if (m < limits.size() && accel * limits[m].inv_amax_ms2_mu > kNoShare) return false;
    most = std::max(most, accel);
    fastest = std::max(fastest, std::abs(q.c1));
  }
  return most * segment.duration_ms <= kSameSpeed * fastest;
}

void find_even_limits(const Segment& segment, const Stretch& stretch, const std::vector<MotorLimits>& limits, double accel_share, RateLimits& result) {
  double most = 0;   // acceleration of a change of x by 1, in limits
  for (std::size_t m = 0; m < std::min(segment.motor.size(), limits.size()); ++m) {
    const double speed = std::abs(segment.motor[m].c1);
    most = std::max(most, speed * limits[m].inv_amax_ms2_mu);
    limit_speed(speed, limits[m].max_speed_mu_ms, result);
  }
  if (most > 0) result.bands.push_back({1, 2 * stretch.duration_ms * accel_share / most});
}

}  // namespace

void RateBands::push_to_many(const RateBand& band) {
  if (count_ == few_.size()) {
    many_.clear();
    for (const RateBand& kept : few_) many_.push_back(kept);
  }
  many_.push_back(band);
}

/// What all bands leave of x1 at x0 lies between a convex polygon line from below and a concave one from above. From the right, Newton's method
/// comes to the place where they meet in a few steps: the next x0 is where the two lines meet that bind at this one.
double RateLimits::largest_start(double x0_max, double x1_max) const {
  double x0 = std::min(x0_max, max_start_rate2);
  if (is_even) return bands.empty() ? x0 : std::min(x0, x1_max + bands[0].width);
  const RateBand *const first = bands.begin(), *const last = bands.end();
  for (std::size_t step = 0; step < 2 * bands.size() + 2; ++step) {
    double low = 0, low_slope = 0, low_offset = 0, high = x1_max, high_slope = 0, high_offset = x1_max;
    for (const RateBand* band = first; band != last; ++band) {
      const double middle = band->slope * x0;
      if (middle + band->width < high) high = middle + band->width, high_slope = band->slope, high_offset = band->width;
      if (middle - band->width > low) low = middle - band->width, low_slope = band->slope, low_offset = -band->width;
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

void find_rate_limits(const Segment& segment, const Stretch& stretch, const std::vector<MotorLimits>& limits, double accel_share, RateLimits& result) {
  result.bands.clear();
  result.max_rate2 = result.max_start_rate2 = 1;
  result.is_even = is_even(segment, limits);
  if (result.is_even) return find_even_limits(segment, stretch, limits, accel_share, result);
  const double inv_share = 1 / accel_share;
  for (std::size_t m = 0; m < std::min(segment.motor.size(), limits.size()); ++m) {
    const MotorEnds ends = ends_of(segment.motor[m], stretch);
    if (limits[m].inv_amax_ms2_mu > 0) add_acceleration_bands(ends, stretch.duration_ms, limits[m].inv_amax_ms2_mu * inv_share, result);
    if (limits[m].max_speed_mu_ms > 0) limit_speed(largest_speed(ends, stretch.duration_ms), limits[m].max_speed_mu_ms, result);
  }
}

}  // namespace pmac::motion
