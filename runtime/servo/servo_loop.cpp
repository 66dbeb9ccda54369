#include "runtime/servo/servo_loop.h"

#include <algorithm>
#include <cmath>

namespace pmac::runtime {
namespace {

double limited(double value, double limit) { return std::clamp(value, -limit, limit); }

}  // namespace

void ServoLoop::start(double position_mu, double velocity_mu_ms, double period_ms) {
  *this = ServoLoop{};
  position_mu_ = desired_mu_ = position_mu;
  next_mu_ = position_mu + velocity_mu_ms * period_ms;
  previous_mu_ = position_mu - velocity_mu_ms * period_ms;
  velocity_mu_ms_ = velocity_mu_ms;
  desired_velocity_mu_ = velocity_mu_ms * period_ms;
  closed_ = true;
}

void ServoLoop::step(double desired_mu, bool closed, const ServoGains& gains, const ServoPlant& plant, double period_ms) {
  previous_mu_ = position_mu_;
  position_mu_ = next_mu_;
  if (closed && !closed_) {  // the loop is closed where the motor is
    desired_mu_ = desired_mu;
    desired_velocity_mu_ = integral_mu_ = 0;
  }
  closed_ = closed;
  output_ = closed ? control(desired_mu, gains) : gains.open_output;
  if (!closed) error_mu_ = integral_mu_ = 0;
  move(plant, period_ms);
}

double ServoLoop::control(double desired_mu, const ServoGains& g) {
  const double velocity_mu = desired_mu - desired_mu_;
  const double acceleration_mu = velocity_mu - desired_velocity_mu_;
  desired_mu_ = desired_mu;
  desired_velocity_mu_ = velocity_mu;
  error_mu_ = desired_mu - position_mu_;
  const double seen_mu = g.max_error_mu > 0 ? limited(error_mu_, g.max_error_mu) : error_mu_;
  const double largest_integral_mu = g.kp != 0 ? std::abs(g.max_integral / g.kp) : 0;
  const double integral_mu = limited(integral_mu_ + g.ki * seen_mu, largest_integral_mu);
  const bool integrates = !g.integrates_at_rest_only || velocity_mu == 0;
  const double wanted = g.kp * (seen_mu + g.kvff * velocity_mu + g.kaff * acceleration_mu + (integrates ? integral_mu : integral_mu_) -
                                g.kvfb * velocity_mu_cycle());
  const double output = limited(wanted, std::max(0.0, g.max_output));
  if (integrates && output == wanted) integral_mu_ = integral_mu;
  return output;
}

/// Exact over a cycle of constant output: v' = gain * output - friction * v.
void ServoLoop::move(const ServoPlant& plant, double period_ms) {
  const double force = plant.accel_gain_mu_ms2 * output_, b = std::max(0.0, plant.friction_per_ms), h = period_ms;
  const double decay = -std::expm1(-b * h);                              // 1 - exp(-bh)
  const double mean_time_ms = b * h > 1e-8 ? decay / b : h * (1 - b * h / 2);
  const double drift_ms2 = b * h > 1e-3 ? (h - mean_time_ms) / b : h * h * (0.5 - b * h / 6 + b * h * b * h / 24);
  next_mu_ = position_mu_ + velocity_mu_ms_ * mean_time_ms + force * drift_ms2;
  velocity_mu_ms_ += force * mean_time_ms - velocity_mu_ms_ * decay;
}

}  // namespace pmac::runtime
