// What a line assigned is seen from its instructions: a store names its variable; a local or an argument is a register, whose new value
// is read when the next instruction is about to execute.
#include "runtime/trace.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "compiler/bytecode/module_text.h"
#include "compiler/bytecode/opcode.h"

namespace pmac::runtime {
namespace {

using bytecode::Instruction;
using bytecode::Opcode;
using bytecode::VariableClass;

/// r[a] is what the instruction computes.
bool computes_register(Opcode op) {
  switch (op) {
    case Opcode::kLoadConst: case Opcode::kLoadInt: case Opcode::kMove:
    case Opcode::kLoadP: case Opcode::kLoadQ: case Opcode::kLoadM: case Opcode::kLoadI: case Opcode::kLoadC: case Opcode::kLoadD:
    case Opcode::kLoadIndexed: case Opcode::kLoadElement:
    case Opcode::kAdd: case Opcode::kSub: case Opcode::kMul: case Opcode::kDiv: case Opcode::kMod:
    case Opcode::kBitAnd: case Opcode::kBitOr: case Opcode::kBitXor: case Opcode::kShiftLeft: case Opcode::kShiftRight:
    case Opcode::kNeg: case Opcode::kBitNot: case Opcode::kLogicalNot:
    case Opcode::kEqual: case Opcode::kNotEqual: case Opcode::kLess: case Opcode::kLessEqual: case Opcode::kNear:
    case Opcode::kFunction: case Opcode::kMemoryFunction: case Opcode::kLoadAddress: case Opcode::kLoadByteAddress: case Opcode::kLoadText:
    case Opcode::kFlagTest: return true;
    default: return false;
  }
}

bool is_variable(const bytecode::Program& program, unsigned reg) { return reg < program.local_count || reg >= program.frame_size; }

/// A statement begins here: not in the middle of one, where a call returns to.
bool begins_statement(const bytecode::Program& program, std::uint32_t pc) {
  return std::binary_search(program.lines.begin(), program.lines.end(), bytecode::LineEntry{pc, {}},
                            [](const bytecode::LineEntry& left, const bytecode::LineEntry& right) { return left.pc < right.pc; });
}

bool is_same_line(const bytecode::SourceLine& a, const bytecode::SourceLine& b) { return a.file == b.file && a.line == b.line; }

std::string thread_title(Thread& thread) {
  const Runner& runner = Runner::of(thread);
  switch (runner.kind) {
    case RunnerKind::kMotionProgram:
    case RunnerKind::kKinematics: return fmt::format("&{}", runner.number);
    case RunnerKind::kPlc: return fmt::format("plc {}", runner.number);
    case RunnerKind::kOnline: break;
  }
  return "command";
}

std::string buffer_title(const bytecode::Program& program) {
  return program.kind == bytecode::ProgramKind::kOnline ? "load" : bytecode::program_title(program);
}

ElementAddress address_of(const bytecode::ElementRef& ref, std::span<const double> registers) {
  ElementAddress address{ref.id, {}};
  for (std::size_t i = 0; i < bytecode::kMaxElementIndices; ++i) {
    const double index = ref.index[i].is_register ? registers[ref.index[i].value] : ref.index[i].value;
    address.index[i] = index >= 0 && index < 4e9 ? static_cast<std::uint32_t>(index) : 0;  // others are refused when it executes
  }
  return address;
}

std::optional<VariableClass> named_class(bytecode::SymbolKind kind) {
  switch (kind) {
    case bytecode::SymbolKind::kGlobal: return VariableClass::kP;
    case bytecode::SymbolKind::kCsGlobal: return VariableClass::kQ;
    case bytecode::SymbolKind::kPointer: return VariableClass::kM;
    default: return std::nullopt;
  }
}

}  // namespace

void Tracer::learn_names(const bytecode::Module& module) {
  for (const bytecode::Symbol& symbol : module.symbols)
    if (const auto variable_class = named_class(symbol.kind)) names_[{*variable_class, symbol.number}] = {symbol.name, symbol.size};
}

std::string Tracer::variable_name(VariableClass variable_class, std::int64_t number) const {
  auto after = names_.upper_bound({variable_class, static_cast<std::uint32_t>(number)});
  if (after != names_.begin() && std::prev(after)->first.first == variable_class) {
    const auto& [key, named] = *std::prev(after);
    const std::int64_t at = number - key.second;
    if (named.size == 0 && at == 0) return named.name;
    if (at < named.size) return fmt::format("{}({})", named.name, at);
  }
  return fmt::format("{}{}", bytecode::variable_class_name(variable_class), number);
}

TraceRecord Tracer::record_of(const Thread& thread, TraceRecord::What what, bytecode::SourceLine source) const {
  return {what, machine_.now_ms, thread_title(const_cast<Thread&>(thread)), buffer_title(*thread.program().program), source, 0, {}};
}

void Tracer::give(TraceRecord record) {
  if (!open()) return;
  ++given_;
  if (machine_.options.observers.trace) machine_.options.observers.trace(record);
}

/// The open line with what it has assigned so far.
void Tracer::give_line() {
  if (line_thread_ == nullptr) return;
  line_thread_ = nullptr;
  line_.text = fmt::format("{}", fmt::join(values_, ", "));
  if (more_values_ > 0) line_.text += fmt::format(", and {} more", more_values_);
  const bool is_empty = values_.empty();
  values_.clear();
  more_values_ = 0;
  if (!is_empty || line_.what == TraceRecord::What::kLine) give(std::move(line_));
}

void Tracer::add_value(const std::string& name, double value) {
  if (values_.size() < kMostValues) values_.push_back(name + " = " + bytecode::number_text(value));
  else ++more_values_;
}

void Tracer::before(const Thread& thread, std::uint32_t pc, std::span<const double> registers) {
  Stand& stand = stands_[&thread];
  note_written(stand, registers);
  note_line(thread, stand, pc);
  if (machine_.options.trace == TraceDetail::kInstructions) note_instruction(thread, pc);
  const bytecode::Program& program = *thread.program().program;
  const Instruction& in = program.code[pc];
  note_stored(thread, in, registers);
  if (computes_register(in.op) && is_variable(program, in.a)) stand.written_register = in.a;
}

void Tracer::after_run(const Thread& thread, std::span<const double> registers) {
  Stand& stand = stands_[&thread];
  if (!registers.empty()) note_written(stand, registers);
  if (registers.empty()) stand = {};
  if (line_thread_ == &thread) give_line();
}

/// Opens a line where one begins, and goes on with the old one where a call has returned or another thread has run in between.
void Tracer::note_line(const Thread& thread, Stand& stand, std::uint32_t pc) {
  const bytecode::Program& program = *thread.program().program;
  const bytecode::SourceLine source = bytecode::source_of(program, pc);
  const bool elsewhere = stand.program != &program || !is_same_line(stand.source, source);
  const bool begins = begins_statement(program, pc) && (elsewhere || pc <= stand.pc);
  if (begins || elsewhere || line_thread_ != &thread) {
    give_line();
    line_ = record_of(thread, begins ? TraceRecord::What::kLine : TraceRecord::What::kGoesOn, source);
    line_thread_ = &thread;
  }
  stand.program = &program;
  stand.source = source;
  stand.pc = pc;
}

void Tracer::note_instruction(const Thread& thread, std::uint32_t pc) {
  const bytecode::Program& program = *thread.program().program;
  const Thread* const open_thread = line_thread_;
  const bytecode::SourceLine source = line_.source;
  give_line();
  TraceRecord record = record_of(thread, TraceRecord::What::kInstruction, source);
  record.pc = pc;
  record.text = bytecode::instruction_text(*thread.program().module, program, program.code[pc]);
  give(std::move(record));
  line_ = record_of(thread, TraceRecord::What::kGoesOn, source);
  line_thread_ = open_thread;
}

/// The register that the last instruction has computed.
void Tracer::note_written(Stand& stand, std::span<const double> registers) {
  if (stand.written_register == kNoRegister) return;
  const auto reg = static_cast<unsigned>(std::exchange(stand.written_register, kNoRegister));
  add_value(bytecode::register_name(*stand.program, reg), registers[reg]);
}

void Tracer::note_stored(const Thread& thread, const Instruction& in, std::span<const double> registers) {
  const auto store = [&](VariableClass variable_class) { add_value(variable_name(variable_class, in.imm), registers[in.a]); };
  switch (in.op) {
    case Opcode::kStoreP: return store(VariableClass::kP);
    case Opcode::kStoreQ: return store(VariableClass::kQ);
    case Opcode::kStoreM: return store(VariableClass::kM);
    case Opcode::kStoreI: return store(VariableClass::kI);
    case Opcode::kStoreC: return store(VariableClass::kC);
    case Opcode::kStoreD: return store(VariableClass::kD);
    case Opcode::kStoreIndexed: {
      const double number = registers[in.b()];
      if (number > -1 && number < bytecode::kPCount)
        add_value(variable_name(static_cast<VariableClass>(in.c()), static_cast<std::int64_t>(number)), registers[in.a]);
      return;
    }
    case Opcode::kStoreElement: {
      const bytecode::ElementRef& ref = thread.program().module->element_refs[static_cast<std::size_t>(in.imm)];
      return add_value(element_text(address_of(ref, registers)), registers[in.a]);
    }
    default: return;
  }
}

void Tracer::performed(const SyncEntry& entry, const CoordSystem& coord) {
  give_line();
  const auto number = static_cast<std::size_t>(entry.target.number);
  std::string name = entry.target.variable_class == VariableClass::kElement ? element_text(entry.element)
                                                                            : variable_name(entry.target.variable_class, entry.target.number);
  Thread& thread = const_cast<Runner&>(coord.runner()).thread;
  double value = entry.value;
  switch (entry.target.variable_class) {
    case VariableClass::kP: value = machine_.p[number]; break;
    case VariableClass::kQ: value = coord.q[number]; break;
    case VariableClass::kM: value = machine_.host->read_m(thread, entry.target.number); break;
    case VariableClass::kI: value = machine_.host->read_i(thread, entry.target.number); break;
    case VariableClass::kElement: value = machine_.host->read_element(thread, entry.element); break;
    default: break;
  }
  const bytecode::Program* program = thread.program() ? thread.program().program : thread.top_program().program;
  give({TraceRecord::What::kSynchronous, machine_.now_ms, fmt::format("&{}", coord.runner().number), program ? buffer_title(*program) : "",
        entry.source, 0, name + " = " + bytecode::number_text(value)});
}

}  // namespace pmac::runtime
