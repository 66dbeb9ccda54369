// What a program reaches outside its registers: variables through pointers, elements, motion, commands. Each call knows its runner.
#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "compiler/bytecode/control.h"
#include "compiler/bytecode/element.h"
#include "compiler/bytecode/opcode.h"
#include "compiler/bytecode/operators.h"
#include "runtime/answer.h"
#include "runtime/motor_moves.h"
#include "runtime/set_up_check.h"
#include "runtime/state.h"
#include "runtime/trace.h"
#include "runtime/value_text.h"

namespace pmac::runtime {
namespace {

using bytecode::ElementAccess;
using bytecode::ElementId;
using bytecode::Opcode;
using bytecode::PointerKind;
using bytecode::VariableClass;

/// Sys.Cdata[] and its kin: as an M variable of the same place would write it.
void write_user_buffer(IoSpace& io, const ElementAddress& a, double value) {
  if (a.id == ElementId::kSysCdata) {
    io.user().write(a.index[0], static_cast<std::int8_t>(bytecode::integer_from(value)));
    return;
  }
  bytecode::PointerDefinition place;
  place.kind = a.id == ElementId::kSysDdata ? PointerKind::kUserDouble : a.id == ElementId::kSysFdata ? PointerKind::kUserFloat : PointerKind::kUserInteger;
  place.address = a.index[0] * (a.id == ElementId::kSysDdata ? 8 : 4);
  io.write(place, value);
}

class MachineHost : public Host {
 public:
  explicit MachineHost(Machine::State& state) : s_(state) {}

  InstructionWatcher* watcher() override { return s_.tracer && s_.tracer->open() ? s_.tracer.get() : nullptr; }

  double read_m(Thread& thread, int number) override {
    const PointerEntry& pointer = s_.pointers.at(number);
    switch (pointer.definition.kind) {
      case PointerKind::kSelf: return pointer.value;
      case PointerKind::kElement: return read_field(thread, pointer);
      default: return s_.io.read(pointer.definition);
    }
  }

  void write_m(Thread& thread, int number, double value) override {
    PointerEntry& pointer = s_.pointers.at(number);
    switch (pointer.definition.kind) {
      case PointerKind::kSelf: pointer.value = pointer.definition.has_field ? read_bits(write_bits(0, pointer.definition, value), pointer.definition) : value; break;
      case PointerKind::kElement: write_field(thread, pointer, value); break;
      default:
        if (s_.io.write(pointer.definition, value)) log_output(thread, number, pointer);
    }
  }

  double read_i(Thread& thread, int number) override {
    const bytecode::IVariable alias = bytecode::i_variable(number);
    if (alias.id == bytecode::kNoElement) return s_.i_values[static_cast<std::size_t>(number)];
    return read_element(thread, {alias.id, {alias.index, 0, 0}});
  }
  void write_i(Thread& thread, int number, double value) override {
    const bytecode::IVariable alias = bytecode::i_variable(number);
    if (alias.id != bytecode::kNoElement) return void(write_element(thread, {alias.id, {alias.index, 0, 0}}, value));
    if (number < kFirstFreeI) s_.warn(thread.source(), fmt::format("I{} is a plain variable here and sets no element", number));
    s_.i_values[static_cast<std::size_t>(number)] = value;
  }

  double read_element(Thread& thread, const ElementAddress& address) override {
    s_.catch_up();
    return read_element_value(s_, Runner::of(thread), address);
  }

  Flow write_element(Thread& thread, const ElementAddress& address, double value) override;
  double element_address(Thread&, const ElementAddress& address) override { return encode_address(address); }

  Flow motion(Thread& thread, const bytecode::Instruction& instruction, std::span<const double> registers) override {
    Runner& runner = Runner::of(thread);
    if (runner.kind == RunnerKind::kMotionProgram) return s_.coord(runner.number).motion(thread, instruction, registers);
    if (runner.kind == RunnerKind::kPlc) return plc_motion(thread, instruction, registers);
    if (is_block_word(instruction.op))
      return fault(thread, FaultKind::kNotSimulated, "axis moves, dwells and delays are simulated in motion and PLC programs only");
    return s_.coord(thread.coord).motion(thread, instruction, registers);
  }

  Flow control(Thread& thread, bytecode::ControlVerb verb, std::span<const double> arguments) override {
    s_.catch_up();
    Runner& runner = Runner::of(thread);
    std::string refusal;
    const Flow flow = execute_control(s_, runner, verb, arguments, refusal);
    if (refusal.empty()) return flow;
    if (runner.kind == RunnerKind::kOnline) {
      s_.refuse(std::string(control_verb_name(verb)), refusal);
      return Flow::kContinue;
    }
    return fault(thread, FaultKind::kNotReady, refusal);
  }

  Flow queue_assignment(Thread& thread, const bytecode::SyncTarget& target, const ElementAddress& element, double value) override {
    Runner& runner = Runner::of(thread);
    if (runner.kind == RunnerKind::kMotionProgram) return s_.coord(runner.number).queue_assignment(thread, target, element, value);
    s_.perform({target, element, value, 0, thread.source()}, s_.coord(thread.coord));  // in a PLC: at once
    return Flow::kContinue;
  }

  ProgramHandle find_subprogram(std::uint32_t number) override {
    const auto it = s_.subprogs.find(number);
    return it == s_.subprogs.end() ? ProgramHandle{} : it->second;
  }

  Flow command(Thread& thread, std::string_view text) override {
    s_.catch_up();
    if (s_.queued.size() >= kMaxQueuedCommands) return fault(thread, FaultKind::kRunTime, "too many cmd texts wait");
    s_.queued.push_back({Machine::State::sender_key(Runner::of(thread)), std::string(text), thread.source()});
    return Flow::kContinue;
  }

  Flow send(Thread&, int port, std::string_view text) override {
    s_.answer(fmt::format("[send {}] {}", port, text));
    return Flow::kContinue;
  }

  double random(double range) override {  // xorshift64*, seeded, the same on every machine
    s_.random_state ^= s_.random_state >> 12;
    s_.random_state ^= s_.random_state << 25;
    s_.random_state ^= s_.random_state >> 27;
    return range * (static_cast<double>(s_.random_state * 0x2545f4914f6cdd1dull >> 11) * 0x1p-53);
  }
  void seed_random(double seed) override {
    s_.random_state = (std::isfinite(seed) ? static_cast<std::uint64_t>(std::fmod(std::abs(seed), 9e15)) : 0) * 2 + 1;
  }

  Flow online(Thread& thread, const bytecode::Module& module, const bytecode::Instruction& instruction,
              std::span<const double> registers) override;

 private:
  static constexpr std::size_t kMaxQueuedCommands = 10'000;
  static constexpr int kFirstFreeI = 8192;

  static bool is_block_word(Opcode op) {
    return op == Opcode::kAxisWord || op == Opcode::kBlockEnd || op == Opcode::kDwell || op == Opcode::kDelay;
  }

  static Flow fault(Thread& thread, FaultKind kind, std::string detail) {
    thread.set_host_fault({kind, thread.source(), std::move(detail)});
    return Flow::kFault;
  }

  /// Axis moves of a PLC program are rapid moves that it does not wait for; dwell and delay do not make it wait. User's Manual p687-688.
  Flow plc_motion(Thread& thread, const bytecode::Instruction& instruction, std::span<const double> registers) {
    OpenBlock& block = s_.plcs[static_cast<std::size_t>(Runner::of(thread).number)].block;
    switch (instruction.op) {
      case Opcode::kAxisWord:
        block.add(static_cast<bytecode::WordKind>(instruction.c()), instruction.b(), registers[instruction.a]);
        return Flow::kContinue;
      case Opcode::kBlockEnd: return s_.coord(thread.coord).plc_move(thread, std::exchange(block, {}));
      case Opcode::kDwell:
      case Opcode::kDelay:
        s_.warn(thread.source(), "dwell and delay do not wait in a PLC program; count down Sys.CdTimer[] or compare Sys.Time");
        return Flow::kContinue;
      default: return s_.coord(thread.coord).motion(thread, instruction, registers);
    }
  }

  double read_field(Thread& thread, const PointerEntry& pointer) {
    s_.catch_up();
    const double word = read_element_value(s_, Runner::of(thread), pointer.element);
    return pointer.definition.has_field ? read_bit_field(word, pointer.definition) : word;
  }

  void write_field(Thread& thread, const PointerEntry& pointer, double value) {
    double word = value;
    if (pointer.definition.has_field)
      word = write_bit_field(read_element_value(s_, Runner::of(thread), pointer.element), pointer.definition, value);
    write_element(thread, pointer.element, word);
  }

  void log_output(Thread& thread, int number, const PointerEntry& pointer) {
    if (Runner::of(thread).kind == RunnerKind::kOnline || !s_.options.observers.output) return;
    const std::string name = pointer.definition.name.empty() ? fmt::format("M{}", number) : pointer.definition.name;
    s_.options.observers.output({s_.now_ms, name, s_.io.read(pointer.definition), s_.assignment_source.value_or(thread.source())});
  }

  Flow enable_gathering(Thread& thread, double value);
  Flow set_home_position(Thread& thread, Motor& m, double value);
  void define_axis(Thread& thread, const bytecode::AxisDefinition& definition);
  void define_pointer(const bytecode::Module& module, const bytecode::PointerDefinition& definition);
  void report_element(const bytecode::ElementRef& ref, double value);
  void install(Thread& thread, const bytecode::Program& program);

  Machine::State& s_;
};

Flow MachineHost::write_element(Thread& thread, const ElementAddress& a, double value) {
  s_.catch_up();
  Runner& runner = Runner::of(thread);
  const bytecode::ElementInfo& info = element_info(a.id);
  if (info.access == ElementAccess::kStatus) {
    const std::string text = element_text(a) + " is a status element and cannot be written";
    if (runner.kind != RunnerKind::kOnline) return fault(thread, FaultKind::kRunTime, text);
    s_.refuse(element_text(a), "error #70: " + text);
    return Flow::kContinue;
  }
  const bool simulated = a.id >= ElementId::kSimMotorTriggerPos && a.id <= ElementId::kSimMotorFriction;
  if ((info.access == ElementAccess::kSaved || simulated) && !std::isfinite(value)) {
    const std::string text = fmt::format("{} cannot be set to {}", element_text(a), std::isnan(value) ? "nan" : "an infinite value");
    if (runner.kind != RunnerKind::kOnline) return fault(thread, FaultKind::kRunTime, text);
    s_.refuse(element_text(a), "error #23: OUT OF RANGE NUMBER: " + text);
    return Flow::kContinue;
  }
  double rti = static_cast<double>(s_.rti_cycles - 1);
  switch (a.id) {
    case ElementId::kSysServoPeriod:
    case ElementId::kSysRtIntPeriod:
      if (s_.tick > 0 || !(value >= (a.id == ElementId::kSysServoPeriod ? 1e-3 : 0.0)) || value > 1e6)
        return fault(thread, FaultKind::kRunTime, fmt::format("{} cannot be set to {} now", info.name, number_text(value)));
      (a.id == ElementId::kSysServoPeriod ? s_.servo_period_ms : rti) = value;
      s_.rti_cycles = static_cast<std::int64_t>(rti) + 1;
      s_.rti_asked_cycles = 0;
      break;
    case ElementId::kSysCdTimer: s_.elements.assign(a, s_.now_ms + value); return Flow::kContinue;
    case ElementId::kSysP: s_.p[a.index[0]] = value; return Flow::kContinue;
    case ElementId::kSysCdata:
    case ElementId::kSysIdata:
    case ElementId::kSysUdata:
    case ElementId::kSysFdata:
    case ElementId::kSysDdata: write_user_buffer(s_.io, a, value); return Flow::kContinue;
    case ElementId::kCoordQ: s_.coord(static_cast<int>(a.index[0])).q[a.index[1]] = value; return Flow::kContinue;
    case ElementId::kLdataCoord:
      if (!(value >= 0 && value < bytecode::kMaxCoords)) return fault(thread, FaultKind::kRunTime, fmt::format("Ldata.Coord = {} is out of range", number_text(value)));
      thread.coord = static_cast<int>(value);
      if (runner.kind == RunnerKind::kPlc) thread.q = s_.coord(thread.coord).q.data();
      return Flow::kContinue;
    case ElementId::kLdataMotor:
      if (!(value >= 0 && value < bytecode::kMaxMotors)) return fault(thread, FaultKind::kRunTime, fmt::format("Ldata.Motor = {} is out of range", number_text(value)));
      thread.motor = static_cast<int>(value);
      return Flow::kContinue;
    case ElementId::kLdataGoBack: thread.go_back = value > 0 && value < 1e9 ? static_cast<int>(value) : 0; return Flow::kContinue;
    case ElementId::kLdataCmdStatus: thread.command_status = value > -1e9 && value < 1e9 ? static_cast<int>(value) : 0; return Flow::kContinue;
    case ElementId::kMotorHomePos: return set_home_position(thread, s_.motors[a.index[0]], value);
    case ElementId::kMotorHomeComplete: s_.motors[a.index[0]].home_complete = value != 0; return Flow::kContinue;
    case ElementId::kGatherEnable: return enable_gathering(thread, value);
    case ElementId::kCoordLHSize: s_.coord(static_cast<int>(a.index[0])).lookahead_buffer = value >= 1 && value <= 1e8 ? static_cast<int>(value) : 0; break;
    case ElementId::kCoordDesTimeBase: {
      const std::string refusal = s_.coord(static_cast<int>(a.index[0])).set_time_base(s_.now_ms, value / s_.period_ms());
      if (refusal.empty()) return Flow::kContinue;
      if (runner.kind != RunnerKind::kOnline) return fault(thread, FaultKind::kRunTime, refusal);
      s_.refuse(element_text(a), refusal);
      return Flow::kContinue;
    }
    case ElementId::kCoordErrorStatus:
      s_.elements.assign(a, value);
      if (value == 0) return Flow::kContinue;
      if (runner.kind == RunnerKind::kKinematics && runner.number == static_cast<int>(a.index[0])) {
        runner.aborted = true;
        runner.error_status = value;
        return Flow::kStop;
      }
      if (s_.coord(static_cast<int>(a.index[0])).program_running()) {
        CoordSystem& c = s_.coord(static_cast<int>(a.index[0]));
        if (&c.runner() == &runner)
          return fault(thread, FaultKind::kUserStatus, fmt::format("the program set Coord[{}].ErrorStatus to {}", a.index[0], number_text(value)));
        c.fail(s_.now_ms, {FaultKind::kUserStatus, thread.source(), fmt::format("Coord[{}].ErrorStatus was set to {}", a.index[0], number_text(value))});
      }
      return Flow::kContinue;
    default: break;
  }
  s_.elements.assign(a, value);
  if (!(value > 0) || a.id == ElementId::kMotorServoCtrl || a.id == ElementId::kCoordInPosTimeOut)
    if (const std::string reason = why_nonsense(a, value); !reason.empty()) s_.warn(thread.source(), reason);
  const bool of_trigger = a.id >= ElementId::kSimMotorTriggerPos && a.id <= ElementId::kSimMotorFlagInvert;
  if (of_trigger) trigger_moved(s_, s_.motors[a.index[0]]);
  return Flow::kContinue;
}

/// The motor stands where it stands, and its position from home changes.
Flow MachineHost::set_home_position(Thread& thread, Motor& m, double value) {
  if (m.moving() || !std::isfinite(value))
    return fault(thread, FaultKind::kRunTime, fmt::format("Motor[{}].HomePos cannot be set to {} {}", m.number, number_text(value), m.moving() ? "while the motor moves" : ""));
  m.position_mu += m.home_position_mu - value;
  m.home_position_mu = value;
  return Flow::kContinue;
}

Flow MachineHost::enable_gathering(Thread& thread, double value) {
  const int enable = value >= 0 && value <= 3 ? static_cast<int>(value) : 0;
  std::vector<ElementAddress> items;
  const double count = std::min(s_.elements.get(ElementId::kGatherItems), static_cast<double>(element_info(ElementId::kGatherAddr).index_counts[0]));
  for (unsigned item = 0; enable >= 2 && item < count; ++item) {
    ElementAddress address;
    if (!decode_address(s_.elements.get(ElementId::kGatherAddr, item), address))
      return fault(thread, FaultKind::kRunTime, fmt::format("Gather.Addr[{}] is no address; assign Element.a to it", item));
    items.push_back(address);
  }
  s_.gather.set_items(std::move(items));
  s_.gather.set_enable(enable);
  return Flow::kContinue;
}

Flow MachineHost::online(Thread& thread, const bytecode::Module& module, const bytecode::Instruction& instruction,
                         std::span<const double> r) {
  const auto index = static_cast<std::size_t>(instruction.imm);
  switch (instruction.op) {
    case Opcode::kAddressCoord:
      if (!(r[instruction.a] >= 0 && r[instruction.a] < bytecode::kMaxCoords)) {
        s_.refuse("&", fmt::format("error #23: OUT OF RANGE NUMBER: there is no coordinate system {}", number_text(r[instruction.a])));
        return Flow::kStop;
      }
      thread.coord = static_cast<int>(r[instruction.a]);
      thread.q = s_.coord(thread.coord).q.data();
      return Flow::kContinue;
    case Opcode::kAddressMotor:
      if (!(r[instruction.a] >= 0 && r[instruction.a] < bytecode::kMaxMotors)) {
        s_.refuse("#", fmt::format("error #23: OUT OF RANGE NUMBER: there is no motor {}", number_text(r[instruction.a])));
        return Flow::kStop;
      }
      thread.motor = static_cast<int>(r[instruction.a]);
      return Flow::kContinue;
    case Opcode::kDefineAxis: define_axis(thread, module.axis_definitions[index]); return Flow::kContinue;
    case Opcode::kDefinePointer: define_pointer(module, module.pointer_definitions[index]); return Flow::kContinue;
    case Opcode::kInstallProgram: install(thread, module.programs[index]); return Flow::kContinue;
    case Opcode::kExecuteProgram:
      if (const std::string refusal = s_.coord(thread.coord).execute({s_.loading, &module.programs[index]}, s_.now_ms); !refusal.empty()) s_.refuse("cx", refusal);
      return Flow::kContinue;
    case Opcode::kReport: answer_value(s_, module.strings[index], double_text(r[instruction.a])); return Flow::kContinue;
    case Opcode::kReportElement: report_element(module.element_refs[index], r[instruction.a]); return Flow::kContinue;
    case Opcode::kSystemCommand:
      if (const std::string refusal = execute_system_command(s_, thread, module.strings[index]); !refusal.empty())
        s_.refuse(module.strings[index], refusal);
      return Flow::kContinue;
    default: return fault(thread, FaultKind::kNotSimulated, "this command is not simulated");
  }
}

void MachineHost::report_element(const bytecode::ElementRef& ref, double value) {
  ElementAddress address{ref.id, {}};
  for (std::size_t i = 0; i < address.index.size(); ++i) address.index[i] = ref.index[i].value;
  const auto type = ref.address ? bytecode::ElementType::kAddress : element_info(ref.id).type;
  const bool decimal = type == bytecode::ElementType::kMask && echoes_without(s_, kDecimalMasks);
  answer_value(s_, element_text(address) + (ref.address ? ".a" : ""), decimal ? double_text(value) : value_text(type, value));
}

void MachineHost::define_axis(Thread& thread, const bytecode::AxisDefinition& definition) {
  const int motor = definition.motor >= 0 ? definition.motor : thread.motor;
  if (motor >= bytecode::kMaxMotors) return s_.refuse(fmt::format("#{}->", motor), "error #23: OUT OF RANGE NUMBER: no such motor");
  if (const std::string refusal = s_.coord(thread.coord).define(definition, motor); !refusal.empty())
    return s_.refuse(fmt::format("&{}#{}->", thread.coord, motor), refusal);
  s_.axis_definitions[motor] = {thread.coord, motor, definition};
}

void MachineHost::define_pointer(const bytecode::Module& module, const bytecode::PointerDefinition& definition) {
  if (const std::string reason = refusal_of(definition); !reason.empty())
    return s_.refuse(fmt::format("M{}->", definition.first_m), "error #21: ILLEGAL PARAMETER: " + reason);
  ElementAddress element;
  if (definition.kind == PointerKind::kElement) {
    const bytecode::ElementRef& ref = module.element_refs[definition.element];
    element.id = ref.id;
    for (int i = 0; i < bytecode::kMaxElementIndices; ++i) element.index[static_cast<std::size_t>(i)] = ref.index[i].value;
  }
  for (int m = definition.first_m; m <= definition.last_m; ++m) s_.pointers.define(m, definition, element);
}

void MachineHost::install(Thread& thread, const bytecode::Program& program) {
  const ProgramHandle handle{s_.loading, &program};
  if (program.kind == bytecode::ProgramKind::kRotary) {
    if (const std::string refusal = s_.coord(thread.coord).append_rotary(handle, s_.now_ms); !refusal.empty()) s_.refuse("open rotary", refusal);
    return;
  }
  if (s_.executes(program.kind, program.number))
    return s_.refuse(fmt::format("open {} {}", program_kind_name(program.kind), program.number),
                     "error #38: PROGRAM RUNNING: abort or disable it first");
  s_.install(handle);
}

}  // namespace

std::unique_ptr<Host> make_host(Machine::State& state) { return std::make_unique<MachineHost>(state); }

void Machine::State::perform(const SyncEntry& entry, CoordSystem& from) {
  Thread& thread = const_cast<Runner&>(from.runner()).thread;
  const auto number = static_cast<std::size_t>(entry.target.number);
  assignment_source = entry.source;
  const auto with = [&](double current) { return bytecode::apply_assignment(entry.target.op, current, entry.value); };
  switch (entry.target.variable_class) {
    case VariableClass::kP: p[number] = with(p[number]); break;
    case VariableClass::kQ: from.q[number] = with(from.q[number]); break;
    case VariableClass::kM: host->write_m(thread, entry.target.number, with(host->read_m(thread, entry.target.number))); break;
    case VariableClass::kI: host->write_i(thread, entry.target.number, with(host->read_i(thread, entry.target.number))); break;
    case VariableClass::kElement: host->write_element(thread, entry.element, with(host->read_element(thread, entry.element))); break;
    default: break;  // L, R, C, D are refused by the compiler as synchronous targets
  }
  assignment_source.reset();
  if (tracer && tracer->open()) tracer->performed(entry, from);
}

}  // namespace pmac::runtime
