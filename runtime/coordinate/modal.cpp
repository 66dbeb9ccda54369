// From modes and words to a motion command. Source: User's Manual p665-743; the order rule of ta/td is inferred from published
// examples that set td after every ta.
#include "runtime/coordinate/modal.h"
#include "compiler/bytecode/element.h"

#include <bit>
#include <cmath>

#include <fmt/format.h>

namespace pmac::runtime {
namespace {

using bytecode::ElementId;
using bytecode::MotionParameter;
using bytecode::MoveMode;
using bytecode::WordKind;

bool is_circle(MoveMode mode) { return mode >= MoveMode::kCircle1 && mode <= MoveMode::kCircle4; }

void fill_circle(const ModalState& modal, const OpenBlock& block, const AxisVector& from_uu, motion::MotionCommand& command) {
  command.clockwise = modal.mode == MoveMode::kCircle1 || modal.mode == MoveMode::kCircle3;
  command.second_set = modal.mode == MoveMode::kCircle3 || modal.mode == MoveMode::kCircle4;
  if (command.second_set) command.normal = modal.second_normal;
  command.has_radius = block.has_radius;
  command.radius_uu = block.radius;
  const int first_word = command.second_set ? 3 : 0;
  const int first_axis = command.second_set ? bytecode::axis_index_from_name("XX") : bytecode::axis_index_from_name("X");
  for (int i = 0; i < 3; ++i) {
    if (!(block.center_words >> (first_word + i) & 1u)) continue;
    command.has_center = true;
    const double word = block.center[first_word + i];
    command.center_uu[i] = modal.absolute_center ? word - from_uu[first_axis + i] : word;
  }
}

void fill_times(const ElementStore& e, unsigned cs, motion::MotionCommand& command) {
  command.ta_ms = e.get(ElementId::kCoordTa, cs);
  command.td_ms = e.get(ElementId::kCoordTd, cs);
  command.ts_ms = e.get(ElementId::kCoordTs, cs);
  command.tsd_ms = e.get(ElementId::kCoordTsd, cs);
  const double tm = e.get(ElementId::kCoordTm, cs);
  if (tm < 0) command.feed_uu = -tm;
  else command.move_time_ms = tm;
  command.feed_time_ms = e.get(ElementId::kCoordFeedTime, cs);
  command.alt_feed_uu = e.get(ElementId::kCoordAltFeedRate, cs);
  command.inverse_time = e.get(ElementId::kCoordInvTimeMode, cs) != 0;
}

/// Index in PosRollOver of the axes A B C AA BB CC, or -1.
int rollover_index(int axis) {
  constexpr int kA = 0, kAA = 9;
  return axis >= kA && axis < kA + 3 ? axis - kA : axis >= kAA && axis < kAA + 3 ? axis - kAA + 3 : -1;
}

/// The target that is a whole number of turns from the programmed one: within half a turn, or for turn < 0 less than a turn away
/// in the direction of the programmed value's sign.
double rolled_over(double value, double from, double turn) {
  const double whole = std::abs(turn);
  if (turn > 0) return from + std::remainder(value - from, whole);
  const double forward = value - from - whole * std::floor((value - from) / whole);  // 0 .. whole
  return from + (std::signbit(value) && forward > 0 ? forward - whole : forward);
}

bool is_pvt(MoveMode mode) { return mode == MoveMode::kPvt || mode == MoveMode::kSpline; }

/// Velocities are those at the end; an axis without one stops there.
void fill_pvt(const ModalState& modal, const OpenBlock& block, motion::MotionCommand& command) {
  command.feed_uu = 0;
  command.move_time_ms = modal.mode == MoveMode::kPvt ? modal.pvt_time_ms : modal.spline_time_ms[1];
  for (std::size_t axis = 0; axis < block.velocity.size(); ++axis)
    if (block.velocity_axes >> axis & 1u) command.end_velocity_uu_ms[axis] = block.velocity[axis] / command.feed_time_ms;
}

ElementId element_of(MotionParameter parameter) {
  switch (parameter) {
    case MotionParameter::kTa: return ElementId::kCoordTa;
    case MotionParameter::kTd: return ElementId::kCoordTd;
    case MotionParameter::kTs: return ElementId::kCoordTs;
    case MotionParameter::kTsd: return ElementId::kCoordTsd;
    case MotionParameter::kTm:
    case MotionParameter::kFeed: return ElementId::kCoordTm;
    default: return ElementId::kCount;
  }
}

}  // namespace

void OpenBlock::add(WordKind kind, int index, double word) {
  switch (kind) {
    case WordKind::kTarget: axes |= 1u << index; value[index] = word; break;
    case WordKind::kVelocity: velocity_axes |= 1u << index; velocity[index] = word; break;
    case WordKind::kTriggerDistance: trigger_axes |= 1u << index; trigger[index] = word; break;
    case WordKind::kCenter: center_words |= 1u << index; center[index] = word; break;
    case WordKind::kRadius: has_radius = true; radius = word; break;
    case WordKind::kCount: break;
  }
}

AxisVector block_target(const ModalState& modal, const OpenBlock& block, const AxisVector& from_uu, const ElementStore& elements,
                        int coord) {
  AxisVector target = from_uu;
  for (std::uint32_t left = block.axes; left != 0; left &= left - 1) {
    const int axis = std::countr_zero(left);
    const bool absolute = modal.absolute_axes >> axis & 1u;
    target[axis] = absolute ? block.value[axis] : from_uu[axis] + block.value[axis];
    if (const int i = rollover_index(axis); absolute && i >= 0)
      if (const double turn = elements.get(ElementId::kCoordPosRollOver, static_cast<unsigned>(coord), static_cast<unsigned>(i)); turn != 0)
        target[axis] = rolled_over(block.value[axis], from_uu[axis], turn);
  }
  return target;
}

std::optional<Fault> check_block(const ModalState& modal, const OpenBlock& block, bytecode::SourceLine source) {
  for (std::uint32_t left = block.axes; left != 0; left &= left - 1) {
    const int axis = std::countr_zero(left);
    if (std::isfinite(block.value[axis])) continue;
    return Fault{FaultKind::kBadTarget, source,
                 fmt::format("the target of axis {} is {}, not a finite number; check for a division by zero",
                             bytecode::axis_name(axis), std::isnan(block.value[axis]) ? "nan" : "infinite")};
  }
  for (int word = 0; block.center_words >> word != 0; ++word)
    if (block.center_words >> word & 1u && !std::isfinite(block.center[word]))
      return Fault{FaultKind::kBadTarget, source, "a centre word (I, J, K) is not a finite number"};
  if (block.has_radius && !std::isfinite(block.radius))
    return Fault{FaultKind::kBadTarget, source, "the radius word R is not a finite number"};
  if (block.trigger_axes != 0 && modal.mode != MoveMode::kRapid)
    return Fault{FaultKind::kMoveType, source, "a move until a trigger (X50^-5) outside rapid mode; program rapid before"};
  for (int axis = 0; axis < bytecode::kAxisCount && block.trigger_axes >> axis != 0; ++axis)
    if (block.trigger_axes >> axis & 1u && !std::isfinite(block.trigger[axis]))
      return Fault{FaultKind::kBadTarget, source, fmt::format("the distance of axis {} from its trigger is not a finite number", bytecode::axis_name(axis))};
  if (!is_circle(modal.mode) && (block.center_words != 0 || block.has_radius))
    return Fault{FaultKind::kMoveType, source, "centre or radius words outside circle mode; program circle1 or circle2 before"};
  if (block.velocity_axes != 0 && modal.mode != MoveMode::kPvt)
    return Fault{FaultKind::kMoveType, source, "an end velocity (X10:5) outside pvt mode; program pvt before"};
  const unsigned other_set = modal.mode >= MoveMode::kCircle3 ? 0x07u : 0x38u;  // I J K, or II JJ KK
  if (is_circle(modal.mode) && (block.center_words & other_set) != 0)
    return Fault{FaultKind::kMoveType, source, "centre words of the other axis set: I J K go with circle1 and circle2, II JJ KK with circle3 and circle4"};
  return std::nullopt;
}

motion::MotionCommand block_command(const ModalState& modal, const OpenBlock& block, const AxisVector& from_uu,
                                    const ElementStore& elements, int coord, bytecode::SourceLine source) {
  motion::MotionCommand command;
  command.kind = is_circle(modal.mode) ? motion::CommandKind::kCircle : is_pvt(modal.mode) ? motion::CommandKind::kPvt : motion::CommandKind::kLinear;
  command.source = source;
  command.mode = modal.mode;
  command.axes = block.axes;
  command.target_uu = block_target(modal, block, from_uu, elements, coord);
  command.feed_axes = modal.feed_axes;
  command.feed_axes2 = modal.feed_axes2 & ~modal.feed_axes;
  command.normal = modal.normal;
  command.compensation_side = modal.compensation_side;
  command.compensation_radius_uu = modal.compensation_radius_uu;
  if (is_circle(modal.mode)) fill_circle(modal, block, from_uu, command);
  fill_times(elements, static_cast<unsigned>(coord), command);
  if (is_pvt(modal.mode)) fill_pvt(modal, block, command);
  return command;
}

std::optional<Fault> set_segment_time(MotionParameter parameter, double value, ModalState& modal, bytecode::SourceLine source) {
  if (!std::isfinite(value) || value <= 0)
    return Fault{FaultKind::kBadTarget, source, fmt::format("the time of a {} move is {} ms; it must be above 0", parameter == MotionParameter::kPvtTime ? "pvt" : "spline", number_text(value))};
  if (parameter == MotionParameter::kPvtTime) modal.pvt_time_ms = value;
  else modal.spline_time_ms[static_cast<std::size_t>(parameter) - static_cast<std::size_t>(MotionParameter::kSplineTime0)] = value;
  return std::nullopt;
}

std::optional<Fault> set_compensation(MotionParameter parameter, double value, ModalState& modal, bytecode::SourceLine source) {
  if (parameter == MotionParameter::kCcRadius) {
    if (!std::isfinite(value) || value < 0)
      return Fault{FaultKind::kBadTarget, source, fmt::format("ccr is {}; the radius of cutter compensation is a finite number, 0 or more", number_text(value))};
    modal.compensation_radius_uu = value;
    return std::nullopt;
  }
  if (value == 3) return Fault{FaultKind::kNotSimulated, source, "ccmode3, compensation in three dimensions, is not simulated"};
  if (value != 0 && value != 1 && value != 2)
    return Fault{FaultKind::kBadTarget, source, fmt::format("there is no ccmode{}; 0 is off, 1 left, 2 right", number_text(value))};
  modal.compensation_side = static_cast<int>(value);
  return std::nullopt;
}

std::optional<Fault> set_motion_parameter(MotionParameter parameter, double value, ElementStore& elements, int coord,
                                          bytecode::SourceLine source) {
  const auto cs = static_cast<unsigned>(coord);
  const ElementId id = element_of(parameter);
  if (id == ElementId::kCount)
    return Fault{FaultKind::kNotSimulated, source, fmt::format("{} is not simulated", motion_parameter_name(parameter))};
  if (!std::isfinite(value))
    return Fault{FaultKind::kBadTarget, source, fmt::format("{} is {}, not a finite number", motion_parameter_name(parameter), number_text(value))};
  if (parameter == MotionParameter::kFeed && value <= 0)
    return Fault{FaultKind::kBadTarget, source, fmt::format("the feed rate F is {}; it must be positive", value)};
  if (parameter == MotionParameter::kTm && value < 0)
    return Fault{FaultKind::kBadTarget, source, fmt::format("the move time tm is {} ms; it must not be negative", value)};
  elements.set(id, parameter == MotionParameter::kFeed ? -value : value, cs);
  if (parameter == MotionParameter::kTa) elements.set(ElementId::kCoordTd, value, cs);
  if (parameter == MotionParameter::kTs) elements.set(ElementId::kCoordTsd, value, cs);
  return std::nullopt;
}

}  // namespace pmac::runtime
