#include "runtime/motion/rate_limits.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pmac::motion {
namespace {

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

void reset(double duration_ms, RateLimits& result) {
  result.motors.clear();
  result.duration_ms = duration_ms;
  result.max_start_rate2 = result.max_end_rate2 = 1;
  result.even_change = std::numeric_limits<double>::infinity();
  result.is_even = result.allows_full_rate = false;
}

void find_even_limits(const Segment& segment, const Stretch& stretch, const std::vector<MotorLimits>& limits, double accel_share, RateLimits& result) {
  reset(stretch.duration_ms, result);
  result.is_even = true;
  double most = 0;   // acceleration of a change of x by 1, in limits
  for (std::size_t m = 0; m < std::min(segment.motor.size(), limits.size()); ++m) {
    const double speed = std::abs(segment.motor[m].c1);
    most = std::max(most, speed * limits[m].inv_amax_ms2_mu);
    const double allowed = limits[m].max_speed_mu_ms;
    if (allowed > 0) result.max_start_rate2 = result.max_end_rate2 = std::min(result.max_end_rate2, highest_rate2(speed, allowed));
  }
  if (most > 0) result.even_change = 2 * stretch.duration_ms * accel_share / most;
}

}  // namespace

void MotorShares::push_to_many(const MotorShare& share) {
  if (count_ == few_.size()) {
    many_.clear();
    for (const MotorShare& kept : few_) many_.push_back(kept);
  }
  many_.push_back(share);
}

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

void find_motor_rates(const Segment& segment, double d, std::vector<MotorRates>& rates) {
  rates.resize(segment.motor.size());
  for (std::size_t m = 0; m < rates.size(); ++m) rates[m] = {segment.motor[m].velocity(d), segment.motor[m].acceleration(d)};
}

void find_rate_limits(const std::vector<MotorRates>& from, const std::vector<MotorRates>& to, double duration_ms, const std::vector<MotorLimits>& limits,
                      double accel_share, RateLimits& result) {
  reset(duration_ms, result);
  const double inv_share = 1 / accel_share, inverse_ms = 1 / duration_ms;
  double most = 0;
  for (std::size_t m = 0; m < std::min(from.size(), limits.size()); ++m) {
    const double inverse = limits[m].inv_amax_ms2_mu * inv_share;
    const MotorShare share{from[m].velocity * inverse * inverse_ms, from[m].acceleration * inverse, to[m].acceleration * inverse};
    if (share.velocity != 0 || share.start_accel != 0 || share.end_accel != 0) result.motors.push_back(share);
    most = std::max(most, std::max(std::abs(share.start_accel), std::abs(share.end_accel)));
    if (limits[m].max_speed_mu_ms > 0) limit_speed(from[m], to[m], duration_ms, limits[m].max_speed_mu_ms, result);
  }
  result.allows_full_rate = result.max_rate2() == 1 && most <= 1;
}

void find_rate_limits(const Segment& segment, const Stretch& stretch, const std::vector<MotorLimits>& limits, double accel_share, RateLimits& result) {
  if (is_even(segment, limits)) return find_even_limits(segment, stretch, limits, accel_share, result);
  thread_local std::vector<MotorRates> from, to;
  find_motor_rates(segment, stretch.from_ms, from);
  find_motor_rates(segment, stretch.from_ms + stretch.duration_ms, to);
  find_rate_limits(from, to, stretch.duration_ms, limits, accel_share, result);
}

}  // namespace pmac::motion
