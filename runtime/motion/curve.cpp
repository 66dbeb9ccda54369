#include "runtime/motion/curve.h"

#include <cmath>

#include "runtime/motion/axis_vector.h"

namespace pmac::motion {
namespace {

/// A parameter this near to an end is the end: sums of ramp integrals miss it by rounding.
constexpr double kRounding = 1e-14;

void add_arc(const Curve& curve, double u, CurvePoint& point) {
  const double angle = u * curve.sweep_rad;
  const double c = std::cos(angle), s = std::sin(angle);
  const double rho = curve.radius + u * curve.radius_change;
  const double turn = curve.sweep_rad, grow = curve.radius_change;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t axis = static_cast<std::size_t>(curve.first_axis) + i;
    const double outward = curve.radial[i] * c + curve.tangential[i] * s;
    const double along = curve.tangential[i] * c - curve.radial[i] * s;
    point.position[axis] = curve.center[i] + u * curve.delta[axis] + rho * outward;
    point.d1[axis] = curve.delta[axis] + grow * outward + rho * turn * along;
    point.d2[axis] = 2 * grow * turn * along - rho * turn * turn * outward;
  }
}

}  // namespace

Curve line(const AxisVector& start, const AxisVector& end) {
  Curve curve;
  curve.start = start;
  curve.end = end;
  for (std::size_t axis = 0; axis < start.size(); ++axis) {
    curve.delta[axis] = end[axis] - start[axis];
    if (curve.delta[axis] != 0) curve.moved |= 1u << axis;
  }
  return curve;
}

void evaluate(const Curve& curve, double exact_u, CurvePoint& point) {
  const double u = std::abs(exact_u - 1) < kRounding ? 1 : std::abs(exact_u) < kRounding ? 0 : exact_u;
  point.position = u < 0.5 ? curve.start : curve.end;
  const AxisVector& base = point.position;
  const double offset = u < 0.5 ? u : u - 1;  // exact at both ends
  for_each_axis(curve.moved, [&](std::size_t axis) {
    point.d1[axis] = curve.delta[axis];
    point.d2[axis] = 0;
    point.position[axis] = base[axis] + offset * curve.delta[axis];
  });
  if (!curve.is_arc) return;
  add_arc(curve, u, point);
  if (u == 0) point.position = curve.start;
  if (u == 1) point.position = curve.end;
}

AxisVector derivative(const Curve& curve, double u) {
  if (!curve.is_arc) return curve.delta;
  CurvePoint point;
  point.d1.fill(0);
  evaluate(curve, u, point);
  return point.d1;
}

}  // namespace pmac::motion
