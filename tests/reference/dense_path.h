// The path that a program asks for (hop 6) as closely spaced points for the dense solver: every piece is evaluated at many times,
// velocities and accelerations become derivatives with respect to path length.
#pragma once

#include <functional>

#include "runtime/motion/path.h"
#include "tests/reference/dense_time_optimal.h"

namespace pmac::reference {

/// A linear map of axes to motors: row-major [motor][axis].
struct LinearMap {
  std::size_t motors = 0;
  std::vector<double> matrix_mu_uu;
  std::vector<double> operator()(const motion::AxisVector& axis) const {
    std::vector<double> motor(motors);
    for (std::size_t m = 0; m < motors; ++m)
      for (std::size_t a = 0; a < axis.size(); ++a) motor[m] += matrix_mu_uu[m * axis.size() + a] * axis[a];
    return motor;
  }
};

class DensePath {
 public:
  /// weight: [motor], makes motors of different units comparable (path length is over weighted motor positions).
  DensePath(LinearMap map, std::vector<double> weight, int points_per_piece) : map_(std::move(map)), weight_(std::move(weight)), count_(points_per_piece) {}

  void add(const motion::PathPiece& piece) {
    const motion::PathPoint start = evaluate(piece, 0);
    const std::vector<double> velocity = map_(start.velocity);
    const bool new_sequence = piece.starts_at_rest && !points_.empty();
    if (points_.empty() || new_sequence || steps_in_direction(velocity)) mark(start, piece);
    for (int k = 0; k < count_; ++k) sample(piece, piece.duration_ms * (k + 0.5) / count_, piece.duration_ms / count_);
    const motion::PathPoint end = evaluate(piece, piece.duration_ms);
    last_velocity_ = map_(end.velocity);
    end_place_ = points_.back().place + distance(map_(end.position), last_position_);
  }

  std::vector<DensePoint> finish() {
    if (points_.empty()) return {};
    DensePoint end = points_.back();
    end.place = end_place_;
    end.stops = true;
    end.wait_ms = 0;
    points_.push_back(end);
    return std::move(points_);
  }

 private:
  double norm(const std::vector<double>& v) const {
    double sum = 0;
    for (std::size_t m = 0; m < v.size(); ++m) sum += v[m] * v[m] * weight_[m] * weight_[m];
    return std::sqrt(sum);
  }
  double distance(std::vector<double> a, const std::vector<double>& b) const {
    for (std::size_t m = 0; m < a.size(); ++m) a[m] -= b[m];
    return norm(a);
  }

  bool steps_in_direction(const std::vector<double>& velocity) const {
    const double before = norm(last_velocity_), after = norm(velocity);
    if (before == 0 || after == 0) return false;
    std::vector<double> turn(velocity.size());
    for (std::size_t m = 0; m < velocity.size(); ++m) turn[m] = velocity[m] / after - last_velocity_[m] / before;
    return norm(turn) > 1e-6;
  }

  /// A place of rest at the start of a piece.
  void mark(const motion::PathPoint& at, const motion::PathPiece& piece) {
    DensePoint point;
    place_of(map_(at.position), point);
    fill(map_(evaluate(piece, piece.duration_ms * 1e-3).velocity), std::vector<double>(map_.motors), point);
    point.stops = true;
    points_.push_back(point);
    last_position_ = map_(at.position);
  }

  void sample(const motion::PathPiece& piece, double time_ms, double step_ms) {
    const motion::PathPoint at = evaluate(piece, time_ms);
    const std::vector<double> velocity = map_(at.velocity);
    if (norm(velocity) == 0) {
      if (!points_.empty()) points_.back().wait_ms += step_ms, points_.back().stops = true;
      return;
    }
    DensePoint point;
    place_of(map_(at.position), point);
    fill(velocity, map_(at.acceleration), point);
    points_.push_back(point);
    last_position_ = map_(at.position);
  }

  void place_of(const std::vector<double>& position, DensePoint& point) {
    point.place = points_.empty() ? 0 : points_.back().place + distance(position, last_position_);
  }

  void fill(const std::vector<double>& velocity, const std::vector<double>& acceleration, DensePoint& point) const {
    const double speed = norm(velocity);
    point.speed_cap = speed;
    point.d.resize(velocity.size());
    point.dd.resize(velocity.size());
    double along = 0;
    for (std::size_t m = 0; m < velocity.size(); ++m) {
      point.d[m] = speed == 0 ? 0 : velocity[m] / speed;
      along += acceleration[m] * point.d[m] * weight_[m] * weight_[m];
    }
    for (std::size_t m = 0; m < velocity.size(); ++m) point.dd[m] = speed == 0 ? 0 : (acceleration[m] - along * point.d[m]) / (speed * speed);
  }

  LinearMap map_;
  std::vector<double> weight_;
  int count_;
  std::vector<DensePoint> points_;
  std::vector<double> last_position_, last_velocity_;
  double end_place_ = 0;
};

}  // namespace pmac::reference
