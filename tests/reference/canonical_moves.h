// End points of the canonical machining moves that a G-code interpreter prints (STRAIGHT_TRAVERSE, STRAIGHT_FEED, ARC_FEED of the NIST
// RS274/NGC canon), as machine positions in mm: an independent reading of a part program to compare ours with.
#pragma once

#include <array>
#include <cmath>
#include <cstdlib>
#include <istream>
#include <string>
#include <vector>

namespace pmac::test {

using Point = std::array<double, 3>;  // X Y Z, mm

class CanonicalMoves {
 public:
  /// Reads the whole text; `start_mm` is the first point.
  explicit CanonicalMoves(std::istream& text, Point start_mm = {0, 0, 0}) : points_{start_mm} {
    for (std::string line; std::getline(text, line);) take(line);
  }
  const std::vector<Point>& points_mm() const { return points_; }

 private:
  void take(const std::string& line) {
    const std::size_t open = line.find('(');
    if (open == std::string::npos) return;
    const std::string call = line.substr(line.find_last_of(" \t", open) + 1, open - line.find_last_of(" \t", open) - 1);
    if (call == "USE_LENGTH_UNITS") unit_mm_ = line.find("INCHES") != std::string::npos ? 25.4 : 1;
    if (call == "SELECT_PLANE") plane_ = line.find("XZ") != std::string::npos ? 1 : line.find("YZ") != std::string::npos ? 2 : 0;
    const std::vector<double> n = numbers(line, open + 1);
    if (call == "SET_G5X_OFFSET") work_ = scaled(n, 1);
    if (call == "SET_G92_OFFSET") shift_ = scaled(n, 0);
    if (call == "USE_TOOL_LENGTH_OFFSET") tool_ = scaled(n, 0);
    if (call == "STRAIGHT_TRAVERSE" || call == "STRAIGHT_FEED") add({n[0], n[1], n[2]});
    if (call == "ARC_FEED") add(arc_end(n));
  }

  /// first, second axis of the plane, centre, centre, turns, third axis: XY, ZX and YZ.
  Point arc_end(const std::vector<double>& n) const {
    if (plane_ == 1) return {n[1], n[5], n[0]};
    if (plane_ == 2) return {n[5], n[0], n[1]};
    return {n[0], n[1], n[5]};
  }

  void add(const Point& programmed) {
    Point p;
    for (std::size_t i = 0; i < 3; ++i) p[i] = unit_mm_ * programmed[i] + work_[i] + shift_[i] + tool_[i];
    points_.push_back(p);
  }

  Point scaled(const std::vector<double>& n, std::size_t first) const {
    Point p{};
    for (std::size_t i = 0; i < 3 && first + i < n.size(); ++i) p[i] = unit_mm_ * n[first + i];
    return p;
  }

  static std::vector<double> numbers(const std::string& line, std::size_t at) {
    std::vector<double> found;
    for (const char* p = line.c_str() + at; *p && *p != '"';) {
      char* end = nullptr;
      const double value = std::strtod(p, &end);
      if (end == p) ++p;
      else found.push_back(value), p = end;
    }
    return found;
  }

  std::vector<Point> points_;
  double unit_mm_ = 1;
  int plane_ = 0;
  Point work_{}, shift_{}, tool_{};
};

/// Without points that repeat the one before.
inline std::vector<Point> without_repeats(const std::vector<Point>& points, double tolerance_mm) {
  std::vector<Point> kept;
  for (const Point& p : points)
    if (kept.empty() || std::hypot(p[0] - kept.back()[0], p[1] - kept.back()[1], p[2] - kept.back()[2]) > tolerance_mm) kept.push_back(p);
  return kept;
}

}  // namespace pmac::test
