// Set-up and program control of a coordinate system. Source: axis definitions, User's Manual p501-510; program control and its
// refusals, p689-698.
#include "runtime/coordinate/coord_system.h"

#include <algorithm>

#include <fmt/format.h>

#include "compiler/bytecode/element.h"
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
  std::erase_if(definitions_, [&](const auto& d) { return d.motor == motor; });
  const kinematics::MotorDefinition d = to_kinematics(definition, motor);
  definitions_.push_back(d);
  std::sort(definitions_.begin(), definitions_.end(), [](const auto& a, const auto& b) { return a.motor < b.motor; });
  map_ = kinematics::AxisMap(definitions_);
  motors_.clear();
  for (const auto& row : definitions_) motors_.push_back(row.motor);
  const bool null = d.kind == kinematics::MotorDefinition::Kind::kNull;
  m.coord = null ? -1 : number_;
  m.in_use = m.in_use || !null;
  return {};
}

std::string CoordSystem::begin(std::uint32_t number, std::int64_t label) {
  if (program_running()) return "error #38: PROGRAM RUNNING: abort it first";
  const auto it = machine_.progs.find(number);
  if (it == machine_.progs.end()) return fmt::format("error #22: PROGRAM NOT IN BUFFER: there is no motion program {}", number);
  pointed_ = it->second;
  pointed_label_ = label;
  return {};
}

std::string CoordSystem::run(double time_ms) {
  if (program_running()) return "error #38: PROGRAM RUNNING: the coordinate system executes a program already";
  if (!pointed_) return "error #39: NOT READY TO RUN: no program selected; use b{number} first";
  for (int motor : motors_) {
    const Motor& m = machine_.motors[static_cast<std::size_t>(motor)];
    if (m.coord != number_) continue;
    if (!m.closed_loop) return fmt::format("error #43: MOTOR NOT CLOSED LOOP: motor {}", motor);
    if (machine_.elements.get(ElementId::kMotorServoCtrl, static_cast<unsigned>(motor)) <= 0)
      return fmt::format("error #45: MOTOR NOT ACTIVE: Motor[{}].ServoCtrl is 0", motor);
    if (m.moving()) return fmt::format("error #39: NOT READY TO RUN: motor {} is moving", motor);
  }
  if (std::string refusal = match_positions(time_ms); !refusal.empty()) return refusal;
  if (motor_map().motors.empty())
    machine_.warn(pointed_.program->source, fmt::format("coordinate system {} has no motors; the program runs dry", number_));
  if (!runner_.thread.begin(pointed_, pointed_label_))
    return fmt::format("error #35: INVALID LABEL: program {} has no label N{}", pointed_.program->number, pointed_label_);
  runner_.thread.coord = number_;
  runner_.thread.q = q.data();
  machine_.elements.set(ElementId::kCoordErrorStatus, 0, static_cast<unsigned>(number_));
  block_ = {};
  stop_requested_ = false;
  sync_.clear();
  phase_ = Phase::kCalculating;
  resume_ms_ = time_ms;
  return {};
}

void CoordSystem::abort(double time_ms) {
  std::vector<double> position(path_map_.motors.size()), velocity(path_map_.motors.size());
  if (on_path_) pipeline_.sample(std::max(time_ms, sampled_to_ms_), 1.0, 1, position, velocity);
  for (std::size_t i = 0; on_path_ && i < path_map_.motors.size(); ++i) {
    Motor& m = machine_.motors[static_cast<std::size_t>(path_map_.motors[i])];
    m.position_mu = position[i];
    m.velocity_mu_ms = velocity[i];
  }
  on_path_ = false;
  for (int motor : motors_) {
    Motor& m = machine_.motors[static_cast<std::size_t>(motor)];
    if (m.coord != number_ || !m.moving()) continue;
    const auto n = static_cast<unsigned>(motor);
    const motion::JogParameters stop{0, machine_.elements.get(ElementId::kMotorAbortTa, n),
                                     machine_.elements.get(ElementId::kMotorAbortTs, n)};
    m.follow(motion::MotorProfile::stop(time_ms, m.position_at(time_ms), m.velocity_at(time_ms), stop));
  }
  runner_.thread.stop();
  sync_.clear();
  due_.clear();
  pending_moves_.clear();
  block_ = {};
  phase_ = Phase::kIdle;
  resume_ms_ = kNever;
}

void CoordSystem::fail(double time_ms, Fault fault) {
  abort(time_ms);
  machine_.elements.set(ElementId::kCoordErrorStatus, error_status(fault.kind), static_cast<unsigned>(number_));
  machine_.report_fault({time_ms, number_, -1, std::move(fault)});
}

bool CoordSystem::executes(const bytecode::Program* program) const {
  return program_running() && (runner_.thread.program().program == program || runner_.thread.top_program().program == program);
}

void CoordSystem::observe(motion::StageObservers observers) {
  observers_ = std::move(observers);
  pipeline_.observe(observers_);
}

}  // namespace pmac::runtime
