// Hops 7 and 8: the path in motor space as cubics of programmed time, and the same with the times at which it is executed.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "runtime/motion/row.h"
#include "runtime/motion/types.h"

namespace pmac::motion {

/// One motor over one segment: c0 + c1 d + c2 d^2 + c3 d^3, d = programmed time since the start of the segment in ms; mu.
struct MotorCubic {
  double c0 = 0, c1 = 0, c2 = 0, c3 = 0;
  double position(double d) const { return c0 + d * (c1 + d * (c2 + d * c3)); }
  double velocity(double d) const { return c1 + d * (2 * c2 + d * 3 * c3); }
  double acceleration(double d) const { return 2 * c2 + d * 6 * c3; }
};

/// The cubic with these positions and velocities at 0 and duration_ms.
inline MotorCubic hermite_cubic(double p0, double v0, double p1, double v1, double duration_ms) {
  const double mean = (p1 - p0) / duration_ms;
  return {p0, v0, (3 * mean - 2 * v0 - v1) / duration_ms, (v0 + v1 - 2 * mean) / (duration_ms * duration_ms)};
}

struct Segment {
  std::uint64_t command = 0;
  SourceLine source;
  double start_ms = 0;              // programmed time since the start of the sequence
  double duration_ms = 0;
  double passed_ms = 0;             // > 0: a straight line through several nodes; programmed time of the first one inside
  Row<MotorCubic> motor;            // [motor], order of the map
};

/// Part of a segment from `from` on, `duration` long; replaces what stands in `part`.
inline void take_part(const Segment& segment, double from_ms, double duration_ms, Segment& part) {
  part.command = segment.command;
  part.source = segment.source;
  part.start_ms = segment.start_ms + from_ms;
  part.duration_ms = duration_ms;
  part.passed_ms = 0;
  part.motor = segment.motor;
  if (from_ms == 0) return;
  for (MotorCubic& q : part.motor)
    q = {q.position(from_ms), q.velocity(from_ms), q.c2 + 3 * q.c3 * from_ms, q.c3};
}

inline Segment part_of(const Segment& segment, double from_ms, double duration_ms) {
  Segment part;
  take_part(segment, from_ms, duration_ms, part);
  return part;
}

/// A segment and when it is executed. Programmed time d runs at a rate 0..1, the square of which is a quadratic polynomial of d; the rate's
/// own slope is so a linear function of d, and with t = time - start_ms
///
///   d(t) = rate * S(t) + rate_slope * C(t)        S = sinh(wt)/w, C = (cosh(wt) - 1)/w^2, w^2 = slope_growth
///
/// (sin and cos below 0). Without growth the rate changes evenly: S = t, C = t^2/2.
struct TimedSegment {
  Segment segment;
  double start_ms = 0;              // pipeline time
  double duration_ms = 0;
  double rate = 1;                  // at the start
  double rate_slope = 0;            // at the start; 1/ms
  double slope_growth = 0;          // of the slope over programmed time; 1/ms^2
  double jerk_step = 0;             // --limit-jerk: the jerk that a step of acceleration at the start makes at servo rate, in limits; 0: none
  double programmed_ms(double t) const;
  double rate_at(double t) const;
  /// Square of the rate, and its slope, where d of the programmed time has passed.
  double rate2_after(double d) const { return std::max(0.0, rate * rate + d * (2 * rate_slope + slope_growth * d)); }
  double slope_after(double d) const { return rate_slope + slope_growth * d; }
};

/// S and C above.
struct GrowthSums { double s, c; };

/// The same for a large w t.
GrowthSums far_growth_sums(double growth, double t);

inline GrowthSums growth_sums(double growth, double t) {
  constexpr double kNear = 0.25;    // series up to here: the next term is below 1e-14 of the sum
  const double z = growth * t * t;
  if (std::abs(z) > kNear) return far_growth_sums(growth, t);
  return {t * (1 + z / 6 * (1 + z / 20 * (1 + z / 42 * (1 + z / 72 * (1 + z / 110))))), t * t / 2 * (1 + z / 12 * (1 + z / 30 * (1 + z / 56 * (1 + z / 90 * (1 + z / 132)))))};
}

inline double TimedSegment::programmed_ms(double t) const {
  if (slope_growth == 0) return t * (rate + t * rate_slope / 2);
  const GrowthSums sums = growth_sums(slope_growth, t);
  return rate * sums.s + rate_slope * sums.c;
}

inline double TimedSegment::rate_at(double t) const {
  if (slope_growth == 0) return rate + t * rate_slope;
  const GrowthSums sums = growth_sums(slope_growth, t);
  return rate * (1 + slope_growth * sums.c) + rate_slope * sums.s;
}

/// How long d of programmed time takes where the rate changes from rate0 to rate1 as above; they are not both 0. With y = d / (rate0 + rate1):
/// 2 atanh(w y) / w, which is 2 y where the rate changes evenly.
double time_between(double rate0, double rate1, double d, double growth);

/// Time since the start of the segment at which d of its programmed time has passed.
inline double time_at(const TimedSegment& segment, double d) {
  const double end_rate = std::sqrt(segment.rate2_after(d));
  return segment.rate + end_rate > 0 ? time_between(segment.rate, end_rate, d, segment.slope_growth) : 0;
}

}  // namespace pmac::motion
