// Where the axes are: linear solution of the axis definitions and the kinematic routines of the coordinate system.
// Source: User's Manual p509-518.
#include <cmath>

#include <fmt/format.h>

#include "runtime/state.h"

namespace pmac::runtime {

using Kind = kinematics::MotorDefinition::Kind;

std::optional<Fault> CoordSystem::motors_from_axes(const AxisVector& axis_uu, double* motor_mu, bytecode::SourceLine source,
                                                   const motion::RoutineRates* rates) {
  std::array<double, bytecode::kMaxMotors> all{}, all_rates{};
  const std::span<double> by_definition(all.data(), definitions_.size()), rate_by_definition(all_rates.data(), definitions_.size());
  map_.motors_from_axes(axis_uu, by_definition);
  if (rates) map_.motor_rates_from_axis_rates(rates->axis_uu_ms, rate_by_definition);
  if (map_.has_inverse_motors())
    if (auto fault = solve_inverse(axis_uu, by_definition, source, rates, rate_by_definition)) return fault;
  std::size_t out = 0;
  for (std::size_t i = 0; i < definitions_.size(); ++i) {
    if (definitions_[i].kind != Kind::kLinear && definitions_[i].kind != Kind::kInverse) continue;
    motor_mu[out] = all[i];
    if (rates) rates->motor_mu_ms[out] = all_rates[i];
    ++out;
  }
  return std::nullopt;
}

std::string CoordSystem::why_no_kinematics() const {
  if (!map_.solvable() && !has_forward()) return map_.reason();
  if (!map_.has_inverse_motors() || robot.robot) return {};
  if (!inverse) return "a motor is defined ->I and there is no inverse kinematic routine";
  if (!forward) return "a motor is defined ->I and there is no forward kinematic routine";
  return {};
}

std::string CoordSystem::match_positions(double time_ms) {
  std::array<double, bytecode::kMaxMotors> motor_mu{};
  for (int motor : motors_) motor_mu[static_cast<std::size_t>(motor)] = machine_.motors[static_cast<std::size_t>(motor)].position_at(time_ms);
  if (const std::string reason = why_no_kinematics(); !reason.empty()) return "error #39: NOT READY TO RUN: " + reason;
  std::array<double, bytecode::kMaxMotors> by_definition{};
  for (std::size_t i = 0; i < definitions_.size(); ++i) by_definition[i] = motor_mu[static_cast<std::size_t>(definitions_[i].motor)];
  AxisVector matched = calculated_uu_;
  map_.axes_from_motors(std::span<const double>(by_definition.data(), definitions_.size()), matched);
  if (has_forward())
    if (const std::string reason = solve_forward(motor_mu, matched, Caller::kProgram); !reason.empty())
      return "error #39: NOT READY TO RUN: forward kinematics: " + reason;
  calculated_uu_ = matched;
  return rename_position();
}

bool CoordSystem::axes_from_motors(std::span<const double> motor_mu, AxisVector& axis_uu, std::string* why) {
  std::array<double, bytecode::kMaxMotors> by_definition{};
  for (std::size_t i = 0; i < definitions_.size(); ++i) by_definition[i] = motor_mu[static_cast<std::size_t>(definitions_[i].motor)];
  map_.axes_from_motors(std::span<const double>(by_definition.data(), definitions_.size()), axis_uu);
  if (!has_forward()) return true;
  std::string reason = solve_forward(motor_mu, axis_uu, Caller::kQuery);
  if (reason.empty()) return true;
  for (std::size_t axis = 0; axis < axis_uu.size(); ++axis)
    if (forward_axes_ >> axis & 1u) axis_uu[axis] = std::nan("");
  if (why) *why = std::move(reason);
  return false;
}

/// Program coordinates of the motors' commanded or actual positions.
AxisVector CoordSystem::axes_at(double time_ms, bool actual) {
  std::array<double, bytecode::kMaxMotors> motor_mu{};
  for (int motor : motors_) {
    const Motor& m = machine_.motors[static_cast<std::size_t>(motor)];
    motor_mu[static_cast<std::size_t>(motor)] = actual ? m.actual_at(time_ms) : m.position_at(time_ms);
  }
  AxisVector axis_uu = calculated_uu_;
  axes_from_motors(motor_mu, axis_uu);
  AxisVector unknown;
  unknown.fill(std::nan(""));
  return frame_.to_program(machine_.elements, axis_uu).value_or(unknown);
}

AxisVector CoordSystem::commanded_position(double time_ms) { return axes_at(time_ms, false); }
AxisVector CoordSystem::actual_position(double time_ms) { return axes_at(time_ms, true); }

AxisVector CoordSystem::following_error_uu(double time_ms) {
  AxisVector error = axes_at(time_ms, false);
  const AxisVector actual = axes_at(time_ms, true);
  for (std::size_t axis = 0; axis < error.size(); ++axis) error[axis] -= actual[axis];
  return error;
}

/// What the forward routine says of velocities (KinVelAxis); nullopt where it sets none.
std::optional<AxisVector> CoordSystem::routine_velocity_uu_ms(double time_ms) {
  if (!forward || robot.robot) return std::nullopt;
  std::array<double, bytecode::kMaxMotors> motor_mu{}, motor_mu_ms{}, by_definition{};
  for (int motor : motors_) {
    motor_mu[static_cast<std::size_t>(motor)] = machine_.motors[static_cast<std::size_t>(motor)].position_at(time_ms);
    motor_mu_ms[static_cast<std::size_t>(motor)] = machine_.motors[static_cast<std::size_t>(motor)].velocity_at(time_ms);
  }
  for (std::size_t i = 0; i < definitions_.size(); ++i) by_definition[i] = motor_mu_ms[static_cast<std::size_t>(definitions_[i].motor)];
  AxisVector velocity_uu_ms{};
  map_.axis_rates_from_motor_rates(std::span<const double>(by_definition.data(), definitions_.size()), velocity_uu_ms);
  return forward_rates(motor_mu, motor_mu_ms, velocity_uu_ms) ? std::optional(velocity_uu_ms) : std::nullopt;
}

AxisVector CoordSystem::commanded_velocity_uu_ms(double time_ms) {
  if (auto velocity = routine_velocity_uu_ms(time_ms)) return *velocity;
  const double half_ms = machine_.period_ms() / 2;
  std::array<double, bytecode::kMaxMotors> before_mu{}, after_mu{};
  for (int motor : motors_) {
    const Motor& m = machine_.motors[static_cast<std::size_t>(motor)];
    before_mu[static_cast<std::size_t>(motor)] = m.position_at(time_ms) - half_ms * m.velocity_at(time_ms);
    after_mu[static_cast<std::size_t>(motor)] = m.position_at(time_ms) + half_ms * m.velocity_at(time_ms);
  }
  AxisVector before_uu{}, after_uu{};
  axes_from_motors(before_mu, before_uu);
  axes_from_motors(after_mu, after_uu);
  for (std::size_t i = 0; i < after_uu.size(); ++i) after_uu[i] = (after_uu[i] - before_uu[i]) / (2 * half_ms);
  return after_uu;
}

motion::MotorMap CoordSystem::motor_map() {
  motion::MotorMap map;
  for (const auto& d : definitions_) {
    if (d.kind != Kind::kLinear && d.kind != Kind::kInverse) continue;
    map.motors.push_back(d.motor);
    map.matrix_mu_uu.insert(map.matrix_mu_uu.end(), d.coefficient_mu_uu.begin(), d.coefficient_mu_uu.end());
    map.offset_mu.push_back(d.offset_mu);
  }
  if (map_.has_inverse_motors())
    map.inverse = [this](const AxisVector& axis_uu, double* motor_mu, bytecode::SourceLine source) {
      return motors_from_axes(axis_uu, motor_mu, source);
    };
  if (map_.has_inverse_motors())
    map.inverse_rates = [this](const AxisVector& axis_uu, const motion::RoutineRates& rates, double* motor_mu, bytecode::SourceLine source) {
      return motors_from_axes(axis_uu, motor_mu, source, &rates);
    };
  return map;
}

}  // namespace pmac::runtime
