#include "runtime/drives/silverlode/spline_fit.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "runtime/drives/silverlode/units.h"

namespace pmac::drives::silverlode {
namespace {

constexpr int kPointsPerPiece = 10;     // at which the motion is compared
constexpr int kMostRounds = 24;
constexpr double kProminent = 3;        // a step of the acceleration that is so many times the mean is a place to part

double even(double ticks) { return 2 * std::round(ticks / 2); }

/// Weights of the three control points k-1, k, k+1 of piece k (from 1) at a time of it.
std::array<double, 3> weights(const std::vector<double>& knots, std::size_t k, double ticks) {
  const std::size_t m = knots.size() - 1;
  const double a = knots[k >= 2 ? k - 2 : 0], b = knots[k - 1], c = knots[k], d = knots[std::min(k + 1, m)];
  const double first = (c - ticks) * (c - ticks) / ((c - a) * (c - b)), last = (ticks - b) * (ticks - b) / ((d - b) * (c - b));
  return {first, 1 - first - last, last};
}

double point_of(const std::vector<double>& knots, std::size_t k, int point) {
  return knots[k - 1] + (knots[k] - knots[k - 1]) * (point + 0.5) / kPointsPerPiece;
}

/// Symmetric positive band matrix of half width 2: Cholesky in place.
class Band {
 public:
  explicit Band(std::size_t size) : rows_(size, {0, 0, 0}) {}
  void add(std::size_t i, std::size_t j, double value) { rows_[i][i - j] += value; }   // j <= i <= j + 2

  void factor() {
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      for (std::size_t back = std::min<std::size_t>(i, 2); back >= 1; --back) {
        const std::size_t j = i - back;
        double sum = rows_[i][back];
        if (back == 1 && i >= 2) sum -= rows_[i][2] * rows_[j][1];
        rows_[i][back] = sum / rows_[j][0];
      }
      double diagonal = rows_[i][0];
      for (std::size_t back = 1; back <= std::min<std::size_t>(i, 2); ++back) diagonal -= rows_[i][back] * rows_[i][back];
      rows_[i][0] = std::sqrt(std::max(diagonal, 1e-300));
    }
  }

  void solve(std::vector<double>& x) const {
    for (std::size_t i = 0; i < x.size(); ++i) {
      for (std::size_t back = 1; back <= std::min<std::size_t>(i, 2); ++back) x[i] -= rows_[i][back] * x[i - back];
      x[i] /= rows_[i][0];
    }
    for (std::size_t i = x.size(); i-- > 0;) {
      for (std::size_t ahead = 1; ahead <= 2 && i + ahead < x.size(); ++ahead) x[i] -= rows_[i + ahead][ahead] * x[i + ahead];
      x[i] /= rows_[i][0];
    }
  }

 private:
  std::vector<std::array<double, 3>> rows_;     // [i][back]: element (i, i - back)
};

/// Control points [axis][0 .. m+1]; the first and last two stand at the ends, so that the motion begins and ends at rest.
using Controls = std::vector<std::vector<double>>;

Controls least_squares(const Commanded& motion, const std::vector<double>& knots) {
  const std::size_t m = knots.size() - 1, unknowns = m >= 2 ? m - 2 : 0;
  const double end_s = knots.back() * kTick_s;
  Controls controls(motion.axes(), std::vector<double>(m + 2, 0.0));
  for (std::size_t a = 0; a < motion.axes(); ++a) {
    controls[a][0] = controls[a][1] = motion.position(a, 0);
    controls[a][m] = controls[a][m + 1] = motion.position(a, end_s);
  }
  if (unknowns == 0) return controls;
  Band matrix(unknowns);
  std::vector<std::vector<double>> right(motion.axes(), std::vector<double>(unknowns, 0.0));
  const auto is_unknown = [m](std::size_t control) { return control >= 2 && control + 1 <= m; };
  for (std::size_t k = 1; k <= m; ++k)
    for (int point = 0; point < kPointsPerPiece; ++point) {
      const double ticks = point_of(knots, k, point);
      const auto w = weights(knots, k, ticks);
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j <= i; ++j)
          if (is_unknown(k - 1 + i) && is_unknown(k - 1 + j)) matrix.add(k - 3 + i, k - 3 + j, w[i] * w[j]);
      for (std::size_t a = 0; a < motion.axes(); ++a) {
        double rest = motion.position(a, ticks * kTick_s);
        for (std::size_t i = 0; i < 3; ++i)
          if (!is_unknown(k - 1 + i)) rest -= w[i] * controls[a][k - 1 + i];
        for (std::size_t i = 0; i < 3; ++i)
          if (is_unknown(k - 1 + i)) right[a][k - 3 + i] += w[i] * rest;
      }
    }
  matrix.factor();
  for (std::size_t a = 0; a < motion.axes(); ++a) {
    matrix.solve(right[a]);
    std::copy(right[a].begin(), right[a].end(), controls[a].begin() + 2);
  }
  return controls;
}

/// Largest distance from the motion in piece k.
double error_of(const Commanded& motion, const std::vector<double>& knots, const Controls& controls, std::size_t k) {
  double worst = 0;
  for (int point = 0; point < kPointsPerPiece; ++point) {
    const double ticks = point_of(knots, k, point);
    const auto w = weights(knots, k, ticks);
    double square = 0;
    for (std::size_t a = 0; a < motion.axes(); ++a) {
      const double off = w[0] * controls[a][k - 1] + w[1] * controls[a][k] + w[2] * controls[a][k + 1] - motion.position(a, ticks * kTick_s);
      square += off * off;
    }
    worst = std::max(worst, square);
  }
  return std::sqrt(worst);
}

/// Where to part a piece: at its largest step of the acceleration where that stands out, else in the middle.
double parting(const Commanded& motion, double from, double to, double least) {
  const double step = std::max(1.0, motion.period_s() / kTick_s);
  double largest = 0, at = 0, sum = 0;
  int count = 0;
  for (double ticks = from; ticks <= to; ticks += step, ++count) {
    const double jump = motion.acceleration_step(ticks * kTick_s);
    sum += jump;
    if (jump > largest) largest = jump, at = ticks;
  }
  const double low = from + least, high = to - least;
  const bool stands_out = count > 8 && largest > kProminent * sum / count;
  return std::clamp(even(stands_out ? at : (from + to) / 2), low, high);
}

/// Evenly spaced knots from 0 to the end of the motion, at least two lengths.
std::vector<double> first_knots(const Commanded& motion, const FitSetup& setup) {
  const double total = std::max(2 * std::ceil(motion.duration_s() / kTick_s / 2), 2 * setup.least_ticks);
  const double pieces = std::max(2.0, std::floor(total / std::max(setup.first_ticks, setup.least_ticks)));
  std::vector<double> knots{0};
  for (double k = 1; k < pieces; ++k) knots.push_back(even(total * k / pieces));
  knots.push_back(total);
  return knots;
}

}  // namespace

SplineFit fit_spline(const Commanded& motion, const FitSetup& setup) {
  std::vector<double> knots = first_knots(motion, setup);
  Controls controls;
  SplineFit fit;
  for (int round = 0; round < kMostRounds; ++round) {
    controls = least_squares(motion, knots);
    std::vector<double> finer{0};
    fit.error_counts = 0;
    for (std::size_t k = 1; k < knots.size(); ++k) {
      const double error = error_of(motion, knots, controls, k);
      fit.error_counts = std::max(fit.error_counts, error);
      if (error > setup.tolerance_counts && knots[k] - knots[k - 1] >= 2 * setup.least_ticks)
        finer.push_back(parting(motion, knots[k - 1], knots[k], setup.least_ticks));
      finer.push_back(knots[k]);
    }
    if (finer.size() == knots.size() || round + 1 == kMostRounds) break;
    knots = std::move(finer);
  }
  fit.ramp_ticks.assign(1, 0.0);
  for (std::size_t k = 1; k < knots.size(); ++k) fit.ramp_ticks.push_back(knots[k] - knots[k - 1]);
  for (const auto& axis : controls) fit.corner_counts.emplace_back(axis.begin() + 1, axis.end() - 1);
  return fit;
}

}  // namespace pmac::drives::silverlode
