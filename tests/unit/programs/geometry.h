// Distance of a point from a path of lines and arcs, by plain geometry.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace pmac::test {

struct Element {
  double x0, y0, x1, y1;          // ends
  double cx = 0, cy = 0;          // centre of an arc
  int turn = 0;                   // 0 line, +1 counter-clockwise, -1 clockwise
};

inline double distance_to(const Element& e, double x, double y) {
  const double to_ends = std::min(std::hypot(x - e.x0, y - e.y0), std::hypot(x - e.x1, y - e.y1));
  if (e.turn == 0) {
    const double dx = e.x1 - e.x0, dy = e.y1 - e.y0, length2 = dx * dx + dy * dy;
    const double f = std::clamp(((x - e.x0) * dx + (y - e.y0) * dy) / length2, 0.0, 1.0);
    return std::hypot(x - e.x0 - f * dx, y - e.y0 - f * dy);
  }
  const double two_pi = 2 * std::numbers::pi;
  const double start = std::atan2(e.y0 - e.cy, e.x0 - e.cx), end = std::atan2(e.y1 - e.cy, e.x1 - e.cx);
  const double at = std::atan2(y - e.cy, x - e.cx);
  const auto swept = [&](double a) { return std::fmod(std::fmod(e.turn * (a - start), two_pi) + two_pi, two_pi); };
  if (swept(at) <= swept(end)) return std::abs(std::hypot(x - e.cx, y - e.cy) - std::hypot(e.x0 - e.cx, e.y0 - e.cy));
  return to_ends;
}

inline double distance_to(const std::vector<Element>& path, double x, double y) {
  double best = std::numeric_limits<double>::infinity();
  for (const Element& e : path) best = std::min(best, distance_to(e, x, y));
  return best;
}

}  // namespace pmac::test
