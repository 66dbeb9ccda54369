// Hop 6: the blended path over programmed time, in axis space. A piece is a stretch of time in which each axis is one closed
// form: a curve (line or arc) run through at a speed that is a polynomial of time, or two of them superposed at a real corner.
//
//          cruise            blend of i and i+1              cruise
//   ...---------------|===========================|-----------------...
//        one part                two parts (corner), or one part (tangent join)
#pragma once

#include <array>

#include "runtime/motion/curve.h"

namespace pmac::motion {

/// A curve with its parameter as a cubic of the time since the start of the piece: u(d) = u[0] + u[1] d + u[2] d^2 + u[3] d^3.
struct PathPart {
  CurveRef curve;
  std::array<double, 4> u{};
};

struct PathPiece {
  std::uint64_t command = 0;    // id of the command it belongs to; a blend belongs to the move that it leads into
  SourceLine source;
  double start_ms = 0;          // programmed time since the start of the sequence
  double duration_ms = 0;
  std::array<PathPart, 2> part;
  int part_count = 1;           // 2: position = curve 0 + curve 1 - start of curve 1
  bool step_at_start = false;   // velocity steps from the end of the piece before (or from rest)
  bool starts_at_rest = false;  // first piece of a sequence, or after a full stop
};

/// Position, velocity (uu/ms) and acceleration (uu/ms^2) of every axis.
struct PathPoint { AxisVector position{}, velocity{}, acceleration{}; };

/// At time_ms since the start of the piece, 0 .. duration_ms. Exact.
PathPoint evaluate(const PathPiece& piece, double time_ms);

/// Position and velocity alone, of the axes of the mask; what stands there of others stays.
struct PathMotion { AxisVector position, velocity; };
void evaluate(const PathPiece& piece, double time_ms, std::uint32_t axes, PathMotion& motion);

/// u and its derivative with respect to time.
double parameter(const PathPart& part, double time_ms);
double parameter_rate(const PathPart& part, double time_ms);

}  // namespace pmac::motion
