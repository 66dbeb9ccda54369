// Slow and plain: the shortest time in which a path of lines and arcs in the plane can be run through from rest to rest when each
// axis has the same limit of acceleration and the path speed its own. Phase-plane integration over path length on a dense grid,
// explicit Euler: backward from the end, then forward. Independent of the runtime: it knows geometry, not programmed time.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace pmac::reference {

/// One line or arc: curvature 0 or +-1/R (left positive), heading at its start, length. Lengths in mm, angles in rad.
struct PlanePiece { double heading_rad, length_mm, curvature_per_mm; };

class TimeOptimal {
 public:
  TimeOptimal(std::vector<PlanePiece> path, double speed_mm_s, double accel_mm_s2, double step_mm)
      : path_(std::move(path)), speed_(speed_mm_s), accel_(accel_mm_s2), step_(step_mm) {}

  /// Time in ms.
  double solve() {
    place_points();
    std::vector<double> limit(points_.size()), x(points_.size());
    for (std::size_t i = 0; i < points_.size(); ++i) limit[i] = std::min(speed_ * speed_, highest(points_[i]));
    x.back() = 0;
    for (std::size_t i = points_.size() - 1; i-- > 0;)
      x[i] = std::clamp(x[i + 1] - 2 * gap(i) * bounds(points_[i + 1], x[i + 1]).first, 0.0, limit[i]);
    x.front() = 0;
    for (std::size_t i = 0; i + 1 < points_.size(); ++i)
      x[i + 1] = std::clamp(x[i] + 2 * gap(i) * bounds(points_[i], x[i]).second, 0.0, x[i + 1]);
    double time_s = 0;
    for (std::size_t i = 0; i + 1 < points_.size(); ++i) time_s += 2 * gap(i) / (std::sqrt(x[i]) + std::sqrt(x[i + 1]));
    return time_s * 1000;
  }

 private:
  struct Point { double s, dx, dy, ddx, ddy; };  // first and second derivative with respect to path length

  void place_points() {
    double s = 0;
    for (const PlanePiece& piece : path_) {
      const int n = std::max(2, static_cast<int>(std::ceil(piece.length_mm / step_)));
      for (int k = 0; k < n; ++k) {
        const double l = piece.length_mm * (k + 0.5) / n;
        const double a = piece.heading_rad + piece.curvature_per_mm * l;
        points_.push_back({s + l, std::cos(a), std::sin(a), -std::sin(a) * piece.curvature_per_mm, std::cos(a) * piece.curvature_per_mm});
      }
      s += piece.length_mm;
    }
  }
  double gap(std::size_t i) const { return points_[i + 1].s - points_[i].s; }

  /// Largest x = speed^2 at which some path acceleration keeps both axes within limits.
  double highest(const Point& p) const {
    const double cross = std::abs(p.dx * p.ddy - p.dy * p.ddx);
    double x = 1e300;
    if (cross > 0) x = accel_ * (std::abs(p.dx) + std::abs(p.dy)) / cross;
    if (std::abs(p.dx) < 1e-12) x = std::min(x, accel_ / std::max(1e-300, std::abs(p.ddx)));
    if (std::abs(p.dy) < 1e-12) x = std::min(x, accel_ / std::max(1e-300, std::abs(p.ddy)));
    return x;
  }
  /// Lowest and highest path acceleration at x.
  std::pair<double, double> bounds(const Point& p, double x) const {
    double low = -1e300, high = 1e300;
    for (const auto& [d, dd] : {std::pair{p.dx, p.ddx}, std::pair{p.dy, p.ddy}}) {
      if (std::abs(d) < 1e-12) continue;
      const double a = (-accel_ - dd * x) / d, b = (accel_ - dd * x) / d;
      low = std::max(low, std::min(a, b));
      high = std::min(high, std::max(a, b));
    }
    return {low, high};
  }

  std::vector<PlanePiece> path_;
  double speed_, accel_, step_;
  std::vector<Point> points_;
};

}  // namespace pmac::reference
