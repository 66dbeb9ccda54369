#include "runtime/motor_faults.h"

#include <utility>

#include <fmt/format.h>

#include "compiler/bytecode/element.h"
#include "runtime/motor_moves.h"
#include "runtime/servo/servo_cycle.h"

namespace pmac::runtime {
namespace {

using bytecode::ElementId;
using Kind = ServoTrip::Kind;

/// The coordinate system whose motors share the motor's faults; none: it is alone.
CoordSystem* coord_of(Machine::State& s, const Motor& m) { return m.shares_with >= 0 ? &s.coord(m.shares_with) : nullptr; }

/// The line of the program or command that moves it.
bytecode::SourceLine source_of(Machine::State& s, const Motor& m) {
  CoordSystem* c = coord_of(s, m);
  return c && c->program_active() ? c->executing_source(s.now_ms) : m.jog_source;
}

/// It and all that share its faults come to rest with their abort ramps.
void abort_all(Machine::State& s, Motor& m) {
  if (CoordSystem* c = coord_of(s, m)) c->abort(s.now_ms);
  else abort_motor(s, m);
}

void kill_others(Machine::State& s, const Motor& faulty) {
  for (Motor& m : s.motors)
    if (m.number != faulty.number && faulty.shares_with >= 0 && m.shares_with == faulty.shares_with) m.kill(s.now_ms);
}

void report(Machine::State& s, const Motor& m, Fault fault) { s.report_fault({s.now_ms, m.shares_with, -1, std::move(fault), m.number}); }

/// The motor is killed; the others are aborted or killed.
void fail_motor(Machine::State& s, Motor& m, Fault fault) {
  const bool kills_all = (static_cast<long>(s.elements.get(ElementId::kMotorFaultMode, static_cast<unsigned>(m.number))) & 1) != 0;
  abort_all(s, m);
  m.kill(s.now_ms);
  if (kills_all) kill_others(s, m);
  report(s, m, std::move(fault));
}

void following_error(Machine::State& s, Motor& m, double error_mu) {
  const double limit_mu = s.elements.get(ElementId::kMotorFatalFeLimit, static_cast<unsigned>(m.number));
  Fault fault{FaultKind::kFollowingError, source_of(s, m),
              fmt::format("motor {} is killed: its following error of {:.6g} motor units exceeds Motor[{}].FatalFeLimit = {}", m.number, error_mu, m.number, limit_mu)};
  fail_motor(s, m, std::move(fault));
  m.following_fatal = true;
}

void amplifier_fault(Machine::State& s, Motor& m) {
  Fault fault{FaultKind::kAmplifier, source_of(s, m), fmt::format("motor {} is killed: its amplifier reports a fault", m.number)};
  fail_motor(s, m, std::move(fault));
  m.amplifier_fault = true;
}

void overtravel(Machine::State& s, Motor& m, bool plus, double actual_raw_mu) {
  CoordSystem* c = coord_of(s, m);
  const bool in_program = c && c->program_running();
  Fault fault{FaultKind::kOvertravel, source_of(s, m),
              fmt::format("motor {} is at its {} overtravel switch, at {:.6g} motor units from power-on; it stops with AbortTa", m.number, plus ? "positive" : "negative",
                          actual_raw_mu)};
  abort_all(s, m);
  m.limit_stop = Motor::LimitStop::kSwitch;
  if (in_program) report(s, m, std::move(fault));
  else s.warn(fault.source, fault.detail);
}

void software_limit(Machine::State& s, Motor& m, bool plus, double commanded_mu) {
  CoordSystem* c = coord_of(s, m);
  const PositionRange range = software_limits(s.elements, m.number);
  Fault fault{FaultKind::kSoftLimit, source_of(s, m),
              fmt::format("motor {} passes {} at {:.6g} motor units; it stops with AbortTa", m.number, limit_text(m.number, plus, range), commanded_mu)};
  if (c) c->fail_at_once(s.now_ms, std::move(fault));
  m.limit_stop = plus ? Motor::LimitStop::kPlusPosition : Motor::LimitStop::kMinusPosition;
}

/// The actual position: all motors come to rest with their abort ramps, whatever moves them.
void actual_limit(Machine::State& s, Motor& m, bool plus, double actual_mu) {
  CoordSystem* c = coord_of(s, m);
  const bool in_program = c && c->program_running();
  const ElementId limit = plus ? ElementId::kMotorMaxPos : ElementId::kMotorMinPos;
  Fault fault{FaultKind::kSoftLimit, source_of(s, m),
              fmt::format("the actual position of motor {}, {:.6g} motor units, is beyond Motor[{}].{} = {}; it stops with AbortTa", m.number, actual_mu,
                          m.number, plus ? "MaxPos" : "MinPos", s.elements.get(limit, static_cast<unsigned>(m.number)))};
  if (in_program) {
    c->fail_at_once(s.now_ms, std::move(fault));
  } else {
    abort_all(s, m);
    s.warn(fault.source, fault.detail);
  }
  m.limit_stop = plus ? Motor::LimitStop::kPlusPosition : Motor::LimitStop::kMinusPosition;
}

}  // namespace

void react_to_trips(Machine::State& s) {
  for (const ServoTrip& trip : std::exchange(s.trips, {})) {
    Motor& m = s.motors[static_cast<std::size_t>(trip.motor)];
    switch (trip.kind) {
      case Kind::kFollowingError: following_error(s, m, trip.value_mu); break;
      case Kind::kAmplifier: amplifier_fault(s, m); break;
      case Kind::kPlusSwitch:
      case Kind::kMinusSwitch: overtravel(s, m, trip.kind == Kind::kPlusSwitch, trip.value_mu); break;
      case Kind::kPlusPosition:
      case Kind::kMinusPosition: software_limit(s, m, trip.kind == Kind::kPlusPosition, trip.value_mu); break;
      case Kind::kPlusActual:
      case Kind::kMinusActual: actual_limit(s, m, trip.kind == Kind::kPlusActual, trip.value_mu); break;
      case Kind::kTrigger: trigger_captured(s, m, trip.value_mu); break;
    }
  }
}

}  // namespace pmac::runtime
