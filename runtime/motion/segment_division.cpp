#include "runtime/motion/segment_division.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pmac::motion {
namespace {

/// Velocities may change by so much over a part, in speeds of the fastest motor.
constexpr double kChange = 0.05;
/// The same where a part takes no longer than the shortest that is asked for.
constexpr double kChangeOfShort = 0.06;
/// A part is not shorter than one of so many equal ones.
constexpr double kMostParts = 64;

}  // namespace

bool may_be_limited(const Segment& segment, const std::vector<MotorLimits>& limits, double accel_share) {
  constexpr double kFar = 0.1;
  const double h = segment.duration_ms;
  for (std::size_t m = 0; m < std::min(segment.motor.size(), limits.size()); ++m) {
    const MotorCubic& q = segment.motor[m];
    const double accel = std::max(std::abs(q.acceleration(0)), std::abs(q.acceleration(h))), speed = limits[m].max_speed_mu_ms;
    if (accel * limits[m].inv_amax_ms2_mu > kFar * accel_share) return true;
    if (speed > 0 && (std::abs(q.c1) > speed || std::abs(q.velocity(h / 2)) > speed || std::abs(q.velocity(h)) > speed)) return true;
  }
  return false;
}

void Division::start(const Segment& segment, const Stretch& stretch, const RateLimits& found, double accel_share) {
  segment_ = &segment;
  accel_share_ = accel_share;
  at_ms_ = stretch.from_ms;
  end_ms_ = stretch.from_ms + stretch.duration_ms;
  least_ms_ = stretch.duration_ms / kMostParts;
  longest_ms_ = std::max(least_ms_, stretch.duration_ms * std::sqrt(found.max_rate2()));   // each takes no longer than the stretch at full rate
  equal_ms_ = 0;
  find_motor_rates(segment, at_ms_, to_);
}

void Division::start_equal(const Segment& segment, const Stretch& stretch, int parts, double accel_share) {
  segment_ = &segment;
  accel_share_ = accel_share;
  at_ms_ = stretch.from_ms;
  end_ms_ = stretch.from_ms + stretch.duration_ms;
  equal_ms_ = least_ms_ = stretch.duration_ms / parts;
  find_motor_rates(segment, at_ms_, to_);
}

/// Acceleration of a motor is q'' x + q' x' / 2. With x' the same over the stretch it changes by q''' x h + 3/2 q'' x' h.
int Division::parts_for(const Segment& segment, const Stretch& stretch, double x0, double x1, double accel_share) const {
  constexpr double kLoss = 0.06, kMost = 16, kShortestOfShort = 0.05;
  const double highest = std::max(x0, x1), change = 1.5 * std::abs(x1 - x0), to_ms = stretch.from_ms + stretch.duration_ms;
  double loss = 0;   // in limits
  for (std::size_t m = 0; m < std::min(segment.motor.size(), limits_.size()); ++m) {
    const double a0 = segment.motor[m].acceleration(stretch.from_ms), a1 = segment.motor[m].acceleration(to_ms);
    loss = std::max(loss, limits_[m].inv_amax_ms2_mu * (std::abs(a1 - a0) * highest + std::max(std::abs(a0), std::abs(a1)) * change));
  }
  const double wanted = loss / (kLoss * accel_share);
  if (wanted <= 1) return 1;
  const double takes_ms = 2 * stretch.duration_ms / (std::sqrt(x0) + std::sqrt(x1));
  return static_cast<int>(std::ceil(std::min({wanted, kMost, std::max(1.0, takes_ms / (kShortestOfShort * shortest_ms_))})));
}

bool Division::next(Stretch& part) {
  constexpr double kRounding = 1e-6, kTooMuch = 1.5;
  const double left_ms = end_ms_ - at_ms_;
  if (left_ms <= 0) return false;
  std::swap(from_, to_);
  double parts = std::ceil(left_ms / (equal_ms_ > 0 ? equal_ms_ : wanted_ms()) - kRounding);
  for (;; parts *= 2) {
    part_ms_ = left_ms / parts;
    find_motor_rates(*segment_, parts == 1 ? end_ms_ : at_ms_ + part_ms_, to_);
    if (part_ms_ <= 2 * least_ms_ || change() <= kTooMuch * kChangeOfShort) break;   // mostly: accelerations may grow
  }
  part = {at_ms_, part_ms_};
  at_ms_ = parts == 1 ? end_ms_ : at_ms_ + part_ms_;
  return true;
}

/// How long the part that begins here may be, as far as the rates here tell.
double Division::wanted_ms() const {
  double speed = 0, accel = 0, most = accel_share_;   // most: acceleration in limits
  for (std::size_t m = 0; m < from_.size(); ++m) {
    const double own = std::abs(from_[m].acceleration);
    speed = std::max(speed, std::abs(from_[m].velocity));
    accel = std::max(accel, own);
    if (m < limits_.size()) most = std::max(most, own * limits_[m].inv_amax_ms2_mu);
  }
  if (accel == 0) return longest_ms_;
  const double to_change = speed / accel, short_ms = shortest_ms_ * std::sqrt(accel_share_ / most);   // at the highest rate that this acceleration alone leaves
  return std::clamp(std::max(kChange * to_change, std::min(short_ms, kChangeOfShort * to_change)), least_ms_, longest_ms_);
}

/// How much velocities change over the part, in speeds of the fastest motor.
double Division::change() const {
  double change = 0, speed = 0;
  for (std::size_t m = 0; m < from_.size(); ++m) {
    change = std::max(change, std::abs(to_[m].velocity - from_[m].velocity));
    speed = std::max(speed, std::max(std::abs(to_[m].velocity), std::abs(from_[m].velocity)));
  }
  return speed > 0 ? change / speed : 0;
}

}  // namespace pmac::motion
