// Calls of the kinematic routines of a coordinate system, and of a stock robot that stands in for them. Source: User's Manual
// p511-519. A routine that leaves a motor unset, answers nan, aborts, writes ErrorStatus or loops too often has no solution, and
// nothing of it is used.
//
//   forward   in: L(n) motor positions, R(n) motor velocities    out: C(axis) positions, C(32 + axis) velocities, D0 axes
//   inverse   in: C(axis) positions, C(32 + axis) velocities     out: L(n) motor positions, R(n) motor velocities
//   D0 on entry: 1 where velocities are wanted (KinVelEna). Velocities are per ms [inferred].
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "runtime/interruption.h"
#include "runtime/state.h"

namespace pmac::runtime {
namespace {

using Kind = kinematics::MotorDefinition::Kind;

constexpr std::uint64_t kKinematicsBudget = 1'000'000;  // instructions of one call
constexpr double kRateStep_ms = 1e-3;                   // a robot's velocities are central differences over it

/// Why a routine did not come to its end, or empty.
std::string why_not(const Machine::State& machine, const RunResult& result, const Runner& runner) {
  switch (result.stop) {
    case RunStop::kEnded:
      if (runner.error_status != 0) return fmt::format("the routine set Coord[{}].ErrorStatus to {}", runner.number, runner.error_status);
      return runner.aborted ? "the routine aborted" : "";
    case RunStop::kJumpBack: return fmt::format("the routine looped more than Ldata.GoBack = {} times", runner.thread.go_back);
    case RunStop::kFault: return fmt::format("{} ({})", result.fault->detail, machine.place(result.fault->source));
    case RunStop::kSuspended: return "the routine waits; moves and dwells are not allowed in kinematic routines";
    case RunStop::kBudget: return "the routine does not come to an end";
  }
  return {};
}

std::uint32_t axes_of(double mask) { return mask >= 0 && mask <= 4294967295.0 ? static_cast<std::uint32_t>(mask) : 0; }

/// R(n); nan where the routine does not know it.
double outgoing_or_nan(Thread& thread, const bytecode::Program& program, int n) {
  return static_cast<std::uint32_t>(n) < program.outgoing_count ? thread.outgoing(n) : std::nan("");
}

}  // namespace

/// From its top to its end, with what has been put into the thread. Ldata.GoBack acts at once where the routine raises it.
std::string CoordSystem::run_routine(Caller caller) {
  poll_interruption();
  Thread& thread = kinematics_.thread;
  kinematics_.for_query = caller == Caller::kQuery;
  kinematics_.aborted = false;
  kinematics_.error_status = 0;
  thread.reset_jump_backs();
  RunResult result;
  std::uint64_t used = 0;
  int limit = 0;
  do {
    limit = thread.go_back + 1;
    result = thread.run(*machine_.host, kKinematicsBudget - used, limit);
    used += std::max<std::uint64_t>(result.instructions, 1);
  } while (result.stop == RunStop::kJumpBack && thread.go_back + 1 > limit && used < kKinematicsBudget);
  machine_.instructions += used;
  return why_not(machine_, result, kinematics_);
}

std::optional<Fault> CoordSystem::solve_inverse(const AxisVector& axis_uu, std::span<double> motor_mu, bytecode::SourceLine source,
                                                const motion::RoutineRates* rates, std::span<double> rate_mu) {
  const AxisVector* rate_uu = rates ? &rates->axis_uu_ms : nullptr;
  const std::string reason = robot.robot ? robot_inverse(axis_uu, motor_mu, rate_uu, rate_mu) : inverse_routine(axis_uu, motor_mu, rate_uu, rate_mu);
  if (reason.empty()) return std::nullopt;
  return Fault{FaultKind::kInverseKinematics, source, "the inverse kinematics has no solution for this move: " + reason};
}

std::string CoordSystem::inverse_routine(const AxisVector& axis_uu, std::span<double> motor_mu, const AxisVector* rate_uu, std::span<double> rate_mu) {
  if (!inverse) return "there is no inverse kinematic routine";
  Thread& thread = kinematics_.thread;
  thread.begin(inverse);
  thread.d[0] = rate_uu ? 1 : 0;  // KinVelEna
  for (std::size_t axis = 0; axis < bytecode::kAxisCount; ++axis) {
    thread.c[axis] = axis_uu[axis];
    thread.c[32 + axis] = rate_uu ? (*rate_uu)[axis] : 0;
  }
  for (const auto& d : definitions_) {
    if (d.kind != Kind::kInverse) continue;
    thread.local(d.motor) = std::nan("");
    if (static_cast<std::uint32_t>(d.motor) < inverse.program->outgoing_count) thread.outgoing(d.motor) = std::nan("");
  }
  std::string reason = run_routine(Caller::kProgram);
  for (std::size_t i = 0; reason.empty() && i < definitions_.size(); ++i) {
    const int motor = definitions_[i].motor;
    if (definitions_[i].kind != Kind::kInverse) continue;
    motor_mu[i] = thread.local(motor);
    if (!std::isfinite(motor_mu[i])) reason = fmt::format("KinPosMotor{} is not set or not a number", motor);
    if (!rate_uu || !reason.empty()) continue;
    rate_mu[i] = outgoing_or_nan(thread, *inverse.program, motor);
    if (!std::isfinite(rate_mu[i]))
      reason = fmt::format("KinVelMotor{} is not set or not a number; a pvt or spline move without segmentation asks for velocities "
                           "(KinVelEna), with Coord[{}].SegMoveTime above 0 positions are enough", motor, number_);
  }
  thread.stop();
  return reason;
}

std::string CoordSystem::solve_forward(std::span<const double> motor_mu, AxisVector& axis_uu, Caller caller) {
  return robot.robot ? robot_forward(motor_mu, axis_uu, caller) : forward_routine(motor_mu, axis_uu, caller);
}

std::string CoordSystem::forward_routine(std::span<const double> motor_mu, AxisVector& axis_uu, Caller caller) {
  Thread& thread = kinematics_.thread;
  thread.begin(forward);
  thread.d[0] = 0;
  for (int motor : motors_) thread.local(motor) = motor_mu[static_cast<std::size_t>(motor)];
  const std::string reason = run_routine(caller);
  const std::uint32_t mask = axes_of(thread.d[0]);
  thread.stop();
  if (!reason.empty()) return reason;
  if (mask == 0) return "the forward routine sets no axis in KinAxisUsed";
  for (int axis = 0; axis < bytecode::kAxisCount; ++axis) {
    const double value = thread.c[static_cast<std::size_t>(axis)];
    const bool used = mask >> axis & 1u;
    if (used && !std::isfinite(value) && caller == Caller::kProgram) return fmt::format("KinPosAxis{} is not a number", bytecode::axis_name(axis));
    if (used) axis_uu[static_cast<std::size_t>(axis)] = value;
  }
  forward_axes_ = mask;
  return {};
}

/// The forward routine with velocities. False where it does not set those of all its axes.
bool CoordSystem::forward_rates(std::span<const double> motor_mu, std::span<const double> motor_mu_ms, AxisVector& velocity_uu_ms) {
  Thread& thread = kinematics_.thread;
  thread.begin(forward);
  thread.d[0] = 1;
  for (int motor : motors_) {
    thread.local(motor) = motor_mu[static_cast<std::size_t>(motor)];
    if (static_cast<std::uint32_t>(motor) < forward.program->outgoing_count) thread.outgoing(motor) = motor_mu_ms[static_cast<std::size_t>(motor)];
  }
  for (std::size_t axis = 0; axis < bytecode::kAxisCount; ++axis) thread.c[32 + axis] = std::nan("");
  const bool ended = run_routine(Caller::kQuery).empty();
  const std::uint32_t mask = axes_of(thread.d[0]);
  thread.stop();
  bool all = ended && mask != 0;
  for (std::size_t axis = 0; axis < bytecode::kAxisCount; ++axis) {
    if (!(mask >> axis & 1u)) continue;
    velocity_uu_ms[axis] = thread.c[32 + axis];
    all = all && std::isfinite(velocity_uu_ms[axis]);
  }
  if (all) forward_axes_ = mask;
  return all;
}

// --- stock robots -----------------------------------------------------------------------------------------------------------------

std::string CoordSystem::robot_does_not_fit() const {
  int motors = 0;
  for (const auto& d : definitions_) motors += d.kind == Kind::kInverse;
  if (motors == robot.robot->joint_count()) return {};
  return fmt::format("the robot has {} joints, and coordinate system {} has {} motors defined ->I", robot.robot->joint_count(), number_, motors);
}

std::string CoordSystem::robot_inverse(const AxisVector& axis_uu, std::span<double> motor_mu, const AxisVector* rate_uu, std::span<double> rate_mu) {
  if (std::string reason = robot_does_not_fit(); !reason.empty()) return reason;
  const auto joints = static_cast<std::size_t>(robot.robot->joint_count());
  const auto scale = [&](std::size_t joint) { return robot.motor_mu_per_joint[robot.motor_mu_per_joint.size() == 1 ? 0 : joint]; };
  near_joint_.resize(joints);
  std::vector<double> joint(joints), before(joints), after(joints);
  std::string reason = robot.robot->inverse(axis_uu, near_joint_, joint);
  AxisVector from = axis_uu, to = axis_uu;
  for (std::size_t axis = 0; rate_uu && axis < axis_uu.size(); ++axis) {
    from[axis] -= (*rate_uu)[axis] * kRateStep_ms;
    to[axis] += (*rate_uu)[axis] * kRateStep_ms;
  }
  if (rate_uu && reason.empty()) reason = robot.robot->inverse(from, joint, before);
  if (rate_uu && reason.empty()) reason = robot.robot->inverse(to, joint, after);
  if (!reason.empty()) return reason;
  std::size_t j = 0;
  for (std::size_t i = 0; i < definitions_.size(); ++i) {
    if (definitions_[i].kind != Kind::kInverse) continue;
    motor_mu[i] = joint[j] * scale(j);
    if (!std::isfinite(motor_mu[i])) return fmt::format("joint {} is not a number", j + 1);
    if (rate_uu) rate_mu[i] = (after[j] - before[j]) / (2 * kRateStep_ms) * scale(j);
    ++j;
  }
  near_joint_ = joint;
  return {};
}

std::string CoordSystem::robot_forward(std::span<const double> motor_mu, AxisVector& axis_uu, Caller caller) {
  if (std::string reason = robot_does_not_fit(); !reason.empty()) return reason;
  std::vector<double> joint;
  for (const auto& d : definitions_) {
    if (d.kind != Kind::kInverse) continue;
    const double scale = robot.motor_mu_per_joint[robot.motor_mu_per_joint.size() == 1 ? 0 : joint.size()];
    joint.push_back(motor_mu[static_cast<std::size_t>(d.motor)] / scale);
  }
  if (std::string reason = robot.robot->forward(joint, axis_uu); !reason.empty()) return reason;
  forward_axes_ = robot.robot->axes();
  if (caller == Caller::kProgram) near_joint_ = joint;
  return {};
}

}  // namespace pmac::runtime
