// Rapid moves: every motor by its own profile from where it is and as fast as it goes to its part of the target. Source: User's Manual
// p712; until a trigger, p667 and p718-719.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "compiler/bytecode/element.h"
#include "runtime/motor_moves.h"
#include "runtime/state.h"

namespace pmac::runtime {
namespace {

using bytecode::ElementId;

/// Distance of a motor from its trigger; nullopt: no axis of it seeks one.
std::optional<double> trigger_distance_mu(const RapidMove& move, const motion::MotorMap& map, std::size_t motor) {
  double distance_mu = 0;
  bool seeks = false;
  for (int axis = 0; axis < bytecode::kAxisCount; ++axis) {
    const double scale = map.matrix_mu_uu[motor * bytecode::kAxisCount + static_cast<std::size_t>(axis)];
    if (!(move.trigger_axes >> axis & 1u) || scale == 0) continue;
    seeks = true;
    distance_mu += scale * move.trigger_uu[static_cast<std::size_t>(axis)];
  }
  return seeks ? std::optional(distance_mu) : std::nullopt;
}

}  // namespace

std::optional<Fault> CoordSystem::rapid_move(const ModalState& modes, const OpenBlock& block, bytecode::SourceLine source, RapidMove& move) {
  if (block.trigger_axes != 0 && frame_.transform >= 0)
    return Fault{FaultKind::kNotSimulated, source, "a move until a trigger (^) under a transformation is not simulated; program tsel-1 before"};
  motion::MotionCommand command = block_command(modes, block, program_uu_, machine_.elements, number_, source);
  program_uu_ = command.target_uu;
  if (auto fault = place(command)) return fault;
  move = {command.target_uu, block.trigger_axes, block.trigger, source};
  return std::nullopt;
}

/// Speed and ramps of every motor of the map; with RapidVelCtrl all take the time of the slowest.
std::optional<Fault> CoordSystem::rapid_parameters(double time_ms, const RapidMove& move, const motion::MotorMap& map,
                                                   std::span<const double> target_mu, std::vector<motion::JogParameters>& parameters) const {
  const ElementStore& e = machine_.elements;
  double longest_cruise_ms = 0;
  std::vector<double> distance_mu;
  for (std::size_t i = 0; i < map.motors.size(); ++i) {
    const auto n = static_cast<unsigned>(map.motors[i]);
    const bool at_max = e.get(ElementId::kMotorRapidSpeedSel, n) != 0;
    const double speed_mu_ms = e.get(at_max ? ElementId::kMotorMaxSpeed : ElementId::kMotorJogSpeed, n);
    if (!(speed_mu_ms > 0))
      return Fault{FaultKind::kBadTarget, move.source,
                   fmt::format("Motor[{}].{} is not above 0; a rapid move needs a speed", n, at_max ? "MaxSpeed" : "JogSpeed")};
    parameters.push_back({speed_mu_ms, e.get(ElementId::kMotorJogTa, n), e.get(ElementId::kMotorJogTs, n)});
    distance_mu.push_back(std::abs(target_mu[i] - machine_.motors[n].position_at(time_ms)));
    longest_cruise_ms = std::max(longest_cruise_ms, distance_mu[i] / speed_mu_ms);
  }
  const bool equal_times = e.get(ElementId::kCoordRapidVelCtrl, static_cast<unsigned>(number_)) != 0;
  for (std::size_t i = 0; equal_times && i < parameters.size(); ++i)
    if (distance_mu[i] > 0) parameters[i].speed_mu_ms = distance_mu[i] / longest_cruise_ms;  // the same D/V for all
  return std::nullopt;
}

std::optional<Fault> CoordSystem::move_rapid(double time_ms, const RapidMove& move) {
  const motion::MotorMap map = motor_map();
  if (move.trigger_axes != 0 && map.inverse)
    return Fault{FaultKind::kMoveType, move.source, "a move until a trigger (^) cannot go through kinematics"};
  std::vector<double> target(map.motors.size());
  if (auto fault = motors_from_axes(move.target_uu, target.data(), move.source)) return fault;
  const std::vector<double> wanted = target;
  for (std::size_t i = 0; i < target.size(); ++i)
    if (auto fault = limit_target(map.motors[i], target[i], move.source)) return fault;
  std::vector<motion::JogParameters> parameters;
  if (auto fault = rapid_parameters(time_ms, move, map, target, parameters)) return fault;
  const TimeBase* clock = clock_for_motion(time_ms);
  for (std::size_t i = 0; i < map.motors.size(); ++i) {
    Motor& m = machine_.motors[static_cast<std::size_t>(map.motors[i])];
    const double from = m.position_at(time_ms);
    const auto trigger = trigger_distance_mu(move, map, i);
    if (from == target[i] && !m.moving() && !trigger) continue;
    m.follow(motion::MotorProfile::move(clock->path_at(time_ms), from, m.velocity_by(clock, time_ms), target[i], parameters[i],
                                        m.accel_by(clock, time_ms)), clock);
    note_clip(m, target[i], wanted[i]);
    if (trigger) seek_trigger(machine_, m, *trigger, parameters[i]);
  }
  double length2 = 0;
  for (std::size_t axis = 0; axis < move.target_uu.size(); ++axis)
    length2 += (move.target_uu[axis] - calculated_uu_[axis]) * (move.target_uu[axis] - calculated_uu_[axis]);
  calculated_uu_ = move.target_uu;
  rapid_ = move;
  rapid_start_ms_ = time_ms;
  rapid_length_uu_ = std::sqrt(length2);
  rapid_open_ = true;
  return std::nullopt;
}

/// The motor that arrives last decides.
std::vector<motion::GoverningShare> CoordSystem::rapid_governed() const {
  const Motor* last = nullptr;
  for (int motor : motors_) {
    const Motor& m = machine_.motors[static_cast<std::size_t>(motor)];
    if (m.coord == number_ && (!last || m.profile.end_ms() > last->profile.end_ms())) last = &m;
  }
  return last ? governed_by_itself(machine_, *last) : std::vector<motion::GoverningShare>{};
}

void CoordSystem::report_rapid(double time_ms) {
  if (rapid_open_) record({"rapid", rapid_.source, number_, -1, rapid_start_ms_, time_ms, rapid_length_uu_, {}, rapid_governed()});
  rapid_open_ = false;
}

Flow CoordSystem::plc_move(Thread& thread, const OpenBlock& block) {
  ModalState modes = modal;
  modes.mode = bytecode::MoveMode::kRapid;
  if (auto fault = check_block(modes, block, thread.source())) return give_up(thread, *fault);
  if (program_running())
    return give_up(thread, {FaultKind::kNotReady, thread.source(),
                            fmt::format("error #38: PROGRAM RUNNING: coordinate system {} executes a program and cannot be moved by a PLC", number_)});
  if (std::string refusal = why_not_ready(false); !refusal.empty()) return give_up(thread, {FaultKind::kNotReady, thread.source(), refusal});
  report_rapid(machine_.now_ms);
  RapidMove move;
  if (auto fault = rapid_move(modes, block, thread.source(), move)) return give_up(thread, std::move(*fault));
  if (auto fault = move_rapid(machine_.now_ms, move)) return give_up(thread, std::move(*fault));
  return Flow::kContinue;
}

}  // namespace pmac::runtime
