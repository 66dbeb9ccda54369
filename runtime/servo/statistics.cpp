// Nearly every block holds no new extreme of speed and acceleration: a quick look, several samples side by side, tells which do.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "runtime/servo/servo.h"

namespace pmac::runtime {
namespace {

/// Two samples side by side: what every x86-64 and ARM processor has.
using Pair = double __attribute__((vector_size(16)));

Pair pair_at(const double* from) {
  Pair values;
  std::memcpy(&values, from, sizeof values);
  return values;
}
Pair larger(Pair a, Pair b) { return a > b ? a : b; }
Pair smaller(Pair a, Pair b) { return a < b ? a : b; }

/// Largest first and second difference of samples, and where they lie.
struct Extremes {
  double step, bend, low, high;
};

/// position: count samples, with the two before them in front.
Extremes extremes_of(const double* position, std::size_t count) {
  Pair step{}, bend{}, low = {position[0], position[0]}, high = low;
  const auto take = [&](Pair now, Pair one_before, Pair two_before) {
    const Pair d1 = now - one_before, d2 = now - 2 * one_before + two_before;
    step = larger(larger(d1, -d1), step);   // what is not a number loses
    bend = larger(larger(d2, -d2), bend);
    low = smaller(now, low);
    high = larger(now, high);
  };
  std::size_t k = 0;
  for (; k + 2 <= count; k += 2) take(pair_at(position + k), pair_at(position + k - 1), pair_at(position + k - 2));
  if (k < count) take(Pair{position[k], position[k]}, Pair{position[k - 1], position[k - 1]}, Pair{position[k - 2], position[k - 2]});
  return {std::max(step[0], step[1]), std::max(bend[0], bend[1]), std::min(low[0], low[1]), std::max(high[0], high[1])};
}

}  // namespace

void MotionStatistics::take(const SampleBlock& block) {
  const double h = block.period_ms;
  thread_local std::vector<double> positions;   // from power-on, after the two last ones of the block before
  for (std::size_t m = 0; m < block.motors.size(); ++m) {
    const int motor = block.motors[m];
    if (states_.size() <= static_cast<std::size_t>(motor)) states_.resize(static_cast<std::size_t>(motor) + 1);
    State& s = states_[static_cast<std::size_t>(motor)];
    if (!s.row.seen) {
      s.row.motor = motor;
      s.row.seen = true;
      s.row.min_mu = s.row.max_mu = block.at(static_cast<int>(m), 0);
      s.previous_mu = s.before_mu = s.row.min_mu + (block.home_mu.empty() ? 0 : block.home_mu[m]);
    }
    const double home = block.home_mu.empty() ? 0 : block.home_mu[m];  // homez moves home, not the motor
    const std::span<const double> row = block.position_mu.subspan(m * static_cast<std::size_t>(block.count), static_cast<std::size_t>(block.count));
    positions.resize(row.size() + 2);
    positions[0] = s.before_mu;
    positions[1] = s.previous_mu;
    std::transform(row.begin(), row.end(), positions.begin() + 2, [&](double from_home) { return from_home + home; });
    const double* now = positions.data() + 2;
    const Extremes extremes = extremes_of(now, row.size());
    s.row.min_mu = std::min(s.row.min_mu, home == 0 ? extremes.low : *std::min_element(row.begin(), row.end()));
    s.row.max_mu = std::max(s.row.max_mu, home == 0 ? extremes.high : *std::max_element(row.begin(), row.end()));
    if (extremes.step / h > s.row.max_speed_mu_ms || extremes.bend / (h * h) > s.row.max_accel_mu_ms2) {
      for (int k = 0; k < block.count; ++k) {
        const double speed = std::abs(now[k] - now[k - 1]) / h, accel = std::abs(now[k] - 2 * now[k - 1] + now[k - 2]) / (h * h);
        if (speed > s.row.max_speed_mu_ms) { s.row.max_speed_mu_ms = speed; s.row.max_speed_at_ms = block.time_ms(k); }
        if (accel > s.row.max_accel_mu_ms2) { s.row.max_accel_mu_ms2 = accel; s.row.max_accel_at_ms = block.time_ms(k) - h; }
      }
    }
    s.row.final_mu = row.back();
    s.before_mu = positions[row.size()];
    s.previous_mu = positions[row.size() + 1];
  }
}

std::vector<MotionStatistics::Row> MotionStatistics::rows() const {
  std::vector<Row> rows;
  for (const State& s : states_)
    if (s.row.seen) rows.push_back(s.row);
  return rows;
}

}  // namespace pmac::runtime
