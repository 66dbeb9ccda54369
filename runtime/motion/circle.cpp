#include "runtime/motion/circle.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <fmt/core.h>

namespace pmac::motion {
namespace {

using Eigen::Vector3d;
using runtime::Fault;
using runtime::FaultKind;
using runtime::Result;

struct Plane {
  Vector3d start, chord;  // chord: from start to end, within the plane
  Vector3d lift;          // from start to end along the normal
  Vector3d turn;          // unit normal; the rotation is right-handed about it
};

Fault circle_fault(const MotionCommand& command, std::string detail) {
  return {FaultKind::kCircleRadius, command.source, std::move(detail)};
}

Vector3d circle_axes(const AxisVector& position, int first_axis) {
  return Eigen::Map<const Vector3d>(position.data() + first_axis);
}

Plane make_plane(const MotionCommand& command, const AxisVector& start, const AxisVector& end, int first_axis) {
  const Vector3d normal = Eigen::Map<const Vector3d>(command.normal.data()).normalized();
  const Vector3d from = circle_axes(start, first_axis);
  const Vector3d way = circle_axes(end, first_axis) - from;
  const Vector3d lift = way.dot(normal) * normal;
  return {from, way - lift, lift, command.clockwise ? normal : Vector3d(-normal)};
}

/// Centre from R, relative to the start point. R > 0: up to half a turn.
Result<Vector3d> center_from_radius(const MotionCommand& command, const Plane& plane, double error_limit_uu) {
  const double chord = plane.chord.norm();
  const double radius = std::abs(command.radius_uu);
  if (chord == 0) return circle_fault(command, "circle by radius ends where it starts; give the centre with I and J");
  const double excess = chord - 2 * radius;
  if (excess > 0 && error_limit_uu > 0 && excess > error_limit_uu)
    return circle_fault(command, fmt::format("end point is {} from the start, more than the diameter {}", chord, 2 * radius));
  const double height = std::sqrt(std::max(0.0, radius * radius - chord * chord / 4));
  const Vector3d side = plane.turn.cross(plane.chord / chord);
  return Vector3d(plane.chord / 2 + std::copysign(height, command.radius_uu) * side);
}

Vector3d center_from_vector(const MotionCommand& command, const Plane& plane) {
  const Vector3d center = Eigen::Map<const Vector3d>(command.center_uu.data());
  return center - center.dot(plane.turn) * plane.turn;
}

/// Angle from u to e about turn, in (min_arc, min_arc + 2 pi].
double sweep_angle(const Vector3d& u, const Vector3d& e, const Vector3d& turn, double min_arc_len) {
  const double angle = std::atan2(turn.dot(u.cross(e)), u.dot(e));
  const double minimum = (min_arc_len > 0 ? min_arc_len : 0x1p-20) * std::numbers::pi;
  return angle <= minimum ? angle + 2 * std::numbers::pi : angle;
}

void store(std::array<double, 3>& to, const Vector3d& from) { std::copy(from.data(), from.data() + 3, to.begin()); }

Arc arc_about(const Vector3d& center, const Plane& plane, const AxisVector& start, const AxisVector& end, int first_axis,
              double min_arc_len, double sweep_rad) {
  const Vector3d u = -center, e = plane.chord - center;
  Arc arc{line(start, end), 0, std::min(u.norm(), e.norm())};
  Curve& curve = arc.curve;
  curve.is_arc = true;
  curve.first_axis = first_axis;
  curve.moved |= 7u << first_axis;
  for (std::size_t i = 0; i < 3; ++i) curve.delta[static_cast<std::size_t>(first_axis) + i] = plane.lift[static_cast<Eigen::Index>(i)];
  curve.radius = u.norm();
  curve.radius_change = e.norm() - u.norm();
  curve.sweep_rad = sweep_rad > 0 ? sweep_rad : sweep_angle(u, e, plane.turn, min_arc_len);
  store(curve.center, plane.start + center);
  store(curve.radial, u.normalized());
  store(curve.tangential, plane.turn.cross(u.normalized()));
  arc.length_uu = curve.sweep_rad * (u.norm() + e.norm()) / 2;
  return arc;
}

}  // namespace

Result<Arc> make_arc(const MotionCommand& command, const AxisVector& start, const AxisVector& end, const PipelineConfig& config) {
  if (!command.has_center && !command.has_radius) return Arc{line(start, end), 0, 0};
  const int first_axis = command.second_set ? kAxisXX : kAxisX;
  const Plane plane = make_plane(command, start, end, first_axis);
  if (!(plane.turn.norm() > 0.5)) return circle_fault(command, "the normal vector is zero; set it with normal");
  Vector3d center = center_from_vector(command, plane);
  if (!command.has_center) {
    const Result<Vector3d> by_radius = center_from_radius(command, plane, config.radius_error_limit_uu);
    if (const Fault* fault = std::get_if<Fault>(&by_radius)) return *fault;
    center = std::get<Vector3d>(by_radius);
  }
  const double start_radius = center.norm(), end_radius = (plane.chord - center).norm();
  if (!(start_radius > 0)) return circle_fault(command, "the centre is the start point; I, J and K give the vector to the centre");
  const double error = std::abs(end_radius - start_radius);
  if (command.sweep_rad == 0 && config.radius_error_limit_uu > 0 && error > config.radius_error_limit_uu)
    return circle_fault(command, fmt::format("radius is {} at the start and {} at the end point", start_radius, end_radius));
  return arc_about(center, plane, start, end, first_axis, config.min_arc_len, command.sweep_rad);
}

}  // namespace pmac::motion
