// Where the lookahead divides a segment that the limits hold back: x is linear over each part, so that the more velocities change over one,
// the less of the limits can be used in all of it.
#pragma once

#include <vector>

#include "runtime/motion/rate_limits.h"

namespace pmac::motion {

/// The limits may act in the segment: its own acceleration at full rate is not far from them, or a speed beyond. Elsewhere x is 1, or changes
/// as on a straight line.
bool may_be_limited(const Segment& segment, const std::vector<MotorLimits>& limits, double accel_share);

/// Divides a stretch from its start to its end: `while (division.next(part)) ...`.
class Division {
 public:
  /// shortest_ms: parts need not take less time than that where velocities do not change much.
  Division(std::vector<MotorLimits> limits, double shortest_ms) : limits_(std::move(limits)), shortest_ms_(shortest_ms) {}

  /// found: the limits of the stretch. The segment has to stay where it is until the last part is taken.
  void start(const Segment& segment, const Stretch& stretch, const RateLimits& found, double accel_share);
  /// In so many equal parts.
  void start_equal(const Segment& segment, const Stretch& stretch, int parts, double accel_share);
  bool next(Stretch& part);
  /// Into how many parts a stretch is to be divided that runs with x from x0 to x1, so that little of the acceleration limits is lost because x is
  /// linear over it. 1: it is well as it is.
  int parts_for(const Segment& segment, const Stretch& stretch, double x0, double x1, double accel_share) const;
  /// Those of the part that next() gave.
  void find_limits(RateLimits& result) const { find_rate_limits(from_, to_, part_ms_, limits_, accel_share_, result); }

 private:
  double wanted_ms() const;
  double change() const;

  std::vector<MotorLimits> limits_;
  double shortest_ms_, accel_share_ = 1;
  const Segment* segment_ = nullptr;
  double at_ms_ = 0, end_ms_ = 0, equal_ms_ = 0, least_ms_ = 0, longest_ms_ = 0, part_ms_ = 0;
  std::vector<MotorRates> from_, to_;   // at both ends of the part
};

}  // namespace pmac::motion
