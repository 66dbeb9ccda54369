// Slow and plain: the shortest time in which a planar two-link arm can take its tool along a path of lines and arcs, from rest to rest,
// when each joint has limits of speed and acceleration and the path speed its own. The same phase-plane integration as
// time_optimal.h, with the joints' first and second derivatives with respect to path length: q' = J^-1 p', q'' = J^-1 (p'' - J' p').
// Independent of the runtime: it knows geometry, not programmed time.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>
#include <vector>

#include "tests/reference/time_optimal.h"

namespace pmac::reference {

struct TwoLinkArm { double upper_mm, fore_mm; };                       // elbow angle above 0
struct JointLimits { double speed_rad_s, accel_rad_s2; };               // of both joints

class JointTimeOptimal {
 public:
  JointTimeOptimal(TwoLinkArm arm, JointLimits limits, double path_speed_mm_s, double start_x_mm, double start_y_mm, std::vector<PlanePiece> path, double step_mm)
      : arm_(arm), limits_(limits), path_speed_(path_speed_mm_s), x_(start_x_mm), y_(start_y_mm), path_(std::move(path)), step_(step_mm) {}

  /// Time in ms.
  double solve() {
    place_points();
    const std::size_t n = points_.size();
    std::vector<double> limit(n), x(n);
    for (std::size_t i = 0; i < n; ++i) limit[i] = highest(points_[i]);
    x.back() = 0;
    for (std::size_t i = n - 1; i-- > 0;) x[i] = std::clamp(x[i + 1] - 2 * gap(i) * bounds(points_[i + 1], x[i + 1]).first, 0.0, limit[i]);
    x.front() = 0;
    for (std::size_t i = 0; i + 1 < n; ++i) x[i + 1] = std::clamp(x[i] + 2 * gap(i) * bounds(points_[i], x[i]).second, 0.0, x[i + 1]);
    double time_s = 0;
    for (std::size_t i = 0; i + 1 < n; ++i) time_s += 2 * gap(i) / (std::sqrt(x[i]) + std::sqrt(x[i + 1]));
    return time_s * 1000;
  }

 private:
  struct Point { double s; std::array<double, 2> d, dd; };  // of the joints with respect to path length

  Point point(double s, double x, double y, double heading, double curvature) const {
    const double l1 = arm_.upper_mm, l2 = arm_.fore_mm, r2 = x * x + y * y;
    const double elbow = std::acos((r2 - l1 * l1 - l2 * l2) / (2 * l1 * l2));
    const double shoulder = std::atan2(y, x) - std::atan2(l2 * std::sin(elbow), l1 + l2 * std::cos(elbow));
    const double s1 = std::sin(shoulder), c1 = std::cos(shoulder), s12 = std::sin(shoulder + elbow), c12 = std::cos(shoulder + elbow);
    const auto solve = [&](double px, double py) {  // u, v: rates of shoulder and of shoulder + elbow
      const double det = l1 * l2 * std::sin(elbow);
      return std::pair((px * l2 * c12 + py * l2 * s12) / det, -(px * l1 * c1 + py * l1 * s1) / det);
    };
    const auto [u, v] = solve(std::cos(heading), std::sin(heading));
    const double ax = -std::sin(heading) * curvature + l1 * c1 * u * u + l2 * c12 * v * v;
    const double ay = std::cos(heading) * curvature + l1 * s1 * u * u + l2 * s12 * v * v;
    const auto [uu, vv] = solve(ax, ay);
    return {s, {u, v - u}, {uu, vv - uu}};
  }

  void place_points() {
    double s = 0, x = x_, y = y_;
    for (const PlanePiece& piece : path_) {
      const auto at = [&](double l) {
        const double h = piece.heading_rad, k = piece.curvature_per_mm;
        if (k == 0) return std::pair(x + l * std::cos(h), y + l * std::sin(h));
        return std::pair(x + (std::sin(h + k * l) - std::sin(h)) / k, y - (std::cos(h + k * l) - std::cos(h)) / k);
      };
      const int n = std::max(2, static_cast<int>(std::ceil(piece.length_mm / step_)));
      for (int i = 0; i < n; ++i) {
        const double l = piece.length_mm * (i + 0.5) / n;
        const auto [px, py] = at(l);
        points_.push_back(point(s + l, px, py, piece.heading_rad + piece.curvature_per_mm * l, piece.curvature_per_mm));
      }
      std::tie(x, y) = at(piece.length_mm);
      s += piece.length_mm;
    }
  }
  double gap(std::size_t i) const { return points_[i + 1].s - points_[i].s; }

  /// Largest x = speed^2 at which the speeds are within limits and some path acceleration keeps both joints' within theirs.
  double highest(const Point& p) const {
    const double a = limits_.accel_rad_s2;
    double x = path_speed_ * path_speed_;
    for (std::size_t j = 0; j < 2; ++j) {
      if (p.d[j] != 0) x = std::min(x, std::pow(limits_.speed_rad_s / p.d[j], 2));
      if (std::abs(p.d[j]) < 1e-15 && p.dd[j] != 0) x = std::min(x, a / std::abs(p.dd[j]));
    }
    const double cross = std::abs(p.d[0] * p.dd[1] - p.d[1] * p.dd[0]);
    return cross > 0 ? std::min(x, a * (std::abs(p.d[0]) + std::abs(p.d[1])) / cross) : x;
  }
  /// Lowest and highest path acceleration at x.
  std::pair<double, double> bounds(const Point& p, double x) const {
    double low = -1e300, high = 1e300;
    for (std::size_t j = 0; j < 2; ++j) {
      if (std::abs(p.d[j]) < 1e-15) continue;
      const double from = (-limits_.accel_rad_s2 - p.dd[j] * x) / p.d[j], to = (limits_.accel_rad_s2 - p.dd[j] * x) / p.d[j];
      low = std::max(low, std::min(from, to));
      high = std::min(high, std::max(from, to));
    }
    return {low, high};
  }

  TwoLinkArm arm_;
  JointLimits limits_;
  double path_speed_, x_, y_;
  std::vector<PlanePiece> path_;
  double step_;
  std::vector<Point> points_;
};

}  // namespace pmac::reference
