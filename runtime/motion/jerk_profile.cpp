#include "runtime/motion/jerk_profile.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace pmac::motion {
namespace {

constexpr int kMostSteps = 60;
constexpr double kNearGap = 0.02;      // of the time: after many steps the profile is near enough to the fastest
constexpr double kFirstMu = 0.1;
constexpr double kUnmet = 1e-4;        // of a limit
constexpr double kLeastCentering = 0.1;
constexpr double kToBoundary = 0.95;   // of the way to the nearest condition in one step
constexpr double kSmallest = 0.1;      // c shrinks to no less of it in one step

double root(double x) { return std::sqrt(std::max(x, 0.0)); }

}  // namespace

void ProfileProblem::clear() {
  length_mu.clear();
  steps_at_start.clear();
  first_row.assign(1, 0);
  rows.clear();
  max_speed2.clear();
  middle_speed2.clear();
  guess_speed2.clear();
  start_speed2 = start_slope = 0;
}

/// Time from the mean speed m and the accelerations: length = m t + (a0 - a1) t^2 / 12.
CellMotion motion_through(double length_mu, double x0, double y0, double x1, double y1) {
  const double v0 = root(x0), v1 = root(x1), a0 = y0 / 2, a1 = y1 / 2, mean = (v0 + v1) / 2, bend = (a0 - a1) / 12;
  CellMotion motion;
  const double t = 2 * length_mu / (mean + root(mean * mean + 4 * bend * length_mu));
  motion.duration_ms = t;
  motion.speed = v0;
  motion.accel = a0;
  motion.jerk = (6 * (v1 - v0) / t - 4 * a0 - 2 * a1) / t;
  motion.snap = ((a1 - a0) / t - motion.jerk) * 2 / t;
  return motion;
}

ProfileUse use_of(const ProfileProblem& problem, const Profile& profile) {
  ProfileUse use;
  for (std::size_t i = 0; i < problem.cells(); ++i) {
    const double x0 = profile.speed2[i], y0 = profile.slope[i], x1 = profile.speed2[i + 1], y1 = profile.slope[i + 1];
    const CellMotion motion = motion_through(problem.length_mu[i], x0, y0, x1, y1);
    const double uneven = std::abs(motion.snap) * motion.duration_ms / 2;
    if (i + 1 < problem.cells()) use.speed2 = std::max(use.speed2, x1 / problem.max_speed2[i + 1]);
    for (std::size_t k = problem.first_row[i]; k < problem.first_row[i + 1]; ++k) {
      const ProfileRow& row = problem.rows[k];
      const double start = row.start_curvature * x0 + row.start_tangent * y0 / 2, end = row.end_curvature * x1 + row.end_tangent * y1 / 2;
      use.accel = std::max(use.accel, row.inv_accel * std::max(i > 0 ? std::abs(start) : 0.0, std::abs(end)));
      const double even = (y1 - y0) / (2 * motion.duration_ms), v0 = root(x0), v1 = root(x1);
      const double jerk0 = row.start_tangent * even + 1.5 * row.start_curvature * v0 * y0 + row.curvature_rate * v0 * x0;
      const double jerk1 = row.end_tangent * even + 1.5 * row.end_curvature * v1 * y1 + row.curvature_rate * v1 * x1;
      use.jerk = std::max(use.jerk, row.inv_jerk * (std::max(std::abs(jerk0), std::abs(jerk1)) + uneven * std::abs(row.start_tangent)));
    }
  }
  return use;
}

bool ProfileSolver::solve(const ProfileProblem& problem, double gap, Profile& profile) {
  problem_ = &problem;
  cells_ = problem.cells();
  start();
  take_weights();
  take_nodes();
  take_times();
  mu_ = kFirstMu * total_ms() / static_cast<double>(cells_);
  each_condition([&](std::size_t n, std::size_t, const std::array<double, 3>&, double value) {
    slack_[n] = std::max(-value, 0.1);
    price_[n] = mu_ / slack_[n];
  });
  return go_on(gap, profile);
}

bool ProfileSolver::go_on(double gap, Profile& profile) {
  bool found = false, near = false;
  for (int step = 0; step < kMostSteps; ++step) {
    take_weights();
    take_nodes();
    take_times();
    const double total = total_ms(), count = static_cast<double>(count_);
    assemble(mu_);
    near = gap_ <= kNearGap * total && unmet_ <= kUnmet;
    found = gap_ <= gap * total && unmet_ <= kUnmet && step > 2;
    if (found) break;
    if (!factor_and_solve()) return false;
    const double part = move(mu_), mean = std::inner_product(slack_.begin(), slack_.end(), price_.begin(), 0.0) / count;
    mu_ = std::max(std::max((1 - part) * (1 - part), kLeastCentering) * mean, 0.1 * gap * total / count);
  }
  profile.speed2 = x_;
  profile.slope = y_;
  return found || near;
}

double ProfileSolver::total_ms() const { return std::accumulate(time_ms_.begin(), time_ms_.end(), 0.0); }

void ProfileSolver::start() {
  const ProfileProblem& p = *problem_;
  for (auto* each : {&c_, &change_, &d0_, &d1_, &d2_, &r_}) each->assign(cells_ + 4, 0);
  for (auto* each : {&weight_, &time_ms_, &middle_x_, &speed_start_, &speed_end_}) each->assign(cells_, 0);
  for (auto* each : {&x_, &y_, &before_, &after_, &per_slope_}) each->assign(cells_ + 1, 0);
  x_.front() = p.start_speed2;
  for (std::size_t i = 1; i < cells_; ++i) x_[i] = p.guess_speed2[i];
  for (std::size_t i = 1; i + 1 < cells_; ++i) c_[i + 1] = (x_[i] + x_[i + 1]) / 2;
  y_.front() = p.start_slope;
  const double guess_slope0 = p.start_speed2 > 0 ? p.start_slope : 0;
  for (std::size_t i = 1; i < cells_; ++i) y_[i] = (x_[i + 1] - x_[i - 1]) / (p.length_mu[i] + p.length_mu[i - 1]);
  y_.front() = guess_slope0;
  count_ = 0;
  each_condition([&](std::size_t n, std::size_t, const std::array<double, 3>&, double) { count_ = n + 1; });
  for (auto* each : {&slack_, &price_, &slack_step_, &price_step_}) each->assign(count_, 0);
}

/// So that the acceleration changes evenly over time between the speeds as they are now.
void ProfileSolver::take_weights() {
  const auto& p = *problem_;
  for (std::size_t i = 0; i < cells_; ++i) {
    const bool from_rest = i == 0 && p.start_speed2 == 0, to_rest = i + 1 == cells_;
    const CellMotion m = motion_through(p.length_mu[i], x_[i], y_[i], x_[i + 1], y_[i + 1]);
    const double v0 = root(x_[i]), v1 = root(x_[i + 1]), mean = (v0 + v1) / 2, a0 = y_[i] / 2, a1 = y_[i + 1] / 2;
    const double bend = std::clamp((a0 - a1) * m.duration_ms / (12 * mean), -1.0 / 3, 1.0 / 3);
    const double off = std::clamp((v1 - v0) / (12 * mean * (1 + bend)), -0.24, 0.24);
    weight_[i] = from_rest ? 0.75 : to_rest ? 0.25 : 0.5 + off;
  }
  if (p.start_speed2 > 0) c_[1] = p.start_speed2 + p.length_mu[0] * (1 - weight_[0]) * p.start_slope;
}

void ProfileSolver::take_nodes() {
  for (std::size_t i = 1; i < cells_; ++i) {
    const double e = problem_->length_mu[i - 1] * weight_[i - 1], f = problem_->length_mu[i] * (1 - weight_[i]);
    per_slope_[i] = 1 / (e + f);
    before_[i] = f * per_slope_[i];
    after_[i] = e * per_slope_[i];
    x_[i] = before_[i] * c_[i] + after_[i] * c_[i + 1];
    y_[i] = (c_[i + 1] - c_[i]) * per_slope_[i];
  }
}

void ProfileSolver::take_times() {
  for (std::size_t i = 0; i < cells_; ++i) {
    time_ms_[i] = motion_through(problem_->length_mu[i], x_[i], y_[i], x_[i + 1], y_[i + 1]).duration_ms;
    middle_x_[i] = (x_[i] + x_[i + 1]) / 2;
    speed_start_[i] = root(x_[i]) * time_ms_[i];
    speed_end_[i] = root(x_[i + 1]) * time_ms_[i];
  }
}

/// visit(number, first, factors of three c from first on (shifted), value), value <= 0 where it is met.
template <class Visit> void ProfileSolver::each_condition(Visit visit) {
  const ProfileProblem& p = *problem_;
  std::size_t n = 0;
  const auto free = [&](std::size_t shifted) { return shifted >= 2 && shifted + 1 <= cells_ ? 1.0 : 0.0; };
  for (std::size_t i = 0; i < cells_; ++i) {
    const bool inner_start = i > 0, inner_end = i + 1 < cells_;
    const double f0 = free(i), f1 = free(i + 1), f2 = free(i + 2);
    const double b0 = inner_start ? before_[i] : 0, a0 = inner_start ? after_[i] : 0, g0 = inner_start ? per_slope_[i] / 2 : 0;
    const double b1 = inner_end ? before_[i + 1] : 0, a1 = inner_end ? after_[i + 1] : 0, g1 = inner_end ? per_slope_[i + 1] / 2 : 0;
    if (inner_end) {
      const double inv = 1 / p.max_speed2[i + 1];
      visit(n++, i, std::array<double, 3>{0, b1 * inv * f1, a1 * inv * f2}, x_[i + 1] * inv - 1);
    }
    if (inner_start && inner_end) {   // and half-way, where x is (x_start + 2 c + x_end) / 4
      const double inv = 0.25 / p.middle_speed2[i];
      visit(n++, i, std::array<double, 3>{b0 * inv * f0, (a0 + 2 + b1) * inv * f1, a1 * inv * f2}, (x_[i] + 2 * c_[i + 1] + x_[i + 1]) * inv - 1);
    }
    const double inv_time = time_ms_[i] > 0 ? 1 / time_ms_[i] : 0, inv_middle = middle_x_[i] > 0 ? 0.25 / middle_x_[i] : 0;
    const double s0 = b0 * inv_middle, s1 = (a0 + b1) * inv_middle, s2 = a1 * inv_middle;
    for (std::size_t k = p.first_row[i]; k < p.first_row[i + 1]; ++k) {
      const ProfileRow& r = p.rows[k];
      const double start0 = r.start_curvature * b0 - r.start_tangent * g0, start1 = r.start_curvature * a0 + r.start_tangent * g0;
      const double end1 = r.end_curvature * b1 - r.end_tangent * g1, end2 = r.end_curvature * a1 + r.end_tangent * g1;
      const double start = r.start_curvature * x_[i] + r.start_tangent * y_[i] / 2, end = r.end_curvature * x_[i + 1] + r.end_tangent * y_[i + 1] / 2;
      if (r.inv_accel > 0 && inner_end) {
        const double u1 = end1 * r.inv_accel * f1, u2 = end2 * r.inv_accel * f2, value = end * r.inv_accel;
        visit(n++, i, std::array<double, 3>{0, u1, u2}, value - 1);
        visit(n++, i, std::array<double, 3>{0, -u1, -u2}, -value - 1);
      }
      if (r.inv_accel > 0 && inner_start && p.steps_at_start[i]) {
        const double u0 = start0 * r.inv_accel * f0, u1 = start1 * r.inv_accel * f1, value = start * r.inv_accel;
        visit(n++, i, std::array<double, 3>{u0, u1, 0}, value - 1);
        visit(n++, i, std::array<double, 3>{-u0, -u1, 0}, -value - 1);
      }
      if (r.inv_accel > 0 && inner_start && inner_end && !r.is_straight) {   // half-way
        const double t = r.middle_tangent * r.inv_accel, k4 = (r.start_curvature + r.end_curvature) / 8 * r.inv_accel;
        const double u0 = (k4 * b0 - t * g0 / 2) * f0, u1 = (k4 * (a0 + 2 + b1) + t * (g0 - g1) / 2) * f1, u2 = (k4 * a1 + t * g1 / 2) * f2;
        const double value = k4 * (x_[i] + 2 * c_[i + 1] + x_[i + 1]) + t * (y_[i] + y_[i + 1]) / 4;
        visit(n++, i, std::array<double, 3>{u0, u1, u2}, value - 1);
        visit(n++, i, std::array<double, 3>{-u0, -u1, -u2}, -value - 1);
      }
      if (r.inv_jerk <= 0) continue;
      const double scale = r.inv_jerk * inv_time;
      const auto jerk = [&](double u0, double u1, double u2, double value) {
        visit(n++, i, std::array<double, 3>{(s0 + u0 * scale) * f0, (s1 + u1 * scale) * f1, (s2 + u2 * scale) * f2}, value * scale - 1);
        visit(n++, i, std::array<double, 3>{(s0 - u0 * scale) * f0, (s1 - u1 * scale) * f1, (s2 - u2 * scale) * f2}, -value * scale - 1);
      };
      if (r.is_straight) {
        jerk(-start0, end1 - start1, end2, end - start);
        continue;
      }
      const double rise = (y_[i + 1] - y_[i]) / 2;   // acceleration along the path, over the cell
      const double j0 = speed_start_[i] * r.curvature_rate, k0 = speed_start_[i] * r.start_curvature * 3, t0 = r.start_tangent;
      jerk(j0 * b0 + (t0 - k0) * g0, j0 * a0 - (t0 - k0) * g0 - t0 * g1, t0 * g1, t0 * rise + j0 * x_[i] + k0 * y_[i] / 2);
      const double j1 = speed_end_[i] * r.curvature_rate, k1 = speed_end_[i] * r.end_curvature * 3, t1 = r.end_tangent;
      jerk(t1 * g0, j1 * b1 - (t1 + k1) * g1 - t1 * g0, j1 * a1 + (t1 + k1) * g1, t1 * rise + j1 * x_[i + 1] + k1 * y_[i + 1] / 2);
    }
  }
}

/// The Newton system in the changes of c; the conditions are in by (mu + price * residual) / slack.
void ProfileSolver::assemble(double mu) {
  for (auto* each : {&d0_, &d1_, &d2_, &r_}) std::fill(each->begin(), each->end(), 0.0);
  gap_ = unmet_ = 0;
  each_condition([&](std::size_t n, std::size_t first, const std::array<double, 3>& g, double value) {
    const double residual = value + slack_[n], inv = 1 / slack_[n], stiff = price_[n] * inv, push = (mu + price_[n] * residual) * inv;
    gap_ += price_[n] * slack_[n];
    unmet_ = std::max(unmet_, value);
    const double g0 = g[0] * stiff, g1 = g[1] * stiff, g2 = g[2] * stiff;
    d0_[first] += g0 * g[0];
    d0_[first + 1] += g1 * g[1];
    d0_[first + 2] += g2 * g[2];
    d1_[first] += g0 * g[1];
    d1_[first + 1] += g1 * g[2];
    d2_[first] += g0 * g[2];
    r_[first] -= g[0] * push;
    r_[first + 1] -= g[1] * push;
    r_[first + 2] -= g[2] * push;
  });
  for (std::size_t i = 1; i + 1 < cells_; ++i) {
    const double c = c_[i + 1], inv = problem_->length_mu[i] / (c * std::sqrt(c));
    d0_[i + 1] += 0.75 * inv / c;
    r_[i + 1] += 0.5 * inv;
  }
}

/// L D L^T of the pentadiagonal matrix, over c_[2] to c_[cells - 1].
bool ProfileSolver::factor_and_solve() {
  const std::size_t first = 2, last = cells_;   // [first, last)
  for (std::size_t i = first; i < last; ++i) {
    if (!(d0_[i] > 0)) return false;
    const double l1 = d1_[i] / d0_[i], l2 = d2_[i] / d0_[i];
    if (i + 1 < last) {
      d0_[i + 1] -= l1 * d1_[i];
      d1_[i + 1] -= l1 * d2_[i];
      r_[i + 1] -= l1 * r_[i];
    }
    if (i + 2 < last) {
      d0_[i + 2] -= l2 * d2_[i];
      r_[i + 2] -= l2 * r_[i];
    }
    d1_[i] = l1;
    d2_[i] = l2;
  }
  for (std::size_t i = last; i-- > first;) {
    change_[i] = r_[i] / d0_[i];
    if (i + 1 < last) change_[i] -= d1_[i] * change_[i + 1];
    if (i + 2 < last) change_[i] -= d2_[i] * change_[i + 2];
    if (!std::isfinite(change_[i])) return false;
  }
  return true;
}

/// As far as all slacks, prices and c stay above zero. The smaller part of the step that was gone.
double ProfileSolver::move(double mu) {
  double slack_part = 1, price_part = 1;
  each_condition([&](std::size_t n, std::size_t first, const std::array<double, 3>& g, double value) {
    const double along = g[0] * change_[first] + g[1] * change_[first + 1] + g[2] * change_[first + 2];
    const double slack = slack_[n], price = price_[n], residual = value + slack;
    const double slack_step = -residual - along, price_step = (mu + price * (residual + along)) / slack - price;
    if (slack_step * slack_part < -kToBoundary * slack) slack_part = -kToBoundary * slack / slack_step;
    if (price_step * price_part < -kToBoundary * price) price_part = -kToBoundary * price / price_step;
    slack_step_[n] = slack_step;
    price_step_[n] = price_step;
  });
  for (std::size_t i = 2; i < cells_; ++i)
    if (change_[i] < 0) slack_part = std::min(slack_part, (1 - kSmallest) * c_[i] / -change_[i]);
  for (std::size_t i = 2; i < cells_; ++i) c_[i] += slack_part * change_[i];
  for (std::size_t n = 0; n < count_; ++n) {
    slack_[n] += slack_part * slack_step_[n];
    price_[n] += price_part * price_step_[n];
  }
  return std::min(slack_part, price_part);
}

}  // namespace pmac::motion
