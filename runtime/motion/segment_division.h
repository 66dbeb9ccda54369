// Where the lookahead divides a segment that the limits hold back: x is linear over each part, so that the more velocities change over one,
// the less of the limits can be used in all of it.
#pragma once

#include <vector>

#include "runtime/motion/rate_limits.h"

namespace pmac::motion {

/// The limits may act in the segment: its own acceleration at full rate is not far from them, or a speed beyond. Elsewhere x is 1, or changes
/// as on a straight line.
bool may_be_limited(const Segment& segment, const std::vector<MotorLimits>& limits, double accel_share);

/// What a stretch is divided by.
struct DivisionRule {
  const std::vector<MotorLimits>& limits;
  double accel_share;
  double shortest_ms;   // parts need not take less time than that
};

/// Replaces ends_ms by the ends of the parts, from the start of the segment; the last is that of the stretch. found: the limits of the stretch.
void find_parts(const Segment& segment, const Stretch& stretch, const RateLimits& found, const DivisionRule& rule, std::vector<double>& ends_ms);

}  // namespace pmac::motion
