#include "runtime/drives/silverlode/commanded.h"

#include <algorithm>
#include <cmath>

namespace pmac::drives::silverlode {
namespace {

constexpr double kStill = 1e-9;      // counts

}  // namespace

Commanded::Commanded(const Commanded& other, std::vector<std::vector<double>> counts)
    : motors_(other.motors_), counts_(std::move(counts)), rows_(counts_.empty() ? 0 : counts_[0].size()), period_s_(other.period_s_), start_s_(other.start_s_) {}

/// A motor that is seen for the first time has not moved before.
void Commanded::take(const runtime::SampleBlock& block) {
  period_s_ = block.period_ms / 1000;
  for (std::size_t m = 0; m < block.motors.size(); ++m) {
    auto at = std::find(motors_.begin(), motors_.end(), block.motors[m]);
    if (at == motors_.end()) {
      const double first = block.count > 0 ? block.at(static_cast<int>(m), 0) + block.home_mu[m] : 0;
      motors_.push_back(block.motors[m]);
      counts_.emplace_back(rows_, first);
      at = motors_.end() - 1;
    }
    std::vector<double>& column = counts_[static_cast<std::size_t>(at - motors_.begin())];
    for (int k = 0; k < block.count; ++k) column.push_back(block.at(static_cast<int>(m), k) + block.home_mu[m]);
  }
  rows_ += static_cast<std::size_t>(block.count);
  for (std::vector<double>& column : counts_) column.resize(rows_, column.empty() ? 0.0 : column.back());
}

void Commanded::finish(std::span<const double> counts_per_mu) {
  std::vector<std::size_t> order;
  std::size_t first = rows_, last = 0;
  for (std::size_t a = 0; a < counts_.size(); ++a) {
    std::vector<double>& column = counts_[a];
    const double scale = counts_per_mu[std::min(static_cast<std::size_t>(a), counts_per_mu.size() - 1)];
    for (double& value : column) value *= scale;
    const auto moved = [&column](std::size_t row) { return std::abs(column[row] - column[row - 1]) > kStill; };
    bool moves = false;
    for (std::size_t row = 1; row < rows_; ++row)
      if (moved(row)) {
        first = std::min(first, row - 1);
        last = std::max(last, row);
        moves = true;
      }
    if (moves) order.push_back(a);
  }
  std::sort(order.begin(), order.end(), [this](std::size_t a, std::size_t b) { return motors_[a] < motors_[b]; });
  std::vector<int> motors;
  std::vector<std::vector<double>> counts;
  for (const std::size_t a : order) {
    motors.push_back(motors_[a]);
    counts.emplace_back(counts_[a].begin() + static_cast<std::ptrdiff_t>(first), counts_[a].begin() + static_cast<std::ptrdiff_t>(last) + 1);
  }
  motors_ = std::move(motors);
  counts_ = std::move(counts);
  rows_ = counts_.empty() ? 0 : last - first + 1;
  start_s_ = period_s_ * static_cast<double>(first);
}

double Commanded::furthest(std::size_t axis) const {
  double furthest = 0;
  for (const double value : counts_[axis]) furthest = std::max(furthest, std::abs(value));
  return furthest;
}

double Commanded::sample(std::size_t axis, std::ptrdiff_t row) const {
  return counts_[axis][static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(row, 0, static_cast<std::ptrdiff_t>(rows_) - 1))];
}

/// Cubic through the two samples around the time, with the slopes of their neighbours.
double Commanded::position(std::size_t axis, double time_s) const {
  const double at = std::clamp(time_s / period_s_, -1.0, static_cast<double>(rows_));
  const double row = std::floor(at), u = at - row;
  const std::ptrdiff_t i = static_cast<std::ptrdiff_t>(row);
  const double p0 = sample(axis, i - 1), p1 = sample(axis, i), p2 = sample(axis, i + 1), p3 = sample(axis, i + 2);
  return p1 + u * ((p2 - p0) / 2 + u * (p0 - 2.5 * p1 + 2 * p2 - p3 / 2 + u * (1.5 * (p1 - p2) + (p3 - p0) / 2)));
}

double Commanded::acceleration_step(double time_s) const {
  constexpr std::ptrdiff_t kSpan = 3;      // samples each way: quieter than two
  const std::ptrdiff_t i = static_cast<std::ptrdiff_t>(std::llround(time_s / period_s_));
  double sum = 0;
  for (std::size_t a = 0; a < counts_.size(); ++a) {
    const auto second = [&](std::ptrdiff_t row) { return sample(a, row - kSpan) - 2 * sample(a, row) + sample(a, row + kSpan); };
    sum += std::abs(second(i + kSpan) - second(i - kSpan));
  }
  return sum / (static_cast<double>(kSpan * kSpan) * period_s_ * period_s_);
}

/// From a position to the straight piece between two samples.
double Commanded::distance_to_stretch(std::span<const double> position_counts, std::ptrdiff_t row) const {
  double along = 0, length = 0;
  for (std::size_t a = 0; a < counts_.size(); ++a) {
    const double from = sample(a, row), step = sample(a, row + 1) - from;
    along += (position_counts[a] - from) * step;
    length += step * step;
  }
  const double share = length > 0 ? std::clamp(along / length, 0.0, 1.0) : 0;
  double square = 0;
  for (std::size_t a = 0; a < counts_.size(); ++a) {
    const double from = sample(a, row), off = position_counts[a] - from - share * (sample(a, row + 1) - from);
    square += off * off;
  }
  return std::sqrt(square);
}

double Commanded::distance(std::span<const double> position_counts, double time_s) const {
  const std::ptrdiff_t last = static_cast<std::ptrdiff_t>(rows_) - 2;
  std::ptrdiff_t row = std::clamp<std::ptrdiff_t>(static_cast<std::ptrdiff_t>(std::floor(time_s / period_s_)), 0, last);
  double best = distance_to_stretch(position_counts, row);
  for (const std::ptrdiff_t direction : {1, -1}) {
    while (row + direction >= 0 && row + direction <= last) {
      const double next = distance_to_stretch(position_counts, row + direction);
      if (next >= best) break;
      best = next;
      row += direction;
    }
  }
  return best;
}

}  // namespace pmac::drives::silverlode
