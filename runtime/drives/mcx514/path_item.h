// The commanded path as the encoder takes it: lines, arcs and curves given by points, in pulses of the chip's axes (a motor unit is a pulse),
// relative to where the run began.
#pragma once

#include <array>
#include <vector>

#include "compiler/bytecode/bytecode.h"
#include "runtime/drives/mcx514/interpolator.h"

namespace pmac::drives::mcx514 {

using Point = std::array<double, kAxes>;

struct PathItem {
  enum class Kind : std::uint8_t { kLine, kArc, kPoints };
  Kind kind = Kind::kLine;
  bytecode::SourceLine source;
  Point start{}, end{};
  // kArc: a circle in the plane of two axes; the others go along evenly with the angle
  std::array<std::size_t, 2> plane{0, 1};
  std::array<double, 2> center{};
  double start_angle_rad = 0, sweep_rad = 0;   // counter-clockwise from plane[0] to plane[1]
  std::vector<Point> points;                   // kPoints: first and last are start and end
  double speed_pps = 0;                        // largest along the path
  double start_s = 0, duration_s = 0;
};

double distance(const Point& a, const Point& b);
/// Nearest point of the segment from a to b.
Point nearest_on_segment(const Point& a, const Point& b, const Point& p);

double radius(const PathItem& arc);
Point arc_point(const PathItem& arc, double share);   // share: 0 at the start, 1 at the end
double length(const PathItem& item);

/// Nearest point of an item. hint: for kPoints, the segment where the last one was found; kept by the caller, 0 at first.
Point nearest(const PathItem& item, const Point& p, std::size_t& hint);

/// Points of a curve so close that chords miss it by less than tolerance pulses. at(share): 0 to 1.
template <class At>
void sample_curve(const At& at, double from, double to, double tolerance, std::vector<Point>& points, int depth = 0) {
  const Point a = points.back(), b = at(to), middle = at((from + to) / 2);
  const bool is_straight = distance(nearest_on_segment(a, b, middle), middle) < tolerance;
  if ((is_straight && depth >= 3) || depth >= 24) {
    points.push_back(b);
    return;
  }
  sample_curve(at, from, (from + to) / 2, tolerance, points, depth + 1);
  sample_curve(at, (from + to) / 2, to, tolerance, points, depth + 1);
}

}  // namespace pmac::drives::mcx514
