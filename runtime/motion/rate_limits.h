// What the motor limits say about the rate of programmed time over one part of a segment. x = (ds/dt)^2 is a quadratic polynomial over the
// part: the acceleration of programmed time, x'/2, changes linearly from a0 to a1. Motor acceleration is
//
//   q'' x + q' x' / 2          ' = d/ds
//
// a cubic polynomial of s whose four Bernstein coefficients are linear in x0, x1 and the bend h (a1 - a0), h = programmed duration. A polynomial stays between its
// Bernstein coefficients, so limits on these hold everywhere in the part and not only at sampled places:
//
//   |by_start * x0 + by_end * x1 + by_bend * bend| <= 1
//
// All that is allowed is convex and contains x = 0: what is allowed stays so when x0, x1 and the bend shrink together.
// Where every motor runs straight at a constant programmed speed x changes by no more than `even_change`, over a part of any length.
#pragma once

#include <array>
#include <limits>
#include <vector>

#include "runtime/motion/segment.h"

namespace pmac::motion {

/// How a part is run through.
struct RateCourse {
  double x0 = 0, x1 = 0;          // at its start and end
  double bend = 0;                // acceleration of programmed time at the end less at the start, times the duration of the part
  std::array<int, 2> deciding{};  // the limits that it is held by, where these are two; 0: others are
};

/// One motor over a part, in acceleration limits: velocity at the start over the duration of the part, acceleration at both ends.
struct MotorShare { double velocity, start_accel, end_accel; };

/// As far as it goes a vector; a few are kept in place.
class MotorShares {
 public:
  const MotorShare* begin() const { return count_ <= few_.size() ? few_.data() : many_.begin(); }
  const MotorShare* end() const { return begin() + count_; }
  std::size_t size() const { return count_; }
  void clear() { count_ = 0; }
  void push_back(const MotorShare& share) {
    if (count_ < few_.size()) few_[count_] = share;
    else push_to_many(share);
    ++count_;
  }

 private:
  void push_to_many(const MotorShare& share);

  std::array<MotorShare, 3> few_;   // as far as count_ goes
  Row<MotorShare> many_;            // all, where they are more
  std::uint32_t count_ = 0;
};

struct RateLimits {
  MotorShares motors;               // those that move
  double duration_ms = 0;           // programmed
  double max_start_rate2 = 1;       // of x0: never ahead of the program, and the speed limits, which hold as long as x is below the line
  double max_end_rate2 = 1;         // from this to that of x1
  double even_change = std::numeric_limits<double>::infinity();
  bool is_even = false;             // the motors run straight at constant speed
  bool allows_full_rate = false;    // from end to end

  /// The largest x0 <= x0_max from which some x1 in [0, x1_max] can be reached, and how. like: of a part nearby, where it is sooner found.
  RateCourse largest_start(double x0_max, double x1_max, const RateCourse& like = {}) const;
  /// The largest x1 <= x1_max that can be reached from x0, and how.
  RateCourse largest_end(double x0, double x1_max, const RateCourse& like = {}) const;
  /// Highest x at both ends.
  double max_rate2() const { return max_start_rate2 < max_end_rate2 ? max_start_rate2 : max_end_rate2; }
};

/// Part of a segment, in programmed time from its start.
struct Stretch { double from_ms, duration_ms; };

/// One motor at a place of the path: velocity and acceleration per programmed time.
struct MotorRates { double velocity, acceleration; };

/// At d ms from the start of the segment. rates: [motor].
void find_motor_rates(const Segment& segment, double d, std::vector<MotorRates>& rates);

/// Motors run straight at constant speed but for rounding: their own acceleration is nothing of their limit, and their speed is the same everywhere.
bool is_even(const Segment& segment, const std::vector<MotorLimits>& limits);

/// The limits of a part that is duration_ms long and not even, from the rates at both of its ends. Replaces what stands in `result`.
void find_rate_limits(const std::vector<MotorRates>& from, const std::vector<MotorRates>& to, double duration_ms, const std::vector<MotorLimits>& limits,
                      double accel_share, RateLimits& result);

/// accel_share: part of the acceleration limits that may be used, 0..1. Replaces what stands in `result`.
void find_rate_limits(const Segment& segment, const Stretch& stretch, const std::vector<MotorLimits>& limits, double accel_share, RateLimits& result);

}  // namespace pmac::motion
