// What the motor limits say about the rate of programmed time over one stretch of a segment. With x = (ds/dt)^2, which changes linearly
// over the stretch from x0 to x1, motor acceleration is
//
//   q'' x + q' (x1 - x0) / (2 h)          ' = d/ds, h = programmed duration
//
// a quadratic polynomial of s whose three Bernstein coefficients are linear in (x0, x1). A polynomial stays between its
// Bernstein coefficients, so limits on these hold everywhere in the stretch and not only at sampled places. Each is a band:
//
//   x1 |      /     /          slope * x0 - width <= x1 <= slope * x0 + width
//      |     /     /
//      |____/_____/__ x0
//
// Where every motor runs straight at a constant programmed speed there is a single one, of slope 1, for a stretch of any length.
#pragma once

#include <array>
#include <vector>

#include "runtime/motion/segment.h"

namespace pmac::motion {

struct RateBand { double slope, width; };

/// As far as it goes a vector; a few are kept in place.
class RateBands {
 public:
  const RateBand* begin() const { return count_ <= few_.size() ? few_.data() : many_.begin(); }
  const RateBand* end() const { return begin() + count_; }
  std::size_t size() const { return count_; }
  bool empty() const { return count_ == 0; }
  const RateBand& operator[](std::size_t i) const { return begin()[i]; }
  void clear() { count_ = 0; }
  void push_back(const RateBand& band) {
    if (count_ < few_.size()) few_[count_] = band;
    else push_to_many(band);
    ++count_;
  }

 private:
  void push_to_many(const RateBand& band);

  std::array<RateBand, 9> few_;   // as far as count_ goes; three motors' worth
  Row<RateBand> many_;            // all, where they are more
  std::uint32_t count_ = 0;
};

struct RateLimits {
  RateBands bands;                // those that can matter: x is never above 1
  double max_rate2 = 1;           // of x0 and x1: never ahead of the program, and the speed limits
  double max_start_rate2 = 1;     // of x0 alone: bands that stand upright
  bool is_even = false;           // the motors run straight at constant speed: at most one band, of slope 1, whether it can matter or not

  /// Largest x0 for which an x1 in [0, x1_max] exists; x0 <= x0_max.
  double largest_start(double x0_max, double x1_max) const;
  /// Largest x1 <= x1_max that goes with x0.
  double largest_end(double x0, double x1_max) const;
  /// Both ends are within all limits.
  bool allows(double x0, double x1) const;
};

/// Part of a segment, in programmed time from its start.
struct Stretch { double from_ms, duration_ms; };

/// accel_share: part of the acceleration limits that may be used, 0..1. Replaces what stands in `result`.
void find_rate_limits(const Segment& segment, const Stretch& stretch, const std::vector<MotorLimits>& limits, double accel_share, RateLimits& result);

}  // namespace pmac::motion
