// Waits until motors are in position: where Coord[].InPosTimeOut is above 0, after rapid moves and home searches of a program, and at stops
// that NoBlend, OnceNoBlend, CornerBlendBp or CornerDwellBp ask for. With 0 the commanded motion comes to rest and goes on. Source: Turbo
// Software Reference Isx81, Isx85. Assumed: that Power PMAC does the same, counts the time-out in ms, and looks once a real-time interrupt.
#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "compiler/bytecode/element.h"
#include "runtime/state.h"

namespace pmac::runtime {

using bytecode::ElementId;

bool CoordSystem::waits_in_position() const { return machine_.elements.get(ElementId::kCoordInPosTimeOut, static_cast<unsigned>(number_)) > 0; }

/// The path has to end before this command, until the motors are in position.
bool CoordSystem::holds_back(const motion::MotionCommand& command) {
  const bool may_blend = command.kind != motion::CommandKind::kPvt && command.compensation_side == 0 && !compensation_.active();
  if (!on_path_ || !may_blend || !waits_in_position() || pvt_goes_on()) return false;
  motion::MotionCommand placed = command;
  if (frame_.place(machine_.elements, placed_uu_, calculated_uu_, placed)) return false;   // said when it is added
  const std::optional<double> dwell_ms = pipeline_.stop_by_rule_ms(placed);
  settled_dwell_ms_ = dwell_ms.value_or(0);
  return dwell_ms.has_value();
}

/// Commanded motion is at rest. dwell_ms: of a corner rule, once the motors are in position.
void CoordSystem::settle(double time_ms, double dwell_ms) {
  phase_ = Phase::kSettling;
  settled_dwell_ms_ = dwell_ms;
  settle_until_ms_ = time_ms + machine_.elements.get(ElementId::kCoordInPosTimeOut, static_cast<unsigned>(number_));
  resume_ms_ = machine_.rti_at_or_after_ms(time_ms);
}

void CoordSystem::go_on_settled(double time_ms) {
  const std::string who = settle_until_ms_ < kNever ? who_is_out_of_position() : std::string();
  if (who.empty()) {
    if (settled_dwell_ms_ <= 0) return go_on(time_ms);
    settle_until_ms_ = kNever;   // has settled, and dwells
    resume_ms_ = time_ms + std::exchange(settled_dwell_ms_, 0);
    return;
  }
  resume_ms_ = std::min(machine_.next_rti_ms(time_ms), std::max(settle_until_ms_, machine_.now_ms));
  if (time_ms >= settle_until_ms_) fail(time_ms, {FaultKind::kInPosition, item_source_, who});
}

/// The first motor that is not in position, as a message; empty: all are.
std::string CoordSystem::who_is_out_of_position() {
  for (int motor : motors_) {
    const Motor& m = machine_.motors[static_cast<std::size_t>(motor)];
    const auto n = static_cast<unsigned>(motor);
    if (m.coord != number_ || !m.has_axis()) continue;
    if (read_element_value(machine_, runner_, {ElementId::kMotorInPos, {n}}) != 0) continue;
    return fmt::format("motor {} is not in position within Coord[{}].InPosTimeOut = {} ms: following error {}, Motor[{}].InPosBand {}", motor, number_,
                       number_text(machine_.elements.get(ElementId::kCoordInPosTimeOut, static_cast<unsigned>(number_))),
                       number_text(m.following_error_mu()), motor, number_text(machine_.elements.get(ElementId::kMotorInPosBand, n)));
  }
  return {};
}

}  // namespace pmac::runtime
