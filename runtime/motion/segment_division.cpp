#include "runtime/motion/segment_division.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pmac::motion {
namespace {

/// Velocities may change by so much over a part, in speeds of the motor that is the fastest for its acceleration limit.
constexpr double kChange = 0.2;
/// Where the program changes the speed along its path beyond this many limits, x makes up for that: it has to be the nearer to what the path
/// asks for, by up to this factor.
constexpr double kManyLimits = 5, kFiner = 4;
/// A part is not shorter than one of so many equal ones.
constexpr double kMostParts = 64;

}  // namespace

void Division::start(const Segment& segment, const RateLimits& found, double accel_share) {
  segment_ = &segment;
  accel_share_ = accel_share;
  at_ms_ = 0;
  end_ms_ = segment.duration_ms;
  least_ms_ = end_ms_ / kMostParts;
  longest_ms_ = std::max(least_ms_, end_ms_ * std::sqrt(found.max_rate2()));   // each takes no longer than the segment at full rate
  find_motor_rates(segment, 0, to_);
}

bool Division::next(Stretch& part) {
  constexpr double kRounding = 1e-6, kTooMuch = 1.5;
  const double left_ms = end_ms_ - at_ms_;
  if (left_ms <= 0) return false;
  std::swap(from_, to_);
  double parts = std::ceil(left_ms / wanted_ms() - kRounding);
  for (;; parts *= 2) {
    part_ms_ = left_ms / parts;
    find_motor_rates(*segment_, parts == 1 ? end_ms_ : at_ms_ + part_ms_, to_);
    if (part_ms_ <= 2 * least_ms_ || change() <= kTooMuch * kChange) break;   // mostly: accelerations may grow
  }
  part = {at_ms_, part_ms_};
  at_ms_ = parts == 1 ? end_ms_ : at_ms_ + part_ms_;
  return true;
}

/// Speed along the path, and its change, in limits of the motors.
Division::Along Division::along(const std::vector<MotorRates>& rates) const {
  double square = 0, rise = 0, most = 0;
  for (std::size_t m = 0; m < std::min(rates.size(), limits_.size()); ++m) {
    const double inverse = limits_[m].inv_amax_ms2_mu, speed = inverse * rates[m].velocity, accel = inverse * rates[m].acceleration;
    square += speed * speed;
    rise += speed * accel;
    most = std::max(most, std::abs(accel));
  }
  const double speed = std::sqrt(square), finer = std::clamp(std::sqrt(most / kManyLimits), 1.0, kFiner);
  return {speed, speed > 0 ? std::abs(rise) / speed : 0, finer};
}

/// How long the part that begins here may be, as far as the rates here tell.
double Division::wanted_ms() const {
  const Along here = along(from_);
  double speed = 0, accel = 0, to_change_ms = here.accel > 0 ? here.speed / (here.accel * here.finer) : std::numeric_limits<double>::infinity();
  for (std::size_t m = 0; m < std::min(from_.size(), limits_.size()); ++m) {
    const double inverse = limits_[m].inv_amax_ms2_mu;
    speed = std::max(speed, inverse * std::abs(from_[m].velocity));
    accel = std::max(accel, inverse * std::abs(from_[m].acceleration));
  }
  if (accel > 0) to_change_ms = std::min(to_change_ms, speed / accel);
  return std::clamp(kChange * to_change_ms, least_ms_, longest_ms_);
}

/// How much velocities change over the part, in speeds of the motor that is the fastest for its acceleration limit.
double Division::change() const {
  double change = 0, speed = 0;
  for (std::size_t m = 0; m < std::min(from_.size(), limits_.size()); ++m) {
    const double inverse = limits_[m].inv_amax_ms2_mu;
    change = std::max(change, inverse * std::abs(to_[m].velocity - from_[m].velocity));
    speed = std::max(speed, inverse * std::max(std::abs(to_[m].velocity), std::abs(from_[m].velocity)));
  }
  const Along start = along(from_), end = along(to_);
  const double along = std::max(start.finer, end.finer) * std::abs(end.speed - start.speed), fastest = std::max(start.speed, end.speed);
  return speed > 0 ? std::max(change / speed, along / fastest) : 0;
}

}  // namespace pmac::motion
