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

/// A segment and when it is executed. Programmed time runs at a rate 0..1 that changes evenly:
/// d(t) = rate * t + rate_slope * t^2 / 2 with t = time - start_ms.
struct TimedSegment {
  Segment segment;
  double start_ms = 0;              // pipeline time
  double duration_ms = 0;
  double rate = 1;                  // at the start
  double rate_slope = 0;            // 1/ms
  double jerk_step = 0;             // --limit-jerk: the jerk that a step of acceleration at the start makes at servo rate, in limits; 0: none
  double programmed_ms(double t) const { return t * (rate + t * rate_slope / 2); }
};

/// Time since the start of the segment at which d of its programmed time has passed.
inline double time_at(const TimedSegment& segment, double d) {
  const double end_rate2 = segment.rate * segment.rate + 2 * segment.rate_slope * d;
  const double rates = segment.rate + std::sqrt(std::max(0.0, end_rate2));
  return rates > 0 ? 2 * d / rates : 0;
}

}  // namespace pmac::motion
