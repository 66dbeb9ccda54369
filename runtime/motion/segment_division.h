// Where the lookahead divides a segment that the limits hold back: its plan holds the limits by bounds on each part (rate_limits.h), which are
// the further above the true accelerations the more velocities change over one.
#pragma once

#include <vector>

#include "runtime/motion/rate_limits.h"

namespace pmac::motion {

/// Divides a segment from its start to its end: `while (division.next(part)) ...`.
class Division {
 public:
  explicit Division(std::vector<MotorLimits> limits) : limits_(std::move(limits)) {}

  /// found: the limits of the whole segment. It has to stay where it is until the last part is taken.
  void start(const Segment& segment, const RateLimits& found, double accel_share);
  bool next(Stretch& part);
  /// Those of the part that next() gave.
  void find_limits(RateLimits& result) const { find_rate_limits(from_, to_, part_ms_, limits_, accel_share_, result); }

 private:
  struct Along { double speed, accel, finer; };
  Along along(const std::vector<MotorRates>& rates) const;
  double wanted_ms() const;
  double change() const;

  std::vector<MotorLimits> limits_;
  double accel_share_ = 1;
  const Segment* segment_ = nullptr;
  double at_ms_ = 0, end_ms_ = 0, least_ms_ = 0, longest_ms_ = 0, part_ms_ = 0;
  std::vector<MotorRates> from_, to_;   // at both ends of the part
};

}  // namespace pmac::motion
