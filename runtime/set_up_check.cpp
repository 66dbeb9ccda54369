#include "runtime/set_up_check.h"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "compiler/bytecode/element.h"
#include "runtime/fault.h"

namespace pmac::runtime {
namespace {

using bytecode::ElementId;

enum class Least { kZero, kAboveZero };

/// A value below its least is nonsense. effect: what the simulation does with such a value.
struct Row { ElementId id; Least least; std::string_view effect; };
constexpr Row kRows[] = {
    {ElementId::kMotorMaxSpeed, Least::kZero, "it limits nothing, and rapid moves are refused"},
    {ElementId::kMotorJogSpeed, Least::kZero, "jogs are refused"},
    {ElementId::kMotorInvAmax, Least::kZero, "it limits nothing"},
    {ElementId::kMotorInvDmax, Least::kZero, "it limits nothing"},
    {ElementId::kMotorInvJmax, Least::kZero, "it limits nothing"},
    {ElementId::kMotorInPosTime, Least::kZero, "it counts as 0"},
    {ElementId::kMotorInPosBand, Least::kZero, "it counts as 0"},
    {ElementId::kMotorBrakeOnDelay, Least::kZero, "it counts as 0"},
    {ElementId::kCoordSegMoveTime, Least::kZero, "moves are not segmented"},
    {ElementId::kCoordLHDistance, Least::kZero, "there is no lookahead"},
    {ElementId::kCoordFeedTime, Least::kAboveZero, "moves at a feed rate are refused"},
    {ElementId::kCoordMaxFeedRate, Least::kZero, "it limits nothing"},
    {ElementId::kCoordMaxCirAccel, Least::kZero, "it limits nothing"},
    {ElementId::kCoordTimeBaseSlew, Least::kAboveZero, "changes of the time base are refused"},
    {ElementId::kCoordFeedHoldSlew, Least::kAboveZero, "feed holds are refused"},
    {ElementId::kSysMaxRtPlc, Least::kZero, "no PLC program runs in the foreground"},
};

}  // namespace

std::string why_nonsense(const ElementAddress& element, double value) {
  if (element.id == ElementId::kMotorServoCtrl && value > 1)
    return fmt::format("{} = {} makes a gantry follower of Motor[{}].CmdMotor, which is not simulated; here the motor is an ordinary one. Define it on the "
                       "axis of its leader, as in #{}->1000X", element_text(element), number_text(value), element.index[0], element.index[0]);
  const auto* row = std::find_if(std::begin(kRows), std::end(kRows), [&](const Row& r) { return r.id == element.id; });
  if (row == std::end(kRows) || value > 0 || (value == 0 && row->least == Least::kZero)) return {};
  return fmt::format("{} is set to {}; it is {}; here {}", element_text(element), number_text(value), row->least == Least::kZero ? "0 or more" : "above 0", row->effect);
}

}  // namespace pmac::runtime
