#include "runtime/drives/mcx514/path_item.h"

#include <algorithm>
#include <cmath>

namespace pmac::drives::mcx514 {

double distance(const Point& a, const Point& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum);
}

Point nearest_on_segment(const Point& a, const Point& b, const Point& p) {
  double along = 0, length2 = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    along += (p[i] - a[i]) * (b[i] - a[i]);
    length2 += (b[i] - a[i]) * (b[i] - a[i]);
  }
  const double share = length2 > 0 ? std::clamp(along / length2, 0.0, 1.0) : 0.0;
  Point result;
  for (std::size_t i = 0; i < a.size(); ++i) result[i] = a[i] + share * (b[i] - a[i]);
  return result;
}

double radius(const PathItem& arc) { return std::hypot(arc.start[arc.plane[0]] - arc.center[0], arc.start[arc.plane[1]] - arc.center[1]); }

Point arc_point(const PathItem& arc, double share) {
  Point p;
  for (std::size_t i = 0; i < p.size(); ++i) p[i] = arc.start[i] + share * (arc.end[i] - arc.start[i]);
  const double angle = arc.start_angle_rad + share * arc.sweep_rad, r = radius(arc);
  p[arc.plane[0]] = arc.center[0] + r * std::cos(angle);
  p[arc.plane[1]] = arc.center[1] + r * std::sin(angle);
  return p;
}

double length(const PathItem& item) {
  if (item.kind == PathItem::Kind::kLine) return distance(item.start, item.end);
  if (item.kind == PathItem::Kind::kPoints) {
    double sum = 0;
    for (std::size_t i = 1; i < item.points.size(); ++i) sum += distance(item.points[i - 1], item.points[i]);
    return sum;
  }
  Point along = item.end;
  for (const std::size_t axis : item.plane) along[axis] = item.start[axis];
  return std::hypot(radius(item) * item.sweep_rad, distance(item.start, along));
}

namespace {

Point nearest_on_arc(const PathItem& arc, const Point& p) {
  const double angle = std::atan2(p[arc.plane[1]] - arc.center[1], p[arc.plane[0]] - arc.center[0]);
  const double direction = arc.sweep_rad < 0 ? -1 : 1, sweep = std::abs(arc.sweep_rad);
  double turned = direction * (angle - arc.start_angle_rad);
  turned -= 2 * M_PI * std::floor(turned / (2 * M_PI));           // 0 to a full turn
  if (turned <= sweep) return arc_point(arc, sweep > 0 ? turned / sweep : 0);
  return 2 * M_PI - turned < turned - sweep ? arc.start : arc.end;
}

/// The best of the segments around the hint: on as long as they come nearer.
Point nearest_on_points(const PathItem& item, const Point& p, std::size_t& hint) {
  constexpr std::size_t kLookAhead = 32;
  Point best = nearest_on_segment(item.points[hint], item.points[hint + 1], p);
  double best_distance = distance(best, p);
  const std::size_t first = hint > 2 ? hint - 2 : 0;
  for (std::size_t i = first, beyond = 0; i + 1 < item.points.size() && beyond < kLookAhead; ++i) {
    const Point candidate = nearest_on_segment(item.points[i], item.points[i + 1], p);
    const double d = distance(candidate, p);
    if (i > hint) ++beyond;
    if (d >= best_distance) continue;
    best = candidate;
    best_distance = d;
    hint = i;
    beyond = 0;
  }
  return best;
}

}  // namespace

Point nearest(const PathItem& item, const Point& p, std::size_t& hint) {
  switch (item.kind) {
    case PathItem::Kind::kArc: return nearest_on_arc(item, p);
    case PathItem::Kind::kPoints: return item.points.size() < 2 ? item.start : nearest_on_points(item, p, hint);
    default: return nearest_on_segment(item.start, item.end, p);
  }
}

}  // namespace pmac::drives::mcx514
