// Lines and arcs in the plane of cutter compensation, their parallel curves and where those meet. Counter-clockwise and left are as
// seen against the plane normal (normal k-1: from +Z).
#pragma once

#include <array>
#include <cmath>
#include <optional>

#include "runtime/motion/types.h"

namespace pmac::motion {

/// A point or a vector of the plane, axis units.
struct Point {
  double x = 0, y = 0;
};
inline Point operator+(Point a, Point b) { return {a.x + b.x, a.y + b.y}; }
inline Point operator-(Point a, Point b) { return {a.x - b.x, a.y - b.y}; }
inline Point operator*(Point a, double s) { return {a.x * s, a.y * s}; }
inline double dot(Point a, Point b) { return a.x * b.x + a.y * b.y; }
inline double cross(Point a, Point b) { return a.x * b.y - a.y * b.x; }
inline double length(Point a) { return std::hypot(a.x, a.y); }
/// A quarter turn counter-clockwise.
inline Point left_of(Point a) { return {-a.y, a.x}; }

/// The plane at right angles to a normal, in the X Y Z axes. Planes along two axes take over their coordinates as they are.
class PlaneFrame {
 public:
  explicit PlaneFrame(const std::array<double, 3>& normal = {0, 0, -1});
  const std::array<double, 3>& normal() const { return normal_; }
  Point point(const AxisVector& position_uu) const;
  /// Moves a position within the plane to the point; its height stays.
  void put(AxisVector& position_uu, Point point) const;
  std::array<double, 3> vector(Point v) const;

 private:
  std::array<double, 3> normal_, u_{}, v_{}, up_{};
};

/// A line or an arc (spiral where the radii differ) run through from start to end.
struct PlaneMove {
  Point start, end;
  Point start_direction, end_direction;  // unit tangents
  bool is_arc = false;
  Point center;
  double start_radius = 0, end_radius = 0;
  double sweep_rad = 0;                  // > 0
  double turn = 1;                       // 1 counter-clockwise, -1 clockwise
};

PlaneMove plane_line(Point start, Point end);
PlaneMove plane_arc(Point start, Point end, Point center, double sweep_rad, double turn);

/// The parallel curve of a move at offsets (left positive) that may differ from start to end.
struct OffsetCurve {
  Point start, end;       // at right angles to the move's ends
  bool is_circle = false;
  Point center;           // of a circle
  double start_radius = 0, end_radius = 0;
  double sweep_rad = 0, turn = 1;
};
OffsetCurve offset_curve(const PlaneMove& move, double start_offset, double end_offset);

/// Angle from `from` to `to` about the origin in the sense `turn`, in [0, 2 pi).
double angle_between(Point from, Point to, double turn);
/// The same, in (-pi, pi].
double signed_angle(Point from, Point to, double turn);

/// Where the end of `a` and the beginning of `b` meet, as near to `near` as possible: lines go on for ever, arcs all the way round.
std::optional<Point> nearest_crossing(const OffsetCurve& a, const OffsetCurve& b, Point near);
/// The same among the points that lie on both curves between their ends.
std::optional<Point> shared_crossing(const OffsetCurve& a, const OffsetCurve& b, Point near);

}  // namespace pmac::motion
