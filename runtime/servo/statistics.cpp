// Nearly every block holds no new extreme of speed and acceleration: a quick look, several samples side by side, tells which do.
#include <algorithm>
#include <array>
#include <cmath>

#include "runtime/servo/servo.h"

namespace pmac::runtime {
namespace {

constexpr std::size_t kLanes = 4;

/// Largest first and second difference of samples, and where they lie.
struct Extremes {
  double step = 0, bend = 0, low, high;
};

/// position: count samples, with the two before them in front.
Extremes extremes_of(const double* position, std::size_t count) {
  std::array<double, kLanes> step{}, bend{}, low, high;
  low.fill(position[0]);
  high.fill(position[0]);
  const auto take = [&](std::size_t lane, std::size_t k) {
    const double now = position[k], d1 = std::abs(now - position[k - 1]), d2 = std::abs(now - 2 * position[k - 1] + position[k - 2]);
    step[lane] = d1 > step[lane] ? d1 : step[lane];
    bend[lane] = d2 > bend[lane] ? d2 : bend[lane];
    low[lane] = now < low[lane] ? now : low[lane];
    high[lane] = now > high[lane] ? now : high[lane];
  };
  std::size_t k = 0;
  for (; k + kLanes <= count; k += kLanes)
    for (std::size_t lane = 0; lane < kLanes; ++lane) take(lane, k + lane);
  for (; k < count; ++k) take(0, k);
  return {*std::max_element(step.begin(), step.end()), *std::max_element(bend.begin(), bend.end()), *std::min_element(low.begin(), low.end()),
          *std::max_element(high.begin(), high.end())};
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
