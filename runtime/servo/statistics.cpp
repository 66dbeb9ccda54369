#include <algorithm>
#include <cmath>

#include "runtime/servo/servo.h"

namespace pmac::runtime {

void MotionStatistics::take(const SampleBlock& block) {
  const double h = block.period_ms;
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
    for (int k = 0; k < block.count; ++k) {
      const double home = block.home_mu.empty() ? 0 : block.home_mu[m];  // homez moves home, not the motor
      const double from_home = block.at(static_cast<int>(m), k), now = from_home + home;
      const double speed = std::abs(now - s.previous_mu) / h;
      const double accel = std::abs(now - 2 * s.previous_mu + s.before_mu) / (h * h);
      if (speed > s.row.max_speed_mu_ms) { s.row.max_speed_mu_ms = speed; s.row.max_speed_at_ms = block.time_ms(k); }
      if (accel > s.row.max_accel_mu_ms2) { s.row.max_accel_mu_ms2 = accel; s.row.max_accel_at_ms = block.time_ms(k) - h; }
      s.row.min_mu = std::min(s.row.min_mu, from_home);
      s.row.max_mu = std::max(s.row.max_mu, from_home);
      s.row.final_mu = from_home;
      s.before_mu = s.previous_mu;
      s.previous_mu = now;
    }
  }
}

std::vector<MotionStatistics::Row> MotionStatistics::rows() const {
  std::vector<Row> rows;
  for (const State& s : states_)
    if (s.row.seen) rows.push_back(s.row);
  return rows;
}

}  // namespace pmac::runtime
