// pread, vread, dread, fread and tread: what the axes of a coordinate system do at the present time, for programs. Source: User's
// Manual p513-516; values go to D(axis index) and their mask to D32. pread answers actual positions, dread commanded ones.
#include <fmt/format.h>

#include "compiler/bytecode/control.h"
#include "compiler/bytecode/element.h"
#include "compiler/bytecode/missing.h"
#include "runtime/state.h"

namespace pmac::runtime {
namespace {

using bytecode::ControlVerb;
using bytecode::ElementId;

constexpr std::size_t kMaskVariable = 32;   // D32

AxisVector axis_values(Machine::State& s, CoordSystem& coord, int number, ControlVerb verb) {
  switch (verb) {
    case ControlVerb::kVread: {
      AxisVector velocity = coord.commanded_velocity_uu_ms(s.now_ms);
      const double feed_time_ms = s.elements.get(ElementId::kCoordFeedTime, static_cast<unsigned>(number));
      for (double& value : velocity) value *= feed_time_ms;
      return velocity;
    }
    case ControlVerb::kFread: return coord.following_error_uu(s.now_ms);
    case ControlVerb::kPread: return coord.actual_position(s.now_ms);
    case ControlVerb::kTread: return coord.calculated_position();
    default: return coord.commanded_position(s.now_ms);
  }
}

}  // namespace

std::string read_axes(Machine::State& s, int number, ControlVerb verb, double wanted_axes, Thread& thread) {
  CoordSystem& coord = s.coord(number);
  if (!coord.map().solvable() && !coord.has_forward()) return fmt::format("error #39: NOT READY TO RUN: coordinate system {}: {}", number, coord.map().reason());
  const AxisVector values = axis_values(s, coord, number, verb);
  const bool all = bytecode::is_missing(wanted_axes);
  if (!all && !(wanted_axes >= 0 && wanted_axes <= 4294967295.0)) return fmt::format("error #23: OUT OF RANGE NUMBER: a mask of axes of {}", number_text(wanted_axes));
  const std::uint32_t mask = coord.axes_with_motors() & (all ? 0xffffffffu : static_cast<std::uint32_t>(wanted_axes));
  for (std::size_t axis = 0; axis < values.size(); ++axis)
    if (mask >> axis & 1u) thread.d[axis] = values[axis];
  thread.d[kMaskVariable] = mask;
  return {};
}

}  // namespace pmac::runtime
