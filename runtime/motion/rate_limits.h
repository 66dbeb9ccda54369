// What the motor limits say about the rate of programmed time over one segment. With x = (ds/dt)^2, which changes linearly over
// the segment from x0 to x1, motor acceleration is
//
//   q'' x + q' (x1 - x0) / (2 h)          ' = d/ds, h = programmed duration
//
// a quadratic polynomial of s whose three Bernstein coefficients are linear in (x0, x1). A polynomial stays between its
// Bernstein coefficients, so limits on these hold everywhere in the segment and not only at sampled places. Each is a band:
//
//   x1 |      /     /          slope * x0 - width <= x1 <= slope * x0 + width
//      |     /     /
//      |____/_____/__ x0
#pragma once

#include <vector>

#include "runtime/motion/segment.h"

namespace pmac::motion {

struct RateBand { double slope, width; };

struct RateLimits {
  Row<RateBand> bands;            // those that can matter: x is never above 1
  double max_rate2 = 1;           // of x0 and x1: never ahead of the program, and the speed limits
  double max_start_rate2 = 1;     // of x0 alone: bands that stand upright

  /// Largest x0 for which an x1 in [0, x1_max] exists; x0 <= x0_max.
  double largest_start(double x0_max, double x1_max) const;
  /// Largest x1 <= x1_max that goes with x0.
  double largest_end(double x0, double x1_max) const;
  /// Both ends are within all limits.
  bool allows(double x0, double x1) const;
};

/// accel_share: part of the acceleration limits that may be used, 0..1.
RateLimits rate_limits(const Segment& segment, const std::vector<MotorLimits>& limits, double accel_share);

}  // namespace pmac::motion
