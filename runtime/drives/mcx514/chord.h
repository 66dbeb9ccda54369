// Lines of pulses along a curve of points: each as long as its pulses stay within a tolerance of the curve.
#pragma once

#include <optional>
#include <vector>

#include "runtime/drives/mcx514/path_item.h"

namespace pmac::drives::mcx514 {

class ChordFinder {
 public:
  /// points: a curve, chords of which stand for it; at least two.
  ChordFinder(const std::vector<Point>& points, double tolerance);
  /// Finish point of the next line, from where the last one ended; nullopt at the end of the curve.
  std::optional<AxisCounts> next(const AxisCounts& from);

 private:
  Point at(double s) const;
  bool is_good(const AxisCounts& from, double to_s) const;
  double distance_within(const Point& p, double s0, double s1, std::size_t& hint) const;

  const std::vector<Point>& points_;
  std::vector<double> s_;            // length along the curve up to each point
  double tolerance_;
  double done_ = 0;
  bool ended_ = false;
};

}  // namespace pmac::drives::mcx514
