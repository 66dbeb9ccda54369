// What the motion statements of a program become: modes and parameters, items that wait for rest, and moves that go through
// transformation, compensation and the spline into the pipeline. Source: User's Manual p665-742.
#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "compiler/bytecode/element.h"
#include "compiler/bytecode/opcode.h"
#include "runtime/state.h"

namespace pmac::runtime {
namespace {

using bytecode::ElementId;
using bytecode::MoveMode;
using bytecode::Opcode;

constexpr int kMaxMovesWithoutTime = 1'000'000;  // moves of no duration in a row

}  // namespace

Flow CoordSystem::motion(Thread& thread, const bytecode::Instruction& instruction, std::span<const double> r) {
  const auto mask = static_cast<std::uint32_t>(instruction.imm);
  switch (instruction.op) {
    case Opcode::kSetMode: modal.mode = static_cast<MoveMode>(instruction.a); return Flow::kContinue;
    case Opcode::kSetAbs:
      modal.absolute_axes |= mask;
      if (instruction.a == 1) modal.absolute_center = true;
      return Flow::kContinue;
    case Opcode::kSetInc:
      modal.absolute_axes &= ~mask;
      if (instruction.a == 1) modal.absolute_center = false;
      return Flow::kContinue;
    case Opcode::kSetFrax:
      (instruction.a == 1 ? modal.feed_axes2 : modal.feed_axes) = mask;
      return Flow::kContinue;
    case Opcode::kClearFrax:
      (instruction.a == 1 ? modal.feed_axes2 : modal.feed_axes) &= ~mask;
      return Flow::kContinue;
    case Opcode::kSetNormal: {
      std::array<double, 3>& normal = instruction.imm == 1 ? modal.second_normal : modal.normal;
      normal = {r[instruction.a], r[instruction.a + 1u], r[instruction.a + 2u]};
      if (!(std::hypot(normal[0], normal[1], normal[2]) > 0))
        return give_up(thread, {FaultKind::kBadTarget, thread.source(), "the plane normal has no direction"});
      return Flow::kContinue;
    }
    case Opcode::kSetMotion:
      if (auto fault = set_parameter(static_cast<bytecode::MotionParameter>(instruction.b()), r[instruction.a], thread.source()))
        return give_up(thread, *fault);
      return Flow::kContinue;
    case Opcode::kAxisWord:
      block_.add(static_cast<bytecode::WordKind>(instruction.c()), instruction.b(), r[instruction.a]);
      return Flow::kContinue;
    case Opcode::kBlockEnd: return block_.empty() ? Flow::kContinue : end_block(thread);
    case Opcode::kStepBegin: step_block_ = true; return Flow::kContinue;
    case Opcode::kStepEnd:
      step_block_ = false;
      return stepping_ ? stop_item(thread, AfterRest::kPause) : Flow::kContinue;
    case Opcode::kDwell:
    case Opcode::kDelay: {
      const double ms = r[instruction.a];
      if (!std::isfinite(ms) || ms < 0)
        return give_up(thread, {FaultKind::kBadTarget, thread.source(), fmt::format("a wait of {} ms is not possible", number_text(ms))});
      thread.reset_jump_backs();
      if (instruction.op == Opcode::kDwell) {
        dwell_ms_ = ms;
        return stop_item(thread, AfterRest::kDwell);
      }
      motion::MotionCommand command = block_command(modal, {}, program_uu_, machine_.elements, number_, thread.source());
      command.kind = motion::CommandKind::kDelay;
      command.feed_uu = 0;
      command.move_time_ms = ms;
      return start_blendable(thread, command);
    }
    default: return give_up(thread, {FaultKind::kNotSimulated, thread.source(), "this motion statement is not simulated"});
  }
}

std::optional<Fault> CoordSystem::set_parameter(bytecode::MotionParameter parameter, double value, bytecode::SourceLine source) {
  switch (parameter) {
    case bytecode::MotionParameter::kTsel: return select_transform(value, source);
    case bytecode::MotionParameter::kPvtTime:
    case bytecode::MotionParameter::kSplineTime0:
    case bytecode::MotionParameter::kSplineTime1:
    case bytecode::MotionParameter::kSplineTime2: return set_segment_time(parameter, value, modal, source);
    case bytecode::MotionParameter::kCcRadius:
    case bytecode::MotionParameter::kCcMode: return set_compensation(parameter, value, modal, source);
    default: return set_motion_parameter(parameter, value, machine_.elements, number_, source);
  }
}

Flow CoordSystem::give_up(Thread& thread, Fault fault) {
  thread.set_host_fault(std::move(fault));
  return Flow::kFault;
}

Flow CoordSystem::end_block(Thread& thread) {
  const Flow flow = execute_block(thread, block_);
  block_.clear();
  return flow;
}

Flow CoordSystem::execute_block(Thread& thread, const OpenBlock& block) {
  thread.reset_jump_backs();
  const bytecode::SourceLine source = thread.source();
  if (auto fault = check_block(modal, block, source)) return give_up(thread, *fault);
  if (modal.mode == MoveMode::kRapid) {
    if (auto fault = refuse_while_compensating("a rapid move", source)) return give_up(thread, *fault);
    if (auto fault = rapid_move(modal, block, source, rapid_)) return give_up(thread, *fault);
    return stop_item(thread, AfterRest::kRapid);
  }
  motion::MotionCommand command = block_command(modal, block, program_uu_, machine_.elements, number_, source);
  if (command.kind == motion::CommandKind::kCircle && machine_.elements.get(ElementId::kCoordSegMoveTime, static_cast<unsigned>(number_)) <= 0)
    machine_.warn(command.source, fmt::format("a circle without segmentation is a straight line; set Coord[{}].SegMoveTime", number_));
  return start_blendable(thread, command);
}

Flow CoordSystem::stop_item(Thread& thread, AfterRest then) {
  item_source_ = thread.source();
  const bool is_step = then == AfterRest::kDwell || then == AfterRest::kRapid || then == AfterRest::kHome;
  if (stepping_ && !step_block_ && is_step) pause_requested_ = true;
  if (auto fault = come_to_rest(machine_.now_ms, then)) return give_up(thread, std::move(*fault));
  return Flow::kSuspend;
}

Flow CoordSystem::home_motor(Thread& thread, int motor, bool also) {
  if (auto fault = refuse_while_compensating("home", thread.source())) return give_up(thread, *fault);
  home_motors_.push_back(motor);
  return also ? Flow::kContinue : stop_item(thread, AfterRest::kHome);
}

Flow CoordSystem::home_zero(Thread& thread, int motor) {
  if (auto fault = refuse_while_compensating("homez", thread.source())) return give_up(thread, *fault);
  home_motor_ = motor;
  return stop_item(thread, AfterRest::kHomeZero);
}

Flow CoordSystem::wait_for_interrupt(Thread& thread) { return stop_item(thread, AfterRest::kNextInterrupt); }

/// A command of program coordinates in machine coordinates.
std::optional<Fault> CoordSystem::place(motion::MotionCommand& command) {
  if (frame_.is_plain()) {
    placed_uu_ = command.target_uu;
    return std::nullopt;
  }
  const AxisVector program_end = command.target_uu;
  if (command.kind == motion::CommandKind::kCircle && command.has_radius && frame_.scales_circles(machine_.elements, command))
    machine_.warn(command.source, fmt::format("the matrix Tdata[{}] scales the end point but not R; give the centre with I and J", frame_.transform));
  if (auto fault = frame_.place(machine_.elements, placed_uu_, calculated_uu_, command)) return fault;
  placed_uu_ = program_end;
  return std::nullopt;
}

Flow CoordSystem::start_blendable(Thread& thread, motion::MotionCommand& command) {
  const auto cs = static_cast<unsigned>(number_);
  if (const std::string refusal = on_path_ ? std::string() : why_not_ready(false); !refusal.empty())
    return give_up(thread, {FaultKind::kNotReady, thread.source(), refusal});
  ensure_sequence(machine_.now_ms);
  command.id = next_id_;
  command.no_blend = machine_.elements.get(ElementId::kCoordNoBlend, cs) != 0 || machine_.elements.get(ElementId::kCoordOnceNoBlend, cs) != 0;
  machine_.elements.set(ElementId::kCoordOnceNoBlend, 0, cs);
  command.transform = frame_.transform;
  if (machine_.options.observers.motion_command) machine_.options.observers.motion_command(number_, command);
  const AxisVector start = std::exchange(program_uu_, command.target_uu);
  const bool spline = command.kind == motion::CommandKind::kPvt && command.mode == MoveMode::kSpline;
  next_id_ += spline ? 3 : command.compensation_side != 0 || compensation_.active() ? 2 : 1;  // what is added has the ids between
  if (auto fault = spline ? add_to_spline(command, start) : hand_on(command, start)) return give_up(thread, *fault);
  collect_timings();
  if (pauses_here()) return stop_item(thread, AfterRest::kPause);
  if (!enough_ahead(machine_.now_ms)) return Flow::kContinue;
  moves_without_time_ = 0;
  resume_ms_ = next_calculation_ms(machine_.now_ms);
  return Flow::kSuspend;
}

/// A move other than a spline: what waits goes before it.
std::optional<Fault> CoordSystem::hand_on(motion::MotionCommand& command, const AxisVector& start_uu) {
  if (auto fault = finish_spline()) return fault;
  if (command.kind == motion::CommandKind::kPvt) {
    command.start_velocity_uu_ms = std::exchange(pvt_velocity_uu_ms_, command.end_velocity_uu_ms);
    pvt_goes_on_ = std::any_of(pvt_velocity_uu_ms_.begin(), pvt_velocity_uu_ms_.end(), [](double v) { return v != 0; });
  } else if (auto fault = pvt_has_ended(command.source)) {
    return fault;
  }
  return compensate(command, start_uu);
}

std::optional<Fault> CoordSystem::add_to_spline(const motion::MotionCommand& command, const AxisVector& start_uu) {
  if (auto fault = pvt_has_ended(command.source)) return fault;
  if (command.compensation_side != 0 || compensation_.active())
    return Fault{FaultKind::kCcMoveType, command.source, "spline moves are not allowed while cutter compensation is on"};
  if (const std::string why = spline_.misfit(modal.spline_time_ms); !why.empty()) return Fault{FaultKind::kPvt, command.source, why};
  spline_moves_.clear();
  spline_.add(command, modal.spline_time_ms, start_uu, spline_moves_);
  return add_spline_moves();
}

std::optional<Fault> CoordSystem::finish_spline() {
  spline_moves_.clear();
  spline_.finish(spline_moves_);
  return add_spline_moves();
}

std::optional<Fault> CoordSystem::add_spline_moves() {
  for (motion::MotionCommand& command : spline_moves_)
    if (auto fault = add_to_path(command)) return fault;
  return std::nullopt;
}

/// A pvt move that does not end at rest needs another one after it.
std::optional<Fault> CoordSystem::pvt_has_ended(bytecode::SourceLine source) const {
  if (!pvt_goes_on_) return std::nullopt;
  for (std::size_t axis = 0; axis < pvt_velocity_uu_ms_.size(); ++axis)
    if (pvt_velocity_uu_ms_[axis] != 0)
      return Fault{FaultKind::kPvt, source, fmt::format("the last pvt move leaves axis {} moving; end it with velocity 0, as in {}10:0",
                                                        bytecode::axis_name(static_cast<int>(axis)), bytecode::axis_name(static_cast<int>(axis)))};
  return std::nullopt;
}

/// The command, or what compensation makes of it and of those before, goes on its way.
std::optional<Fault> CoordSystem::compensate(motion::MotionCommand& command, const AxisVector& start_uu) {
  if (command.compensation_side == 0 && !compensation_.active()) return add_to_path(command);
  const auto cs = static_cast<unsigned>(number_);
  const ElementStore& e = machine_.elements;
  if (command.compensation_side != 0 && e.get(ElementId::kCoordSegMoveTime, cs) <= 0 && !compensation_.active()) {
    machine_.warn(command.source, fmt::format("cutter compensation does nothing without segmentation; set Coord[{}].SegMoveTime", number_));
    command.compensation_side = 0;
  }
  const bool compensating = command.compensation_side != 0 || compensation_.active();
  compensated_.clear();
  if (compensating)
    compensation_.configure({e.get(ElementId::kCoordCCAddedArcBp, cs), static_cast<int>(e.get(ElementId::kCoordCCSize, cs)),
                             static_cast<int>(e.get(ElementId::kCoordCCDistance, cs)), e.get(ElementId::kCoordRadiusErrorLimit, cs),
                             e.get(ElementId::kCoordMinArcLen, cs)});
  if (auto fault = compensation_.add(command, start_uu, compensated_)) return fault;
  return add_compensated();
}

std::optional<Fault> CoordSystem::flush_compensation() {
  compensated_.clear();
  if (auto fault = compensation_.flush(compensated_)) return fault;
  return add_compensated();
}

std::optional<Fault> CoordSystem::add_compensated() {
  for (motion::MotionCommand& command : compensated_)
    if (auto fault = add_to_path(command)) return fault;
  return std::nullopt;
}

std::optional<Fault> CoordSystem::add_to_path(motion::MotionCommand& command) {
  if (auto fault = place(command)) return fault;
  if (auto fault = check_targets(command.target_uu, command.source)) return fault;
  auto fault = pipeline_.add(command);
  if (fault && fault->kind != FaultKind::kSoftLimit) return fault;   // a path that ends at a limit has part of the move
  if (++moves_without_time_ > kMaxMovesWithoutTime)
    return Fault{FaultKind::kRunTime, command.source, fmt::format("{} moves in a row took no time; the program does not come on", kMaxMovesWithoutTime)};
  calculated_uu_ = pipeline_.calculated_position();
  const bool delay = command.kind == motion::CommandKind::kDelay;
  pending_moves_.push_back({command.id, delay ? "delay" : command.added ? "added" : move_mode_name(command.mode), command.source});
  return fault;
}

std::optional<Fault> CoordSystem::refuse_while_compensating(std::string_view what, bytecode::SourceLine source) const {
  if (!compensation_.active()) return std::nullopt;
  return Fault{FaultKind::kCcMoveType, source, fmt::format("{} while cutter compensation is on; program ccmode0 and a linear move that leads out before", what)};
}

}  // namespace pmac::runtime
