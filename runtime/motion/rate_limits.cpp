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

void add_acceleration_bands(const MotorRates& from, const MotorRates& to, double h, double inv_accel, RateLimits& result) {
  const double k = inv_accel / (2 * h), d0 = from.velocity * k;
  if (from.acceleration == 0 && to.acceleration == 0) return add_band(-d0, d0, result);
  const double d1 = (from.velocity + h * from.acceleration / 2) * k, d2 = to.velocity * k;      // Bernstein coefficients of q'
  const double e0 = from.acceleration * inv_accel, e1 = to.acceleration * inv_accel;            // and of q''
  add_band(e0 - d0, d0, result);
  add_band(e1 / 2 - d1, e0 / 2 + d1, result);
  add_band(-d2, e1 + d2, result);
}

double highest_rate2(double speed, double allowed) { return speed > allowed ? (allowed / speed) * (allowed / speed) : 1; }

/// v(s)^2 x(s) is above what it is at the ends, where x makes up for v, by no more than this part of it: 3/4 of the square of the change where v is
/// linear, and twice as much as v is above a line.
double rise_between(const MotorRates& from, const MotorRates& to, double h) {
  const double least = std::min(std::abs(from.velocity), std::abs(to.velocity)), change = std::abs(to.velocity - from.velocity) / least;
  return change * change + std::abs(to.acceleration - from.acceleration) * h / (4 * least);
}

void limit_speed(const MotorRates& from, const MotorRates& to, double h, double allowed, RateLimits& result) {
  constexpr double kLittle = 0.2;
  const double v0 = std::abs(from.velocity), v1 = std::abs(to.velocity), a0 = from.acceleration, a1 = to.acceleration;
  const double turn = a0 * a1 < 0 ? std::abs(from.velocity + a0 * a0 * h / (2 * (a0 - a1))) : 0;   // the extreme between them
  const double fastest = std::max({v0, v1, turn});
  if (fastest <= allowed) return;
  const bool is_gentle = from.velocity * to.velocity > 0 && turn <= std::max(v0, v1) && std::abs(v1 - v0) <= kLittle * std::min(v0, v1);
  const double margin = is_gentle ? std::max(0.5, 1 - rise_between(from, to, h)) : 1;
  result.max_start_rate2 = std::min(result.max_start_rate2, margin * highest_rate2(is_gentle ? v0 : fastest, allowed));
  result.max_end_rate2 = std::min(result.max_end_rate2, margin * highest_rate2(is_gentle ? v1 : fastest, allowed));
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
    const double allowed = limits[m].max_speed_mu_ms;
    if (allowed > 0) result.max_start_rate2 = result.max_end_rate2 = std::min(result.max_end_rate2, highest_rate2(speed, allowed));
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
  for (const RateBand* band = first; band != last; ++band)   // no lower line above x1_max: all there is to it, mostly
    if (band->slope * x0 - band->width > x1_max && band->slope > 0) x0 = (x1_max + band->width) / band->slope;
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
  if (x0 > max_start_rate2 * kFull || x1 > max_end_rate2) return false;
  return std::all_of(bands.begin(), bands.end(), [&](const RateBand& band) { return std::abs(x1 - band.slope * x0) <= kFull * band.width; });
}

void find_motor_rates(const Segment& segment, double d, std::vector<MotorRates>& rates) {
  rates.resize(segment.motor.size());
  for (std::size_t m = 0; m < rates.size(); ++m) rates[m] = {segment.motor[m].velocity(d), segment.motor[m].acceleration(d)};
}

void find_rate_limits(const std::vector<MotorRates>& from, const std::vector<MotorRates>& to, double duration_ms, const std::vector<MotorLimits>& limits,
                      double accel_share, RateLimits& result) {
  result.bands.clear();
  result.max_start_rate2 = result.max_end_rate2 = 1;
  result.is_even = false;
  const double inv_share = 1 / accel_share;
  for (std::size_t m = 0; m < std::min(from.size(), limits.size()); ++m) {
    if (limits[m].inv_amax_ms2_mu > 0) add_acceleration_bands(from[m], to[m], duration_ms, limits[m].inv_amax_ms2_mu * inv_share, result);
    if (limits[m].max_speed_mu_ms > 0) limit_speed(from[m], to[m], duration_ms, limits[m].max_speed_mu_ms, result);
  }
}

void find_rate_limits(const Segment& segment, const Stretch& stretch, const std::vector<MotorLimits>& limits, double accel_share, RateLimits& result) {
  if (is_even(segment, limits)) {
    result.bands.clear();
    result.max_start_rate2 = result.max_end_rate2 = 1;
    result.is_even = true;
    return find_even_limits(segment, stretch, limits, accel_share, result);
  }
  thread_local std::vector<MotorRates> from, to;
  find_motor_rates(segment, stretch.from_ms, from);
  find_motor_rates(segment, stretch.from_ms + stretch.duration_ms, to);
  find_rate_limits(from, to, stretch.duration_ms, limits, accel_share, result);
}

}  // namespace pmac::motion
