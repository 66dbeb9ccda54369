// Where the axes are: linear solution of the axis definitions and the kinematic routines of the coordinate system.
// Source: User's Manual p509-518. A routine that leaves a motor unset, answers nan, aborts or loops too often has no solution, and
// nothing of it is used.
#include <cmath>

#include <fmt/format.h>

#include "runtime/state.h"

namespace pmac::runtime {
namespace {

using Kind = kinematics::MotorDefinition::Kind;

constexpr std::uint64_t kKinematicsBudget = 1'000'000;  // instructions of one call

/// Why a routine did not come to its end, or empty.
std::string why_not(const Machine::State& machine, const RunResult& result, const Runner& runner) {
  switch (result.stop) {
    case RunStop::kEnded: return runner.aborted ? "the routine aborted" : "";
    case RunStop::kJumpBack: return fmt::format("the routine looped more than Ldata.GoBack = {} times", runner.thread.go_back);
    case RunStop::kFault: return fmt::format("{} ({})", result.fault->detail, machine.place(result.fault->source));
    case RunStop::kSuspended: return "the routine waits; moves and dwells are not allowed in kinematic routines";
    case RunStop::kBudget: return "the routine does not come to an end";
  }
  return {};
}

}  // namespace

std::optional<Fault> CoordSystem::solve_inverse(const AxisVector& axis_uu, std::span<double> motor_mu, bytecode::SourceLine source) {
  Thread& thread = kinematics_.thread;
  thread.begin(inverse);
  kinematics_.aborted = false;
  thread.d[0] = 0;  // KinVelEna: positions only
  for (int axis = 0; axis < bytecode::kAxisCount; ++axis) {
    thread.c[static_cast<std::size_t>(axis)] = axis_uu[static_cast<std::size_t>(axis)];
    thread.c[static_cast<std::size_t>(32 + axis)] = 0;
  }
  for (const auto& d : definitions_)
    if (d.kind == Kind::kInverse) thread.local(d.motor) = std::nan("");
  thread.reset_jump_backs();
  const RunResult result = thread.run(*machine_.host, kKinematicsBudget, thread.go_back + 1);
  machine_.instructions += result.instructions;
  std::string reason = why_not(machine_, result, kinematics_);
  for (std::size_t i = 0; reason.empty() && i < definitions_.size(); ++i) {
    if (definitions_[i].kind != Kind::kInverse) continue;
    motor_mu[i] = thread.local(definitions_[i].motor);
    if (!std::isfinite(motor_mu[i])) reason = fmt::format("KinPosMotor{} is not set or not a number", definitions_[i].motor);
  }
  thread.stop();
  if (reason.empty()) return std::nullopt;
  return Fault{FaultKind::kInverseKinematics, source, "the inverse kinematics has no solution for this move: " + reason};
}

std::optional<Fault> CoordSystem::motors_from_axes(const AxisVector& axis_uu, double* motor_mu, bytecode::SourceLine source) {
  std::array<double, bytecode::kMaxMotors> all{};
  const std::span<double> by_definition(all.data(), definitions_.size());
  map_.motors_from_axes(axis_uu, by_definition);
  if (map_.has_inverse_motors())
    if (auto fault = solve_inverse(axis_uu, by_definition, source)) return fault;
  std::size_t out = 0;
  for (std::size_t i = 0; i < definitions_.size(); ++i)
    if (definitions_[i].kind == Kind::kLinear || definitions_[i].kind == Kind::kInverse) motor_mu[out++] = all[i];
  return std::nullopt;
}

std::string CoordSystem::forward_routine(std::span<const double> motor_mu, AxisVector& axis_uu) {
  Thread& thread = kinematics_.thread;
  thread.begin(forward);
  kinematics_.aborted = false;
  thread.d[0] = 0;
  for (int motor : motors_) thread.local(motor) = motor_mu[static_cast<std::size_t>(motor)];
  thread.reset_jump_backs();
  const RunResult result = thread.run(*machine_.host, kKinematicsBudget, thread.go_back + 1);
  machine_.instructions += result.instructions;
  const std::string reason = why_not(machine_, result, kinematics_);
  const double mask_number = thread.d[0];
  thread.stop();
  if (!reason.empty()) return reason;
  const std::uint32_t mask = mask_number >= 0 && mask_number <= 4294967295.0 ? static_cast<std::uint32_t>(mask_number) : 0;
  if (mask == 0) return "the forward routine sets no axis in KinAxisUsed";
  for (int axis = 0; axis < bytecode::kAxisCount; ++axis) {
    if (!(mask >> axis & 1u)) continue;
    axis_uu[static_cast<std::size_t>(axis)] = thread.c[static_cast<std::size_t>(axis)];
    if (!std::isfinite(axis_uu[static_cast<std::size_t>(axis)]))
      return fmt::format("KinPosAxis{} is not a number", bytecode::axis_name(axis));
  }
  forward_axes_ = mask;
  return {};
}

std::string CoordSystem::match_positions(double time_ms) {
  std::array<double, bytecode::kMaxMotors> motor_mu{};
  for (int motor : motors_) motor_mu[static_cast<std::size_t>(motor)] = machine_.motors[static_cast<std::size_t>(motor)].position_at(time_ms);
  if (!map_.solvable() && !forward) return "error #39: NOT READY TO RUN: " + map_.reason();
  if (map_.has_inverse_motors() && !inverse)
    return "error #39: NOT READY TO RUN: a motor is defined ->I and there is no inverse kinematic routine";
  if (map_.has_inverse_motors() && !forward)
    return "error #39: NOT READY TO RUN: a motor is defined ->I and there is no forward kinematic routine";
  std::array<double, bytecode::kMaxMotors> by_definition{};
  for (std::size_t i = 0; i < definitions_.size(); ++i) by_definition[i] = motor_mu[static_cast<std::size_t>(definitions_[i].motor)];
  AxisVector matched = calculated_uu_;
  map_.axes_from_motors(std::span<const double>(by_definition.data(), definitions_.size()), matched);
  if (forward)
    if (const std::string reason = forward_routine(motor_mu, matched); !reason.empty())
      return "error #39: NOT READY TO RUN: forward kinematics: " + reason;
  calculated_uu_ = matched;
  return rename_position();
}

bool CoordSystem::axes_from_motors(std::span<const double> motor_mu, AxisVector& axis_uu) {
  std::array<double, bytecode::kMaxMotors> by_definition{};
  for (std::size_t i = 0; i < definitions_.size(); ++i) by_definition[i] = motor_mu[static_cast<std::size_t>(definitions_[i].motor)];
  map_.axes_from_motors(std::span<const double>(by_definition.data(), definitions_.size()), axis_uu);
  return !forward || forward_routine(motor_mu, axis_uu).empty();
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

AxisVector CoordSystem::commanded_velocity_uu_ms(double time_ms) {
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
  return map;
}

}  // namespace pmac::runtime
