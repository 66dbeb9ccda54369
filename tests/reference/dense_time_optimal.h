// Slow and plain: the shortest time from rest to rest along a path of N motors, each with its own limits of speed and acceleration,
// never faster at any place than the program. The path is a row of closely spaced points; nothing is streamed, simplified or
// remembered. It knows positions and their derivatives with respect to path length, not programmed time and not segments.
//
// With x = (path speed)^2 and u = path acceleration, motor acceleration is d u + dd x. Over the gap between two points u is constant, and
// the limits hold at both of its ends. Backward: the largest x at each point from which the next point's can be met, by bisection (the
// set is convex and contains 0). Forward: the largest u. Where the path stops (a corner), x is 0.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace pmac::reference {

struct DensePoint {
  double place = 0;               // path length up to here
  std::vector<double> d, dd;      // [motor] first and second derivative of the position with respect to path length
  double speed_cap = 0;           // of the program here, path length per ms
  bool stops = false;             // motion has to rest here
  double wait_ms = 0;             // the program itself rests here for so long
};

struct DenseLimits {
  std::vector<double> speed, accel;   // [motor], per ms and per ms^2; infinite: off
};

class DenseTimeOptimal {
 public:
  DenseTimeOptimal(std::vector<DensePoint> path, DenseLimits limits) : path_(std::move(path)), limits_(std::move(limits)) {}

  /// Time in ms from rest at the first to rest at the last point.
  double solve() {
    const std::size_t n = path_.size();
    std::vector<double> x(n);
    for (std::size_t i = n - 1; i-- > 0;) x[i] = largest_start(i, x[i + 1]);
    x.front() = 0;
    double time_ms = 0;
    for (std::size_t i = 0; i + 1 < n; ++i) {
      const double next = std::clamp(x[i] + 2 * gap(i) * control(i, x[i]).high, 0.0, x[i + 1]);
      time_ms += path_[i].wait_ms + (gap(i) == 0 ? 0 : 2 * gap(i) / (std::sqrt(x[i]) + std::sqrt(next)));
      x[i + 1] = next;
    }
    return time_ms;
  }

 private:
  struct Range { double low, high; };

  double gap(std::size_t i) const { return path_[i + 1].place - path_[i].place; }

  /// Largest x at a point by itself.
  double cap(std::size_t i) const {
    const DensePoint& p = path_[i];
    if (p.stops || i == 0 || i + 1 == path_.size()) return 0;
    double speed = p.speed_cap;
    for (std::size_t m = 0; m < p.d.size(); ++m)
      if (p.d[m] != 0) speed = std::min(speed, limits_.speed[m] / std::abs(p.d[m]));
    return speed * speed;
  }

  /// Path accelerations over the gap after point i that keep every motor's limit at both ends of it when it begins with x.
  Range control(std::size_t i, double x) const {
    Range range{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    const auto keep = [&](double factor, double rest, double limit) {  // |factor * u + rest| <= limit
      if (factor == 0) {
        if (std::abs(rest) > limit) range = {1, -1};
        return;
      }
      const double a = (-limit - rest) / factor, b = (limit - rest) / factor;
      range.low = std::max(range.low, std::min(a, b));
      range.high = std::min(range.high, std::max(a, b));
    };
    for (std::size_t m = 0; m < limits_.accel.size(); ++m) {
      keep(path_[i].d[m], path_[i].dd[m] * x, limits_.accel[m]);
      keep(path_[i + 1].d[m] + path_[i + 1].dd[m] * 2 * gap(i), path_[i + 1].dd[m] * x, limits_.accel[m]);
    }
    return range;
  }

  bool can_reach(std::size_t i, double x, double next_max) const {
    const Range u = control(i, x);
    const double low = std::max(u.low, -x / (2 * gap(i))), high = std::min(u.high, (next_max - x) / (2 * gap(i)));
    return low <= high;
  }

  double largest_start(std::size_t i, double next_max) const {
    double low = 0, high = cap(i);
    if (high == 0) return 0;
    if (gap(i) == 0) return std::min(high, next_max);
    if (can_reach(i, high, next_max)) return high;
    for (int k = 0; k < 60; ++k) {
      const double middle = (low + high) / 2;
      (can_reach(i, middle, next_max) ? low : high) = middle;
    }
    return low;
  }

  std::vector<DensePoint> path_;
  DenseLimits limits_;
};

}  // namespace pmac::reference
