#include "runtime/motion/plane_geometry.h"

#include <algorithm>
#include <numbers>

#include "runtime/motion/curve.h"

namespace pmac::motion {
namespace {

/// What rounding leaves between curves that touch, relative to their size.
constexpr double kTouch = 1e-9;

using Vector = std::array<double, 3>;

double dot3(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vector cross3(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Vector unit(const Vector& v) {
  const double size = std::sqrt(dot3(v, v));
  return {v[0] / size, v[1] / size, v[2] / size};
}

/// The axis after the one that the normal is nearest to (Z: X, X: Y, Y: Z), at right angles to the normal.
Vector first_direction(const Vector& up) {
  const auto nearest = static_cast<std::size_t>(std::max_element(up.begin(), up.end(), [](double a, double b) { return std::abs(a) < std::abs(b); }) - up.begin());
  Vector axis{};
  axis[(nearest + 1) % 3] = 1;
  const double along = dot3(axis, up);
  for (std::size_t i = 0; i < 3; ++i) axis[i] -= along * up[i];
  return unit(axis);
}

}  // namespace

PlaneFrame::PlaneFrame(const std::array<double, 3>& normal) : normal_(normal) {
  up_ = unit({-normal[0], -normal[1], -normal[2]});
  u_ = first_direction(up_);
  v_ = cross3(up_, u_);
}

Point PlaneFrame::point(const AxisVector& p) const {
  const Vector xyz{p[kAxisX], p[kAxisX + 1], p[kAxisX + 2]};
  return {dot3(xyz, u_), dot3(xyz, v_)};
}

std::array<double, 3> PlaneFrame::vector(Point p) const {
  return {p.x * u_[0] + p.y * v_[0], p.x * u_[1] + p.y * v_[1], p.x * u_[2] + p.y * v_[2]};
}

void PlaneFrame::put(AxisVector& position_uu, Point point) const {
  const Vector xyz{position_uu[kAxisX], position_uu[kAxisX + 1], position_uu[kAxisX + 2]};
  const double height = dot3(xyz, up_);
  const Vector in_plane = vector(point);
  for (std::size_t i = 0; i < 3; ++i) position_uu[kAxisX + i] = in_plane[i] + height * up_[i];
}

PlaneMove plane_line(Point start, Point end) {
  PlaneMove move;
  move.start = start;
  move.end = end;
  const Point way = end - start;
  move.start_direction = move.end_direction = way * (1 / length(way));
  return move;
}

PlaneMove plane_arc(Point start, Point end, Point center, double sweep_rad, double turn) {
  PlaneMove move;
  move.start = start;
  move.end = end;
  move.is_arc = true;
  move.center = center;
  move.sweep_rad = sweep_rad;
  move.turn = turn;
  move.start_radius = length(start - center);
  move.end_radius = length(end - center);
  move.start_direction = left_of(start - center) * (turn / move.start_radius);
  move.end_direction = left_of(end - center) * (turn / move.end_radius);
  return move;
}

OffsetCurve offset_curve(const PlaneMove& move, double start_offset, double end_offset) {
  OffsetCurve curve;
  curve.start = move.start + left_of(move.start_direction) * start_offset;
  curve.end = move.end + left_of(move.end_direction) * end_offset;
  curve.is_circle = move.is_arc;
  curve.center = move.center;
  curve.start_radius = move.start_radius - move.turn * start_offset;
  curve.end_radius = move.end_radius - move.turn * end_offset;
  curve.sweep_rad = move.sweep_rad;
  curve.turn = move.turn;
  return curve;
}

double signed_angle(Point from, Point to, double turn) { return turn * std::atan2(cross(from, to), dot(from, to)); }

double angle_between(Point from, Point to, double turn) {
  const double angle = signed_angle(from, to, turn);
  return angle < 0 ? angle + 2 * std::numbers::pi : angle;
}

namespace {

struct Crossings {
  std::array<Point, 2> point;
  int count = 0;
  void add(Point p) { point[static_cast<std::size_t>(count++)] = p; }
};

Crossings line_and_line(Point p, Point direction, Point q, Point other) {
  Crossings result;
  const double sine = cross(direction, other) / (length(direction) * length(other));
  if (std::abs(sine) > 1e-12) result.add(p + direction * (cross(q - p, other) / cross(direction, other)));
  return result;
}

Crossings line_and_circle(Point p, Point direction, Point center, double radius) {
  Crossings result;
  const Point unit = direction * (1 / length(direction));
  const Point foot = p + unit * dot(center - p, unit);
  const double distance = length(center - foot);
  if (distance > radius * (1 + kTouch)) return result;
  const double half = std::sqrt(std::max(0.0, (radius - distance) * (radius + distance)));
  result.add(foot - unit * half);
  result.add(foot + unit * half);
  return result;
}

Crossings circle_and_circle(Point a, double radius_a, Point b, double radius_b) {
  Crossings result;
  const Point way = b - a;
  const double distance = length(way), tolerance = kTouch * std::max(radius_a, radius_b);
  if (distance <= tolerance || distance > radius_a + radius_b + tolerance || distance < std::abs(radius_a - radius_b) - tolerance) return result;
  const double along = (distance * distance + (radius_a - radius_b) * (radius_a + radius_b)) / (2 * distance);
  const double half = std::sqrt(std::max(0.0, (radius_a - along) * (radius_a + along)));
  const Point unit = way * (1 / distance), foot = a + unit * along;
  result.add(foot - left_of(unit) * half);
  result.add(foot + left_of(unit) * half);
  return result;
}

Crossings all_crossings(const OffsetCurve& a, const OffsetCurve& b) {
  const Point way_a = a.end - a.start, way_b = b.end - b.start;
  const bool no_way = (!a.is_circle && length(way_a) == 0) || (!b.is_circle && length(way_b) == 0);
  if (no_way) return {};
  if (!a.is_circle && !b.is_circle) return line_and_line(a.start, way_a, b.start, way_b);
  if (!a.is_circle) return line_and_circle(a.start, way_a, b.center, b.start_radius);
  if (!b.is_circle) return line_and_circle(b.start, way_b, a.center, a.end_radius);
  return circle_and_circle(a.center, a.end_radius, b.center, b.start_radius);
}

bool lies_on(const OffsetCurve& curve, Point p) {
  constexpr double kRounding = 1e-9;
  if (!curve.is_circle) {
    const Point way = curve.end - curve.start;
    const double part = dot(p - curve.start, way) / dot(way, way);
    return part >= -kRounding && part <= 1 + kRounding;
  }
  const double angle = angle_between(curve.start - curve.center, p - curve.center, curve.turn);
  return angle <= curve.sweep_rad + kRounding || angle >= 2 * std::numbers::pi - kRounding;
}

template <class Accept>
std::optional<Point> nearest(const Crossings& crossings, Point near, const Accept& accept) {
  std::optional<Point> best;
  for (int i = 0; i < crossings.count; ++i) {
    const Point p = crossings.point[static_cast<std::size_t>(i)];
    if (accept(p) && (!best || length(p - near) < length(*best - near))) best = p;
  }
  return best;
}

}  // namespace

std::optional<Point> nearest_crossing(const OffsetCurve& a, const OffsetCurve& b, Point near) {
  return nearest(all_crossings(a, b), near, [](Point) { return true; });
}

std::optional<Point> shared_crossing(const OffsetCurve& a, const OffsetCurve& b, Point near) {
  return nearest(all_crossings(a, b), near, [&](Point p) { return lies_on(a, p) && lies_on(b, p); });
}

}  // namespace pmac::motion
