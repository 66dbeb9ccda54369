#include "runtime/motion/path.h"

#include "runtime/motion/axis_vector.h"

namespace pmac::motion {

double parameter(const PathPart& part, double d) { return part.u[0] + d * (part.u[1] + d * (part.u[2] + d * part.u[3])); }

double parameter_rate(const PathPart& part, double d) { return part.u[1] + d * (2 * part.u[2] + d * 3 * part.u[3]); }

namespace {

double parameter_acceleration(const PathPart& part, double d) { return 2 * part.u[2] + d * 6 * part.u[3]; }

/// Adds the chain rule's velocity and acceleration of one part.
void add_motion(const PathPart& part, double d, const CurvePoint& at, PathPoint& point) {
  const double rate = parameter_rate(part, d), change = parameter_acceleration(part, d);
  for_each_axis(part.curve->moved, [&](std::size_t axis) {
    point.velocity[axis] += at.d1[axis] * rate;
    point.acceleration[axis] += at.d1[axis] * change + at.d2[axis] * rate * rate;
  });
}

/// Adds the velocity of one part for the axes of the mask.
void add_velocity(const PathPart& part, double d, const CurvePoint& at, std::uint32_t axes, PathMotion& motion) {
  const double rate = parameter_rate(part, d);
  for_each_axis(part.curve->moved & axes, [&](std::size_t axis) { motion.velocity[axis] += at.d1[axis] * rate; });
}

}  // namespace

namespace {

bool is_line(const Curve& curve) { return !curve.is_arc && !curve.rates; }

/// take(axis, position, velocity) for the axes of the mask.
template <class Take>
void for_each_on_line(const PathPart& part, double d, std::uint32_t axes, const Take& take) {
  const Curve& curve = *part.curve;
  const double u = exact_end(parameter(part, d)), rate = parameter_rate(part, d), offset = u < 0.5 ? u : u - 1;  // exact at both ends
  const AxisVector& base = u < 0.5 ? curve.start : curve.end;
  for_each_axis(axes, [&](std::size_t axis) { take(axis, base[axis] + offset * curve.delta[axis], curve.delta[axis] * rate); });
}

/// Lines alone, and their corners.
void evaluate_lines(const PathPiece& piece, double time_ms, std::uint32_t axes, PathMotion& motion) {
  for_each_on_line(piece.part[0], time_ms, axes, [&](std::size_t axis, double position, double velocity) {
    motion.position[axis] = position;
    motion.velocity[axis] = velocity;
  });
  if (piece.part_count < 2) return;
  const Curve& next = *piece.part[1].curve;
  for_each_on_line(piece.part[1], time_ms, next.moved & axes, [&](std::size_t axis, double position, double velocity) {
    motion.position[axis] += position - next.start[axis];
    motion.velocity[axis] += velocity;
  });
}

}  // namespace

void evaluate(const PathPiece& piece, double time_ms, std::uint32_t axes, PathMotion& motion) {
  if (is_line(*piece.part[0].curve) && (piece.part_count < 2 || is_line(*piece.part[1].curve))) return evaluate_lines(piece, time_ms, axes, motion);
  CurvePoint at;  // read for moved axes only
  evaluate(*piece.part[0].curve, parameter(piece.part[0], time_ms), at);
  for_each_axis(axes, [&](std::size_t axis) {
    motion.position[axis] = at.position[axis];
    motion.velocity[axis] = 0;
  });
  add_velocity(piece.part[0], time_ms, at, axes, motion);
  if (piece.part_count < 2) return;
  const Curve& next = *piece.part[1].curve;
  evaluate(next, parameter(piece.part[1], time_ms), at);
  for_each_axis(next.moved & axes, [&](std::size_t axis) { motion.position[axis] += at.position[axis] - next.start[axis]; });
  add_velocity(piece.part[1], time_ms, at, axes, motion);
}

PathPoint evaluate(const PathPiece& piece, double time_ms) {
  PathPoint point;
  CurvePoint at;  // read for moved axes only
  evaluate(*piece.part[0].curve, parameter(piece.part[0], time_ms), at);
  point.position = at.position;
  add_motion(piece.part[0], time_ms, at, point);
  if (piece.part_count < 2) return point;
  const Curve& next = *piece.part[1].curve;
  evaluate(next, parameter(piece.part[1], time_ms), at);
  for_each_axis(next.moved, [&](std::size_t axis) { point.position[axis] += at.position[axis] - next.start[axis]; });
  add_motion(piece.part[1], time_ms, at, point);
  return point;
}

}  // namespace pmac::motion
