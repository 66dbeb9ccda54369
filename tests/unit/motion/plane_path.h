// Programmed shapes and the distance of recorded motors from them.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/unit/motion/scenario.h"

namespace pmac::motion::test {

/// A line from (x0,y0) to (x1,y1), or a full circle about (x0,y0) where radius > 0.
struct Shape { double x0, y0, x1, y1, radius; };

inline double distance(const Shape& s, double x, double y) {
  if (s.radius > 0) return std::abs(std::hypot(x - s.x0, y - s.y0) - s.radius);
  const double dx = s.x1 - s.x0, dy = s.y1 - s.y0;
  const double t = std::clamp(((x - s.x0) * dx + (y - s.y0) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
  return std::hypot(x - s.x0 - t * dx, y - s.y0 - t * dy);
}

/// Largest distance of any sample from the nearest shape, in axis units.
inline double contour_error(const Run& run, const std::vector<Shape>& shapes, double scale) {
  double worst = 0;
  for (std::size_t k = 0; k < run.position[0].size(); ++k) {
    double nearest = 1e300;
    for (const Shape& shape : shapes) nearest = std::min(nearest, distance(shape, run.position[0][k] / scale, run.position[1][k] / scale));
    worst = std::max(worst, nearest);
  }
  return worst;
}

inline std::vector<Shape> oval_shape() {
  return {{-60, 0, 60, 0, 0}, {-60, 20, 60, 20, 0}, {60, 10, 0, 0, 10}, {-60, 10, 0, 0, 10}};
}

inline std::vector<Shape> contour_shape() {
  return {{1, 4, 1, 13, 0}, {2, 13, 0, 0, 1}, {2, 14, 3, 14, 0}, {3, 13, 0, 0, 1}, {4, 13, 4, 7, 0}, {7, 7, 0, 0, 3},
          {7, 4, 13, 4, 0}, {13, 3, 0, 0, 1}, {14, 3, 14, 2, 0}, {13, 2, 0, 0, 1}, {13, 1, 4, 1, 0}, {4, 4, 0, 0, 3}};
}

}  // namespace pmac::motion::test
