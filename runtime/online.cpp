// Control verbs: program control, jogs, enabling and disabling, from programs and from command lines. Source: User's Manual p689-698;
// jog commands, Software Reference Manual p74; what is not simulated is refused with a reason.
#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "compiler/bytecode/control.h"
#include "compiler/bytecode/element.h"
#include "runtime/answer.h"
#include "runtime/motor_moves.h"
#include "runtime/online_call.h"
#include "runtime/state.h"

namespace pmac::runtime {

using bytecode::ControlVerb;
using bytecode::ElementId;

/// Number of the coordinate system or motor a verb acts on; -1 (with a refusal) where there is none.
int number_or(const Call& call, int addressed, int limit, const char* what) {
  const double given = call.argument(0);
  const double number = bytecode::is_missing(given) ? addressed : std::trunc(given);
  if (number >= 0 && number < limit) return static_cast<int>(number);
  call.refusal = fmt::format("error #23: OUT OF RANGE NUMBER: there is no {} {}", what, number_text(number));
  return -1;
}

Flow not_simulated(const Call& call) {
  call.refusal = fmt::format("error #20: ILLEGAL CMD: {} is not simulated", control_verb_name(call.verb));
  return Flow::kContinue;
}

Flow abort_coord(const Call& call, CoordSystem& coord, int number) {
  Runner& r = call.runner;
  const bool inside = (r.kind == RunnerKind::kMotionProgram || r.kind == RunnerKind::kKinematics) && r.number == number;
  if (!inside) {
    coord.abort(call.s.now_ms);
    return Flow::kContinue;
  }
  if (r.kind == RunnerKind::kKinematics) r.aborted = true;
  else coord.stop_program_from_inside();
  return Flow::kStop;
}

namespace {


int own_coord(const Call& call) {
  const Runner& r = call.runner;
  return r.kind == RunnerKind::kMotionProgram || r.kind == RunnerKind::kKinematics ? r.number : r.thread.coord;
}

Flow begin_coord(const Call& call, CoordSystem& coord) {
  const double program = call.argument(1);
  if (!(program >= 0 && program < 4294967296.0)) {
    call.refusal = fmt::format("error #23: OUT OF RANGE NUMBER: program {}", number_text(program));
    return Flow::kContinue;
  }
  const double label = std::round((program - std::floor(program)) * 1e6);
  call.refusal = coord.begin(static_cast<std::uint32_t>(program), label > 0 ? static_cast<std::int64_t>(label) : -1);
  return Flow::kContinue;
}

void define_lookahead(const Call& call, CoordSystem& coord) {
  const double segments = call.argument(1);
  if (!(segments >= 1 && segments <= 1e8)) call.refusal = "error #23: OUT OF RANGE NUMBER: lookahead buffer size";
  else if (coord.program_running()) call.refusal = "error #38: PROGRAM RUNNING";
  else coord.lookahead_buffer = static_cast<int>(segments);
}

/// pmatch, pset, pclr, pstore, pload: the program's own wait for rest, others need a coordinate system at rest.
Flow change_positions(const Call& call, CoordSystem& coord, const PositionChange& change) {
  if (call.runner.kind == RunnerKind::kMotionProgram && &coord.runner() == &call.runner) return coord.change_positions(call.runner.thread, change);
  if (coord.program_running()) call.refusal = "error #38: PROGRAM RUNNING: positions of a coordinate system that executes a program";
  else call.refusal = coord.change_positions(call.s.now_ms, change);
  return Flow::kContinue;
}

Flow pset(const Call& call) {
  const double axis = call.argument(0);
  if (axis >= 0 && axis < bytecode::kAxisCount)
    return change_positions(call, call.s.coord(own_coord(call)), {call.verb, static_cast<int>(axis), call.argument(1)});
  call.refusal = "error #23: OUT OF RANGE NUMBER: pset of no axis";
  return Flow::kContinue;
}

/// disable kills at once, ddisable after the brakes' delay, adisable when the motors have come to rest and after that delay. The program is
/// aborted by all of them.
Flow disable_motors(const Call& call, CoordSystem& coord, int number) {
  const double now = call.s.now_ms;
  const Flow flow = abort_coord(call, coord, number);
  for (int motor : coord.motors()) {
    Motor& m = call.s.motors[static_cast<std::size_t>(motor)];
    if (call.verb == ControlVerb::kDisable) m.kill(now);
    else if (call.verb == ControlVerb::kAbortDisable) m.kill_at_rest = true;
    else delay_kill(call.s, m, now);
  }
  return flow;
}

/// Starting, stopping and going on. A motion program that pauses or steps itself stops behind this line.
Flow program_verb(const Call& call, CoordSystem& coord, int number) {
  const double now = call.s.now_ms;
  Runner& r = call.runner;
  const bool inside = r.kind == RunnerKind::kMotionProgram && r.number == number;
  switch (call.verb) {
    case ControlVerb::kRun: call.refusal = coord.run(now); break;
    case ControlVerb::kResume: call.refusal = coord.resume(now); break;
    case ControlVerb::kForward: call.refusal = coord.forward_on_path(now); break;
    case ControlVerb::kRetrace: call.refusal = coord.retrace(now); break;
    case ControlVerb::kHold: call.refusal = coord.hold(now); break;
    case ControlVerb::kQuickStop: call.refusal = coord.quick_stop(now); break;
    case ControlVerb::kPause:
      if (inside) return coord.pause_from_inside(r.thread);
      call.refusal = coord.pause(now);
      break;
    default:
      if (inside) return coord.pause_from_inside(r.thread);
      call.refusal = coord.step(now);
  }
  return Flow::kContinue;
}

Flow coord_verb(const Call& call) {
  if (call.verb == ControlVerb::kPset) return pset(call);
  const int number = number_or(call, own_coord(call), bytecode::kMaxCoords, "coordinate system");
  if (number < 0) return Flow::kContinue;
  CoordSystem& coord = call.s.coord(number);
  switch (call.verb) {
    case ControlVerb::kAbort: return abort_coord(call, coord, number);
    case ControlVerb::kBegin: return begin_coord(call, coord);
    case ControlVerb::kStart:
      begin_coord(call, coord);
      if (call.refusal.empty()) call.refusal = coord.run(call.s.now_ms);
      return Flow::kContinue;
    case ControlVerb::kRun:
    case ControlVerb::kResume:
    case ControlVerb::kForward:
    case ControlVerb::kRetrace:
    case ControlVerb::kHold:
    case ControlVerb::kQuickStop:
    case ControlVerb::kPause:
    case ControlVerb::kStep: return program_verb(call, coord, number);
    case ControlVerb::kTimeBase: call.refusal = coord.set_time_base(call.s.now_ms, call.argument(1) / 100); return Flow::kContinue;
    case ControlVerb::kReportTimeBase: call.s.answer(fmt::format("{}", coord.time_base().rate_at(call.s.now_ms) * 100)); return Flow::kContinue;
    case ControlVerb::kPread:
    case ControlVerb::kVread:
    case ControlVerb::kDread:
    case ControlVerb::kFread:
    case ControlVerb::kTread: call.refusal = read_axes(call.s, number, call.verb, call.argument(1), call.runner.thread); return Flow::kContinue;
    case ControlVerb::kPmatch:
    case ControlVerb::kPclr:
    case ControlVerb::kPstore:
    case ControlVerb::kPload: return change_positions(call, coord, {call.verb});
    case ControlVerb::kDefineLookahead: define_lookahead(call, coord); return Flow::kContinue;
    case ControlVerb::kDeleteLookahead: coord.lookahead_buffer = 0; return Flow::kContinue;
    case ControlVerb::kEnable:
      for (int motor : coord.motors()) call.s.motors[static_cast<std::size_t>(motor)].enable();
      return Flow::kContinue;
    case ControlVerb::kDisable:
    case ControlVerb::kDelayedDisable:
    case ControlVerb::kAbortDisable: return disable_motors(call, coord, number);
    default: return not_simulated(call);
  }
}

/// Stands at the top of the program with locals 0.
void begin_plc(const Call& call, Plc& plc, int number, const ProgramHandle& program) {
  plc.runner = std::make_unique<Runner>(RunnerKind::kPlc, number, call.s.p.data(), call.s.coord(0).q.data());
  plc.runner->thread.ends_scans = true;
  plc.runner->thread.begin(program);
  plc.block = {};
  plc.active = true;
}

Flow plc_verb(const Call& call) {
  const double given = call.argument(0);
  if (!(given >= 0 && given < bytecode::kMaxPlcs)) {
    call.refusal = fmt::format("error #23: OUT OF RANGE NUMBER: there is no PLC {}", number_text(given));
    return Flow::kContinue;
  }
  const int number = static_cast<int>(given);
  Plc& plc = call.s.plcs[static_cast<std::size_t>(number)];
  const auto buffer = call.s.plc_programs.find(static_cast<std::uint32_t>(number));
  const bool starts = call.verb == ControlVerb::kEnablePlc || call.verb == ControlVerb::kResumePlc || call.verb == ControlVerb::kStepPlc;
  if (starts && buffer == call.s.plc_programs.end()) {
    call.refusal = fmt::format("error #22: PROGRAM NOT IN BUFFER: there is no PLC program {}", number);
    return Flow::kContinue;
  }
  switch (call.verb) {
    case ControlVerb::kEnablePlc:
      if (plc.runner.get() == &call.runner) break;  // enabling itself changes nothing
      begin_plc(call, plc, number, buffer->second);
      plc.running = true;
      break;
    case ControlVerb::kDisablePlc: plc.active = plc.running = false; break;
    case ControlVerb::kPausePlc: plc.running = false; break;
    case ControlVerb::kResumePlc:
      if (!plc.active) call.refusal = fmt::format("error #39: NOT READY TO RUN: PLC {} is not enabled", number);
      plc.running = plc.active;
      break;
    case ControlVerb::kStepPlc:
      if (call.runner.kind == RunnerKind::kPlc) {
        call.refusal = "error #21: ILLEGAL PARAMETER: PLC programs are stepped on line and from motion programs";
        break;
      }
      if (!plc.active) begin_plc(call, plc, number, buffer->second);
      plc.running = false;
      call.s.step_plc(number);
      break;
    default: return not_simulated(call);
  }
  return Flow::kContinue;
}

/// The pass of the program ends here; queued commands are executed at the end of every pass.
Flow send_all_commands(const Call& call) {
  Runner& r = call.runner;
  if (call.s.queued.empty() || r.kind == RunnerKind::kOnline) return Flow::kContinue;
  return r.kind == RunnerKind::kMotionProgram ? call.s.coord(r.number).wait_for_interrupt(r.thread) : Flow::kSuspend;
}

/// M5->: the definition as it would be written.
Flow report_pointer(const Call& call) {
  const double number = call.argument(0);
  if (!(number >= 0 && number < bytecode::kMCount)) {
    call.refusal = fmt::format("error #23: OUT OF RANGE NUMBER: M{}", number_text(number));
    return Flow::kContinue;
  }
  const int m = static_cast<int>(number);
  call.s.answer(definition_answer(call.s, fmt::format("M{}", m), pointer_definition_text(call.s, m)));
  return Flow::kContinue;
}

bool is_motor_verb(ControlVerb v) {
  return (v >= ControlVerb::kJogPlus && v <= ControlVerb::kOpenLoop) ||
         (v >= ControlVerb::kReportPosition && v <= ControlVerb::kReportStatus);
}

bool is_plc_verb(ControlVerb v) { return v >= ControlVerb::kEnablePlc && v <= ControlVerb::kStepPlc; }

/// What the list * stands for: motors that are in use, coordinate systems with motors or a program, PLC programs that exist.
std::vector<double> everything(Machine::State& s, ControlVerb verb) {
  std::vector<double> numbers;
  if (is_plc_verb(verb)) {
    for (const auto& [number, program] : s.plc_programs) numbers.push_back(number);
  } else if (is_motor_verb(verb)) {
    for (const Motor& m : s.motors)
      if (m.in_use) numbers.push_back(m.number);
  } else {
    for (int n = 0; n < bytecode::kMaxCoords; ++n)
      if (!s.coord(n).motors().empty() || s.coord(n).program_active()) numbers.push_back(n);
  }
  return numbers;
}

/// The verb for everything of its kind; the first refusal is the answer. A verb that the program has to wait for, once for each, is refused.
Flow execute_for_all(Machine::State& s, Runner& runner, ControlVerb verb, std::span<const double> arguments, std::string& refusal) {
  std::vector<double> one(arguments.begin(), arguments.end());
  Flow result = Flow::kContinue;
  const std::vector<double> numbers = everything(s, verb);
  for (const double number : numbers) {
    if (result == Flow::kSuspend) {
      refusal = fmt::format("error #21: ILLEGAL PARAMETER: the program waits for {}; list the motors instead of *", control_verb_name(verb));
      return Flow::kContinue;
    }
    one[0] = number;
    std::string reason;
    const bool together = verb == ControlVerb::kHome && number != numbers.back();
    const Flow flow = execute_control(s, runner, together ? ControlVerb::kHomeAlso : verb, one, reason);
    if (flow != Flow::kContinue) result = flow;
    if (refusal.empty()) refusal = reason;
  }
  return result;
}

}  // namespace

Flow execute_control(Machine::State& s, Runner& runner, ControlVerb verb, std::span<const double> arguments, std::string& refusal) {
  if (!arguments.empty() && bytecode::is_all(arguments[0])) return execute_for_all(s, runner, verb, arguments, refusal);
  if (is_report(verb)) {
    refusal = report(s, runner, verb, arguments);
    return Flow::kContinue;
  }
  const Call call{s, runner, verb, arguments, refusal};
  if (is_motor_verb(verb)) return motor_verb(call);
  if (is_plc_verb(verb)) return plc_verb(call);
  if (verb == ControlVerb::kSendAllCommands) return send_all_commands(call);
  if (verb == ControlVerb::kReportPointer) return report_pointer(call);
  if (verb == ControlVerb::kReset || verb == ControlVerb::kSave) return not_simulated(call);
  return coord_verb(call);
}

}  // namespace pmac::runtime
