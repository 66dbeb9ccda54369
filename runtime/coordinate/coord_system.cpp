// Set-up of a coordinate system. Source: axis definitions, User's Manual p501-510. Program control is in control.cpp.
#include "runtime/coordinate/coord_system.h"

#include <algorithm>

#include <fmt/format.h>

#include "compiler/bytecode/element.h"
#include "runtime/motion/segment.h"
#include "runtime/state.h"

namespace pmac::runtime {

using bytecode::ElementId;

CoordSystem::CoordSystem(Machine::State& machine, int number)
    : q(bytecode::kQCount, 0.0),
      machine_(machine),
      number_(number),
      runner_(RunnerKind::kMotionProgram, number, machine.p.data(), q.data()),
      kinematics_(RunnerKind::kKinematics, number, machine.p.data(), q.data()) {
  runner_.thread.coord = kinematics_.thread.coord = number;
  runner_.thread.own_coord = kinematics_.thread.own_coord = number;
  observe({});
}

CoordSystem::~CoordSystem() = default;

namespace {

kinematics::MotorDefinition to_kinematics(const bytecode::AxisDefinition& definition, int motor) {
  using Kind = kinematics::MotorDefinition::Kind;
  kinematics::MotorDefinition d;
  d.motor = motor;
  d.offset_mu = definition.offset_mu;
  switch (definition.kind) {
    case bytecode::AxisDefinitionKind::kNull: d.kind = Kind::kNull; break;
    case bytecode::AxisDefinitionKind::kInverseKinematics: d.kind = Kind::kInverse; break;
    case bytecode::AxisDefinitionKind::kSpindle: d.kind = Kind::kSpindle; break;
    default: d.kind = Kind::kLinear;
  }
  for (const bytecode::AxisTerm& term : definition.terms) d.coefficient_mu_uu[term.axis] += term.coefficient_mu_per_uu;
  return d;
}

}  // namespace

std::string CoordSystem::define(const bytecode::AxisDefinition& definition, int motor) {
  Motor& m = machine_.motors[static_cast<std::size_t>(motor)];
  if (program_running()) return fmt::format("error #38: PROGRAM RUNNING: coordinate system {} executes a program", number_);
  if (m.coord >= 0 && m.coord != number_ && definition.kind != bytecode::AxisDefinitionKind::kNull)
    return fmt::format("error #21: ILLEGAL PARAMETER: motor {} belongs to coordinate system {}; define #{}->0 there first", motor,
                       m.coord, motor);
  if (m.coord >= 0 && m.coord != number_) {  // a null definition here takes it out of its own system
    if (const std::string refusal = machine_.coord(m.coord).define(definition, motor); !refusal.empty()) return refusal;
  }
  std::erase_if(definitions_, [&](const auto& d) { return d.motor == motor; });
  const kinematics::MotorDefinition d = to_kinematics(definition, motor);
  definitions_.push_back(d);
  std::sort(definitions_.begin(), definitions_.end(), [](const auto& a, const auto& b) { return a.motor < b.motor; });
  map_ = kinematics::AxisMap(definitions_);
  motors_.clear();
  for (const auto& row : definitions_) motors_.push_back(row.motor);
  const bool null = d.kind == kinematics::MotorDefinition::Kind::kNull;
  m.coord = null ? -1 : number_;
  m.shares_with = number_;
  m.spindle = d.kind == kinematics::MotorDefinition::Kind::kSpindle ? static_cast<Motor::Spindle>(definition.spindle + 1) : Motor::Spindle::kNo;
  m.in_use = m.in_use || !null;
  return {};
}

void CoordSystem::fail(double time_ms, Fault fault) {
  machine_.catch_up();
  const bool ends_on_path = fault.kind == FaultKind::kSoftLimit && on_path_ && lookahead_ && !limit_fault_;
  if (ends_on_path) stop_at_limit(time_ms, std::move(fault));
  else fail_at_once(time_ms, std::move(fault));
}

void CoordSystem::fail_at_once(double time_ms, Fault fault) {
  abort(time_ms);
  const bool of_routine = fault.kind == FaultKind::kInverseKinematics && kinematics_.error_status != 0;
  const double status = of_routine ? kinematics_.error_status : error_status(fault.kind);
  machine_.elements.set(ElementId::kCoordErrorStatus, status, static_cast<unsigned>(number_));
  machine_.report_fault({time_ms, number_, -1, std::move(fault)});
}

bytecode::SourceLine CoordSystem::line_at(double time_ms) const { return runner_.thread.active() ? runner_.thread.source() : executing_source(time_ms); }

bool CoordSystem::executes(const bytecode::Program* program) const {
  return program_active() && (runner_.thread.program().program == program || runner_.thread.top_program().program == program);
}

void CoordSystem::observe(motion::StageObservers observers) {
  observers_ = std::move(observers);
  motion::StageObservers all = observers_;
  if (machine_.options.limit_jerk && machine_.options.observers.jerk_join)
    all.timed_segment = [this](const motion::TimedSegment& segment) {
      if (observers_.timed_segment) observers_.timed_segment(segment);
      if (segment.jerk_step > 0)
        machine_.options.observers.jerk_join({time_base_.time_at(segment.start_ms), number_, segment.segment.source, segment.jerk_step});
    };
  pipeline_.observe(std::move(all));
}

}  // namespace pmac::runtime
