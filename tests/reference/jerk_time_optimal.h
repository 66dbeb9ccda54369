// Slow and plain: about the shortest time in which a path is run through from rest to rest when every motor has limits of speed, acceleration
// and jerk, and the program is a limit of the rate. Unknown are the places on the path at even times; the first, second and third differences
// of the motors' positions keep the limits. A difference is a mean of the derivative, so every motion that keeps the limits keeps these, and
// with more places the shortest time goes up to that of the true optimum:
//
//   excess in a time      the least s with  |difference| <= (1 + s) limit  for all, by Newton's method with a logarithmic barrier
//   shortest time         the least with an excess of 0, by shorter and shorter steps down, each from the places of the motion found so far
//
// Independent of the runtime: over time, not over length, of the curve itself, without cells. Boyd and Vandenberghe, "Convex Optimization", 11.4.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

namespace pmac::reference {

struct JerkLimits { double speed_mu_ms, accel_mu_ms2, jerk_mu_ms3; };

/// Positions of the motors over a parameter that the motion passes at a rate of at most 1 a ms, from 0 to end; their derivatives are never all 0.
struct ParameterPath {
  double end = 0;
  std::function<void(double parameter, double* position_mu, double* derivative_mu)> at;
};

class JerkTimeOptimal {
 public:
  JerkTimeOptimal(ParameterPath path, std::vector<JerkLimits> limits, int steps) : path_(std::move(path)), limits_(std::move(limits)), steps_(steps) {}

  /// ms. slow_ms: a time in which it can be done with ease.
  double solve(double slow_ms) {
    place_.assign(points(), 0);
    for (int k = 0; k <= steps_; ++k) place_[at(k)] = path_.end * smooth(static_cast<double>(k) / steps_);
    hold_ends();
    double time_ms = slow_ms, faster = 0.8;
    while (!reaches(time_ms)) time_ms *= 1.5;
    while (faster < 1 - kTime) {
      const std::vector<double> best = place_;
      if (reaches(faster * time_ms)) {
        time_ms *= faster;
        continue;
      }
      place_ = best;
      faster = std::sqrt(faster);
    }
    return time_ms;
  }

 private:
  static constexpr double kTime = 5e-4, kExcess = 5e-4;
  static constexpr int kMostSteps = 300;
  static constexpr std::size_t kBand = 4;
  static constexpr int kGhosts = 3;   // places before the start and behind the end, at rest

  std::size_t points() const { return static_cast<std::size_t>(steps_ + 1 + 2 * kGhosts); }
  static std::size_t at(int k) { return static_cast<std::size_t>(k + kGhosts); }
  static double smooth(double u) { return u * u * u * (10 + u * (6 * u - 15)); }
  void hold_ends() {
    for (int k = 0; k <= kGhosts; ++k) {
      place_[at(-k)] = 0;
      place_[at(steps_ + k)] = path_.end;
    }
  }
  bool is_free(int k) const { return k > 0 && k < steps_; }

  struct Difference { int first; std::array<double, 4> factor; int motor; double limit; };   // motor -1: of the parameter

  void take_differences(double step_ms) {
    differences_.clear();
    for (int k = -2; k < steps_ + 1; ++k) {
      differences_.push_back({k, {-1, 1, 0, 0}, -1, step_ms});
      for (int m = 0; m < static_cast<int>(limits_.size()); ++m) {
        const JerkLimits& l = limits_[static_cast<std::size_t>(m)];
        differences_.push_back({k, {-1, 1, 0, 0}, m, step_ms * l.speed_mu_ms});
        differences_.push_back({k, {1, -2, 1, 0}, m, step_ms * step_ms * l.accel_mu_ms2});
        differences_.push_back({k, {-1, 3, -3, 1}, m, step_ms * step_ms * step_ms * l.jerk_mu_ms3});
      }
    }
  }

  void take_values() {
    const std::size_t motors = limits_.size();
    q_.resize(points() * motors);
    dq_.resize(points() * motors);
    for (std::size_t i = 0; i < points(); ++i) path_.at(place_[i], &q_[i * motors], &dq_[i * motors]);
    value_.resize(differences_.size());
    for (std::size_t n = 0; n < differences_.size(); ++n) {
      const Difference& d = differences_[n];
      double sum = 0;
      for (int j = 0; j < 4; ++j) sum += d.factor[static_cast<std::size_t>(j)] * (d.motor < 0 ? place_[at(d.first + j)] : q_[at(d.first + j) * motors + static_cast<std::size_t>(d.motor)]);
      value_[n] = sum / d.limit;
    }
  }

  /// The barrier function; infinity where a condition is broken.
  double cost(double weight, double excess) const {
    double sum = weight * excess;
    for (std::size_t n = 0; n < differences_.size(); ++n) {
      const double above = 1 + excess - value_[n], below = 1 + excess + value_[n];
      if (above <= 0 || below <= 0) return HUGE_VAL;
      sum -= std::log(above) + std::log(below);
    }
    return sum;
  }

  bool reaches(double time_ms) {
    take_differences(time_ms / steps_);
    take_values();
    double excess = 0.1;
    for (const double v : value_) excess = std::max(excess, 1.1 * std::abs(v) - 1 + 0.1);
    const double count = 2.0 * static_cast<double>(differences_.size());
    double weight = count / std::max(excess, 0.1);
    for (int i = 0; i < kMostSteps; ++i) {
      if (excess <= kExcess) return true;
      const double gained = newton_step(weight, excess);
      if (gained > 0.05) continue;                          // not yet in the middle of what this weight allows
      if (excess - 1.5 * count / weight > kExcess) return false;
      if (weight > 1e4 * count) return false;
      weight *= 4;
    }
    return false;
  }

  /// One step; what the barrier function has lost.
  double newton_step(double weight, double& excess) {
    assemble(weight, excess);
    const std::vector<double> change = solve_band(slope_), side = solve_band(mixed_);
    double corner = corner_, right = excess_slope_;
    for (std::size_t i = 0; i < points(); ++i) {
      corner -= mixed_[i] * side[i];
      right -= mixed_[i] * change[i];
    }
    const double excess_change = -right / std::max(corner, 1e-300), before = cost(weight, excess);
    const std::vector<double> from = place_;
    const double from_excess = excess;
    for (double part = 1; part > 1e-7; part /= 2) {
      for (std::size_t i = 0; i < points(); ++i) place_[i] = from[i] - part * (change[i] + side[i] * excess_change);
      hold_ends();
      excess = from_excess + part * excess_change;
      take_values();
      if (const double now = cost(weight, excess); now < before) return before - now;
    }
    place_ = from;
    excess = from_excess;
    take_values();
    return 0;
  }

  /// Slopes and second derivatives of the barrier function, those of the path itself left out.
  void assemble(double weight, double excess) {
    band_.assign(points() * kBand, 0);
    slope_.assign(points(), 0);
    mixed_.assign(points(), 0);
    excess_slope_ = weight;
    corner_ = 0;
    const std::size_t motors = limits_.size();
    for (std::size_t n = 0; n < differences_.size(); ++n) {
      const Difference& d = differences_[n];
      const double above = 1 / (1 + excess - value_[n]), below = 1 / (1 + excess + value_[n]), bend = above * above + below * below;
      std::array<double, 4> g{};
      for (int j = 0; j < 4; ++j) {
        const double derivative = d.motor < 0 ? 1 : dq_[at(d.first + j) * motors + static_cast<std::size_t>(d.motor)];
        g[static_cast<std::size_t>(j)] = is_free(d.first + j) ? d.factor[static_cast<std::size_t>(j)] * derivative / d.limit : 0;
      }
      excess_slope_ -= above + below;
      corner_ += bend;
      for (std::size_t j = 0; j < 4; ++j) {
        const std::size_t i = at(d.first) + j;
        slope_[i] += g[j] * (above - below);
        mixed_[i] += g[j] * (below * below - above * above);
        for (std::size_t k = 0; j + k < 4; ++k) band_[i * kBand + k] += g[j] * g[j + k] * bend;
      }
    }
    factor_band();
  }

  /// L D L^T in place.
  void factor_band() {
    for (std::size_t i = 0; i < points(); ++i) {
      if (!is_free(static_cast<int>(i) - kGhosts)) band_[i * kBand] = 1;
      const double pivot = band_[i * kBand];
      for (std::size_t j = 1; j < kBand && i + j < points(); ++j) {
        const double l = band_[i * kBand + j] / pivot;
        for (std::size_t n = j; n < kBand; ++n) band_[(i + j) * kBand + n - j] -= l * band_[i * kBand + n];
      }
      for (std::size_t j = 1; j < kBand; ++j) band_[i * kBand + j] /= pivot;
    }
  }
  std::vector<double> solve_band(std::vector<double> r) const {
    for (std::size_t i = 0; i < points(); ++i)
      for (std::size_t j = 1; j < kBand && i + j < points(); ++j) r[i + j] -= band_[i * kBand + j] * r[i];
    for (std::size_t i = points(); i-- > 0;) {
      r[i] /= band_[i * kBand];
      for (std::size_t j = 1; j < kBand && i + j < points(); ++j) r[i] -= band_[i * kBand + j] * r[i + j];
    }
    return r;
  }

  ParameterPath path_;
  std::vector<JerkLimits> limits_;
  int steps_;
  std::vector<Difference> differences_;
  std::vector<double> place_, q_, dq_, value_;   // [place], [place][motor], [difference]
  std::vector<double> band_, slope_, mixed_;
  double excess_slope_ = 0, corner_ = 0;
};

}  // namespace pmac::reference
