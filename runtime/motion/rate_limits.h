// What the motor limits say about the rate of programmed time over one segment. With x = (ds/dt)^2, which changes linearly over
// the segment from x0 to x1, motor acceleration is
//
//   q'' x + q' (x1 - x0) / (2 h)          ' = d/ds, h = programmed duration
//
// a quadratic polynomial of s whose three Bernstein coefficients are linear in (x0, x1). A polynomial stays between its
// Bernstein coefficients, so limits on these hold everywhere in the segment and not only at sampled places.
#pragma once

#include <vector>

#include "runtime/motion/segment.h"

namespace pmac::motion {

/// |start * x0 + end * x1| <= 1.
struct RateRow { double start, end; };

struct RateLimits {
  std::vector<RateRow> rows;
  double max_rate2 = 1;           // of x0 and x1: never ahead of the program, and the speed limits

  /// Largest x0 for which an x1 in [0, x1_max] exists; x0 <= x0_max.
  double largest_start(double x0_max, double x1_max) const;
  /// Largest x1 <= x1_max that goes with x0.
  double largest_end(double x0, double x1_max) const;
  /// Both ends are within all limits.
  bool allows(double x0, double x1) const;
};

/// scale: x is counted in units of 1/scale^2, so that it is the same on both sides of a step in speed.
RateLimits rate_limits(const Segment& segment, const std::vector<MotorLimits>& limits, double scale);

/// Ratio of the speeds of two segments where they meet (after to before): 1 where they agree, 0 where the direction changes or
/// one of them rests, so that motion cannot go through without stopping.
double speed_ratio(const Segment& before, const Segment& after);
/// The motors do not stand still at the start (at_end false) or end of the segment at full rate.
bool is_moving(const Segment& segment, bool at_end);

}  // namespace pmac::motion
