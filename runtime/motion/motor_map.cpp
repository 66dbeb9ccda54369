#include "runtime/motion/motor_map.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

namespace pmac::motion {

MotorKinematics::MotorKinematics(const MotorMap& map)
    : count_(map.motors.size()), offset_mu_(map.offset_mu), inverse_(map.inverse), inverse_rates_(map.inverse_rates) {
  offset_mu_.resize(count_, 0.0);
  if (inverse_) return;
  axes_ = 0;
  for (std::size_t motor = 0; motor < count_; ++motor)
    for (std::size_t axis = 0; axis < kAxisCount; ++axis)
      if (const double c = map.matrix_mu_uu[motor * kAxisCount + axis]; c != 0) {
        terms_.push_back({motor, axis, c});
        axes_ |= 1u << axis;
      }
}

std::optional<runtime::Fault> MotorKinematics::position(const AxisVector& axis_uu, double* motor_mu, SourceLine source) const {
  if (!inverse_) {
    std::copy(offset_mu_.begin(), offset_mu_.end(), motor_mu);
    for (const Term& term : terms_) motor_mu[term.motor] += term.coefficient * axis_uu[term.axis];
    return std::nullopt;
  }
  if (auto fault = inverse_(axis_uu, motor_mu, source)) return fault;
  for (std::size_t motor = 0; motor < count_; ++motor)
    if (!std::isfinite(motor_mu[motor]))
      return runtime::Fault{runtime::FaultKind::kInverseKinematics, source,
                            fmt::format("inverse kinematics gave no finite position for entry {} of the motors", motor)};
  return std::nullopt;
}

void MotorKinematics::rate(const AxisVector& axis_rate, double* motor_rate) const {
  std::fill(motor_rate, motor_rate + count_, 0.0);
  for (const Term& term : terms_) motor_rate[term.motor] += term.coefficient * axis_rate[term.axis];
}

std::optional<runtime::Fault> MotorKinematics::rate_at(const AxisVector& axis_uu, const AxisVector& axis_rate_uu_ms, double* motor_rate_mu_ms,
                                                       SourceLine source) const {
  if (!inverse_) {
    rate(axis_rate_uu_ms, motor_rate_mu_ms);
    return std::nullopt;
  }
  if (!inverse_rates_)
    return runtime::Fault{runtime::FaultKind::kInverseKinematics, source, "the inverse kinematics gives no velocities; set Coord[].SegMoveTime"};
  std::vector<double> position_mu(count_);
  return inverse_rates_(axis_uu, {axis_rate_uu_ms, motor_rate_mu_ms}, position_mu.data(), source);
}

bool MotorKinematics::rate_by_differences(const AxisVector& axis_uu, const AxisVector& axis_rate_uu_ms, double step_ms, double* motor_rate_mu_ms,
                                          SourceLine source) const {
  AxisVector place_uu = axis_uu;
  const auto positions = [&](double offset_ms, double* motor_mu) {
    for (std::size_t axis = 0; axis < kAxisCount; ++axis) place_uu[axis] = axis_uu[axis] + offset_ms * axis_rate_uu_ms[axis];
    return !position(place_uu, motor_mu, source).has_value();
  };
  std::vector<double> before_mu(count_);
  if (!positions(-step_ms, before_mu.data()) || !positions(step_ms, motor_rate_mu_ms)) return false;
  for (std::size_t motor = 0; motor < count_; ++motor) motor_rate_mu_ms[motor] = (motor_rate_mu_ms[motor] - before_mu[motor]) / (2 * step_ms);
  return true;
}

}  // namespace pmac::motion
