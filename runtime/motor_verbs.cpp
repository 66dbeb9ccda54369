// Verbs of motors: jogs, home searches, kill, open loop. Source: jog commands, Software Reference Manual p74.
#include <cmath>

#include <fmt/format.h>

#include "compiler/bytecode/element.h"
#include "runtime/motor_faults.h"
#include "runtime/motor_moves.h"
#include "runtime/online_call.h"

namespace pmac::runtime {
namespace {

using bytecode::ControlVerb;
using bytecode::ElementId;

bool may_jog(const Call& call, const Motor& m) {
  const bool jogs = call.verb >= ControlVerb::kJogPlus && call.verb <= ControlVerb::kJogByActualTrigger && call.verb != ControlVerb::kJogStop;
  if (jogs && !(call.s.elements.get(ElementId::kMotorJogSpeed, static_cast<unsigned>(m.number)) > 0)) {
    call.refusal = fmt::format("error #21: ILLEGAL PARAMETER: Motor[{}].JogSpeed is not above 0", m.number);
    return false;
  }
  if (!m.closed_loop && call.verb != ControlVerb::kPhase) call.refusal = fmt::format("error #43: MOTOR NOT CLOSED LOOP: motor {}", m.number);
  else if (m.has_axis() && call.s.coord(m.coord).program_running())
    call.refusal = fmt::format("error #38: PROGRAM RUNNING: motor {} belongs to coordinate system {}, which executes a program", m.number, m.coord);
  return call.refusal.empty();
}

/// The loop of a motor opens. A program that is using the motor ends with a fault; one that opens the loop itself while the motor rests
/// goes on, and its next move is the fault.
Flow leave_closed_loop(const Call& call, const Motor& m) {
  Runner& r = call.runner;
  if (!m.has_axis() || !call.s.coord(m.coord).program_running()) return Flow::kContinue;
  CoordSystem& coord = call.s.coord(m.coord);
  if (r.kind == RunnerKind::kKinematics && r.number == m.coord) return abort_coord(call, coord, m.coord);
  const bool inside = r.kind == RunnerKind::kMotionProgram && r.number == m.coord;
  if (inside && !coord.on_path() && !m.moving()) return Flow::kContinue;
  Fault fault = killed_under_program(call.s, m);
  if (!inside) {
    coord.fail(call.s.now_ms, std::move(fault));
    return Flow::kContinue;
  }
  r.thread.set_host_fault(std::move(fault));
  return Flow::kFault;
}

/// dkill: the brake engages first.
Flow kill(const Call& call, Motor& m) {
  const Flow flow = leave_closed_loop(call, m);
  if (call.verb == ControlVerb::kKill) m.kill(call.s.now_ms);
  else delay_kill(call.s, m, call.s.now_ms);
  return flow;
}

/// The phase search of an ideal motor succeeds without a move, and leaves it in closed loop.
void phase(const Call& call, Motor& m) {
  call.s.elements.set(ElementId::kMotorPhaseFound, 1, static_cast<unsigned>(m.number));
  m.enable();
}

/// out{percent of Motor[].MaxDac}: it drives the mass of a plant; a motor without one stands.
Flow open_loop(const Call& call, Motor& m) {
  const double percent = call.argument(1);
  if (!(std::abs(percent) <= 100)) {
    call.refusal = fmt::format("error #23: OUT OF RANGE NUMBER: an open-loop output of {} %; it is -100 to 100 % of Motor[{}].MaxDac", number_text(percent), m.number);
    return Flow::kContinue;
  }
  const Flow flow = leave_closed_loop(call, m);
  m.kill(call.s.now_ms);
  m.amplifier_enabled = true;
  m.open_loop_share = percent / 100;
  m.in_use = m.in_use || percent != 0;
  const bool plant = call.s.elements.get(ElementId::kSimMotorPlant, static_cast<unsigned>(m.number)) != 0;
  if (percent != 0 && !plant)
    call.s.warn(call.runner.thread.source(), fmt::format("motor {} stands under its open-loop output of {} %: it has no mechanics; give it a plant: Sim.Motor[{}].Plant=1", m.number, percent, m.number));
  return flow;
}

/// The jogs and home searches, which need a motor that is free to move.
void move_motor(const Call& call, Motor& m) {
  Machine::State& s = call.s;
  const double now = s.now_ms;
  const bytecode::SourceLine source = call.runner.thread.source();
  const double given = call.argument(1);
  const double value = bytecode::is_missing(given) ? s.elements.get(ElementId::kMotorProgJogPos, static_cast<unsigned>(m.number)) : given;
  const double here = m.position_at(now);
  switch (call.verb) {
    case ControlVerb::kJogPlus: call.refusal = jog_endless(s, m, 1, source); break;
    case ControlVerb::kJogMinus: call.refusal = jog_endless(s, m, -1, source); break;
    case ControlVerb::kJogStop: jog_stop(s, m); break;
    case ControlVerb::kJogTo: call.refusal = jog_to(s, m, value, source); break;
    case ControlVerb::kJogToAndKeep: m.prejog_mu = value; call.refusal = jog_to(s, m, value, source); break;
    case ControlVerb::kJogBy: call.refusal = jog_to(s, m, here + value, source); break;
    case ControlVerb::kJogByActual: call.refusal = jog_to(s, m, m.actual_at(now) + value, source); break;
    case ControlVerb::kJogToTrigger: call.refusal = jog_to(s, m, value, source, call.argument(2)); break;
    case ControlVerb::kJogByActualTrigger: call.refusal = jog_to(s, m, m.actual_at(now) + value, source, call.argument(2)); break;
    case ControlVerb::kJogByTrigger: call.refusal = jog_to(s, m, here + value, source, call.argument(2)); break;
    case ControlVerb::kJogReturn: call.refusal = jog_to(s, m, m.prejog_mu, source); break;
    case ControlVerb::kHome:
    case ControlVerb::kHomeAlso: call.refusal = home(s, m, source); break;
    case ControlVerb::kHomeZero: m.home_here(now); break;
    case ControlVerb::kPhase: phase(call, m); break;
    default: not_simulated(call);
  }
}

}  // namespace

Flow motor_verb(const Call& call) {
  const int number = number_or(call, call.runner.thread.motor, bytecode::kMaxMotors, "motor");
  if (number < 0) return Flow::kContinue;
  Motor& m = call.s.motors[static_cast<std::size_t>(number)];
  switch (call.verb) {
    case ControlVerb::kKill:
    case ControlVerb::kDelayedKill: return kill(call, m);
    case ControlVerb::kOpenLoop: return open_loop(call, m);
    default: break;
  }
  if (call.verb == ControlVerb::kJogStop && !m.closed_loop) m.enable();  // j/ closes the loop
  const bool own_program = call.runner.kind == RunnerKind::kMotionProgram && m.coord == call.runner.number;
  const bool homes = call.verb == ControlVerb::kHome || call.verb == ControlVerb::kHomeAlso;
  if (call.verb == ControlVerb::kHomeZero && own_program) return call.s.coord(m.coord).home_zero(call.runner.thread, number);
  if (homes && call.runner.kind == RunnerKind::kMotionProgram)
    return call.s.coord(call.runner.number).home_motor(call.runner.thread, number, call.verb == ControlVerb::kHomeAlso);
  if (may_jog(call, m)) move_motor(call, m);
  return Flow::kContinue;
}

}  // namespace pmac::runtime
