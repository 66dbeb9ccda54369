// save keeps the set-up: saved elements, axis definitions, pointers and buffers. $$$ goes back to what was saved, $$$*** to the
// factory's defaults; both stop everything at once, with every motor at rest at position 0. Variables become 0. Simulated time goes on.
// Source: Software Reference Manual p62; what becomes of positions and variables: assumed.
#include <algorithm>
#include <utility>

#include "compiler/bytecode/element.h"
#include "runtime/state.h"

namespace pmac::runtime {
namespace {

using bytecode::ElementId;

/// Of the motors that still belong to the coordinate system.
std::vector<SavedAxis> axes_in_force(const Machine::State& s) {
  std::vector<SavedAxis> result;
  for (const auto& [motor, axis] : s.axis_definitions)
    if (s.motors[static_cast<std::size_t>(motor)].coord == axis.coord) result.push_back(axis);
  return result;
}

/// Coordinate systems, motors, PLCs and variables as after power-up.
void clear(Machine::State& s) {
  s.queued.clear();
  for (Plc& plc : s.plcs) plc = Plc{};
  for (int n = 0; n < bytecode::kMaxCoords; ++n) {
    auto fresh = std::make_unique<CoordSystem>(s, n);
    fresh->observe(s.coord(n).observers());
    s.coords[static_cast<std::size_t>(n)] = std::move(fresh);
  }
  for (Motor& m : s.motors) {
    const bool in_use = m.in_use;
    const int number = m.number;
    m = Motor{};
    m.number = number;
    m.in_use = in_use;
  }
  std::fill(s.p.begin(), s.p.end(), 0.0);
  std::fill(s.i_values.begin(), s.i_values.end(), 0.0);
  s.pointers = PointerTable();
  s.axis_definitions.clear();
  s.progs.clear();
  s.subprogs.clear();
  s.plc_programs.clear();
  s.gather.set_enable(0);
  s.command_addresses.clear();
  Thread& thread = s.online->thread;
  thread.coord = thread.motor = 1;
  thread.q = s.coord(1).q.data();
}

/// The machine around the controller (Sim.) does not change when the controller resets.
void keep_surroundings(const ElementStore& before, ElementStore& after) {
  const auto first = static_cast<unsigned>(ElementId::kSimMotorTriggerPos), last = static_cast<unsigned>(ElementId::kSimMotorFriction);
  for (unsigned id = first; id <= last; ++id)
    for (unsigned motor = 0; motor < bytecode::kMaxMotors; ++motor)
      if (before.assigned(static_cast<ElementId>(id), motor)) after.assign({static_cast<ElementId>(id), {motor}}, before.get(static_cast<ElementId>(id), motor));
}

void restore(Machine::State& s, const Configuration& saved) {
  for (const auto& [address, value] : saved.elements) {
    s.elements.assign(address, value);
    if (address.id == ElementId::kCoordLHSize) s.coord(static_cast<int>(address.index[0])).lookahead_buffer = static_cast<int>(value);
  }
  for (const SavedAxis& axis : saved.axes) {
    s.coord(axis.coord).define(axis.definition, axis.motor);
    s.axis_definitions[axis.motor] = axis;
  }
  s.pointers = saved.pointers;
  s.progs = saved.progs;
  s.subprogs = saved.subprogs;
  s.plc_programs = saved.plc_programs;
  for (int n = 0; n < bytecode::kMaxCoords; ++n) {
    s.coord(n).forward = saved.forward[static_cast<std::size_t>(n)];
    s.coord(n).inverse = saved.inverse[static_cast<std::size_t>(n)];
  }
}

}  // namespace

void Machine::State::save() {
  Configuration c;
  c.elements = elements.saved();
  c.axes = axes_in_force(*this);
  c.pointers = pointers;
  c.progs = progs;
  c.subprogs = subprogs;
  c.plc_programs = plc_programs;
  for (const auto& coord : coords) {
    c.forward.push_back(coord->forward);
    c.inverse.push_back(coord->inverse);
  }
  saved = std::make_unique<Configuration>(std::move(c));
}

void Machine::State::request_reset(bool factory) {
  pending_reset = factory ? Reset::kFactory : Reset::kSaved;
  if (!programs_execute) reset_now();
}

void Machine::State::reset_now() {
  const bool factory = pending_reset == Reset::kFactory;
  if (pending_reset == Reset::kNone) return;
  pending_reset = Reset::kNone;
  const double period_ms = servo_period_ms;
  const ElementStore before = std::exchange(elements, ElementStore());
  keep_surroundings(before, elements);
  clear(*this);
  if (!factory && saved) restore(*this, *saved);
  if (factory) elements.set(ElementId::kSysDefault, 1);
  if (tick > 0) {  // the clocks are fixed from the first servo interrupt on
    elements.set(ElementId::kSysServoPeriod, period_ms);
    elements.set(ElementId::kSysRtIntPeriod, static_cast<double>(rti_cycles - 1));
  }
  servo_period_ms = elements.get(ElementId::kSysServoPeriod);
  rti_cycles = static_cast<std::int64_t>(elements.get(ElementId::kSysRtIntPeriod)) + 1;
  rti_asked_cycles = 0;
}

}  // namespace pmac::runtime
