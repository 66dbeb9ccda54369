#include "runtime/motion/segment_division.h"

#include <algorithm>
#include <cmath>

namespace pmac::motion {
namespace {

/// Velocities may change by so much over a part, in speeds of the fastest motor.
constexpr double kChange = 0.03;
constexpr int kHalvings = 6;

/// Velocities change by no more than kChange over the part.
bool is_nearly_even(const Segment& segment, double from_ms, double to_ms) {
  double change = 0, speed = 0;
  const double middle_ms = (from_ms + to_ms) / 2;
  for (const MotorCubic& q : segment.motor) {
    const double begin = q.velocity(from_ms), middle = q.velocity(middle_ms), end = q.velocity(to_ms);
    const double high = std::max(std::max(begin, end), middle), low = std::min(std::min(begin, end), middle);
    change = std::max(change, high - low);
    speed = std::max(speed, std::max(high, -low));
  }
  return change <= kChange * speed;
}

/// Time that the part takes at the highest rate at which no motor's acceleration along the path alone is above its limit.
bool takes_less_than(double shortest_ms, const Segment& segment, double from_ms, double to_ms, const DivisionRule& rule) {
  const double middle_ms = (from_ms + to_ms) / 2, least_rate = (to_ms - from_ms) / shortest_ms;
  if (least_rate > 1) return false;
  double most = rule.accel_share;   // of a limit, at full rate
  for (std::size_t m = 0; m < std::min(segment.motor.size(), rule.limits.size()); ++m)
    most = std::max(most, std::abs(segment.motor[m].acceleration(middle_ms)) * rule.limits[m].inv_amax_ms2_mu);
  return most * least_rate * least_rate <= rule.accel_share;
}

/// Ends of the parts that a stretch of the segment is halved into until velocities change little over each, and none is longer than longest_ms.
class Halving {
 public:
  Halving(const Segment& segment, double longest_ms, const DivisionRule& rule, std::vector<double>& ends_ms)
      : segment_(segment), longest_ms_(longest_ms), rule_(rule), ends_ms_(ends_ms) {}

  void divide(double from_ms, double to_ms, int halvings) {
    if (halvings == 0 || is_done(from_ms, to_ms)) return ends_ms_.push_back(to_ms);
    const double middle_ms = (from_ms + to_ms) / 2;
    divide(from_ms, middle_ms, halvings - 1);
    divide(middle_ms, to_ms, halvings - 1);
  }

 private:
  bool is_done(double from_ms, double to_ms) const {
    if (to_ms - from_ms > longest_ms_) return false;
    return is_nearly_even(segment_, from_ms, to_ms) || takes_less_than(rule_.shortest_ms, segment_, from_ms, to_ms, rule_);
  }

  const Segment& segment_;
  double longest_ms_;
  const DivisionRule& rule_;
  std::vector<double>& ends_ms_;
};

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

void find_parts(const Segment& segment, const Stretch& stretch, const RateLimits& found, const DivisionRule& rule, std::vector<double>& ends_ms) {
  const double slowest_rate = std::sqrt(found.max_rate2);
  const double longest_ms = stretch.duration_ms * std::max(slowest_rate, 1e-6) * (1 + 1e-9);   // each takes no longer than the stretch at full rate
  ends_ms.clear();
  Halving(segment, longest_ms, rule, ends_ms).divide(stretch.from_ms, stretch.from_ms + stretch.duration_ms, kHalvings);
}

}  // namespace pmac::motion
