#include "compiler/codegen/program_writer.h"
#include "compiler/bytecode/opcode.h"

#include <algorithm>

namespace pmac::compiler::codegen {

using bytecode::Instruction;

void ProgramWriter::begin(std::int64_t local_count) {
  local_count_ = local_count;
  next_ = highest_ = static_cast<Register>(local_count);
}

std::size_t ProgramWriter::emit(Instruction instruction) {
  code_.push_back(instruction);
  return code_.size() - 1;
}

/// A jump to a place further on waits for it; one to a place behind is a counted loop.
void ProgramWriter::jump_to(Opcode op, Register a, Target& target) {
  if (target.pc < 0) {
    target.waiting.push_back(emit_imm(op, a, 0));
    return;
  }
  if (op == Opcode::kJump) {
    emit_imm(Opcode::kLoop, 0, target.pc);
    return;
  }
  if (op == Opcode::kJumpIfFalse) {
    const Register inverted = take();
    emit_abc(Opcode::kLogicalNot, inverted, a);
    a = inverted;
  }
  emit_imm(Opcode::kLoopIfTrue, a, target.pc);
}

void ProgramWriter::place(Target& target) {
  target.pc = static_cast<std::int64_t>(code_.size());
  for (const std::size_t pc : target.waiting) code_[pc].imm = static_cast<std::int32_t>(target.pc);
  target.waiting.clear();
}

ProgramWriter::Register ProgramWriter::take(unsigned count) {
  const Register first = next_;
  next_ += count;
  highest_ = std::max(highest_, next_);
  return first;
}

void ProgramWriter::place_source(const source::Span& span) {
  span_ = span;
  const bytecode::SourceLine line = tables_.line(span);
  if (!lines_.empty() && lines_.back().source == line) return;
  const auto pc = static_cast<std::uint32_t>(code_.size());
  if (!lines_.empty() && lines_.back().pc == pc) lines_.back().source = line;
  else lines_.push_back({pc, line});
}

ProgramWriter::Register ProgramWriter::outgoing(std::int64_t number) {
  outgoing_count_ = std::max(outgoing_count_, number + 1);
  return kOutgoing + static_cast<Register>(number);
}

/// Constant jumps to labels: forward ones are plain jumps, backward ones look the label up, which counts.
void ProgramWriter::patch_label_jumps() {
  for (const LabelJump& jump : label_jumps_) {
    const auto label = labels_.find(jump.label);
    if (label != labels_.end()) code_[jump.pc].imm = static_cast<std::int32_t>(label->second);
  }
}

/// R(i) = register frame_size + i; only Move instructions and calls of R variables name them.
void ProgramWriter::patch_outgoing(bytecode::Program& program) {
  const auto real = [&](unsigned r) { return r >= kOutgoing ? program.frame_size + (r - kOutgoing) : r; };
  for (Instruction& instruction : code_) {
    if (instruction.op != Opcode::kMove) continue;
    instruction = Instruction::with_bc(Opcode::kMove, real(instruction.a), real(instruction.b()));
  }
}

void ProgramWriter::finish(bytecode::Program& program) {
  emit_imm(Opcode::kReturn, 0, 0);
  patch_label_jumps();
  program.local_count = static_cast<std::uint32_t>(local_count_);
  program.frame_size = highest_;
  program.outgoing_count = static_cast<std::uint32_t>(outgoing_count_);
  patch_outgoing(program);
  if (program.frame_size > bytecode::kMaxFrameSize) diagnostics_.error("PM3060", span_, "this program needs too many registers; make its expressions simpler");
  program.code = std::move(code_);
  program.lines = std::move(lines_);
  for (const auto& [number, pc] : labels_) program.labels.push_back({static_cast<std::uint32_t>(number), static_cast<std::uint32_t>(pc)});
}

bytecode::Program ProgramWriter::write_buffer(const ir::Buffer& buffer) {
  bytecode::Program program;
  program.kind = buffer.kind;
  program.number = static_cast<std::uint32_t>(buffer.number);
  program.name = buffer.name;
  program.source = tables_.line(buffer.span);
  begin(buffer.local_count);
  may_scan_ = buffer.kind == bytecode::ProgramKind::kPlc || buffer.kind == bytecode::ProgramKind::kSubprog;
  std::size_t next_routine = 0;
  for (std::size_t i = 0; i <= buffer.body.size(); ++i) {
    for (; next_routine < buffer.routines.size() && buffer.routines[next_routine].first == i; ++next_routine) {
      emit_imm(Opcode::kReturn, 0, 0);
      labels_[buffer.routines[next_routine].label] = code_.size();
    }
    if (i < buffer.body.size()) statement(*buffer.body[i]);
  }
  place_source(buffer.close_span);
  finish(program);
  return program;
}

bytecode::Program ProgramWriter::write_load(const ir::Unit& unit, std::size_t first_program) {
  bytecode::Program program;
  program.kind = bytecode::ProgramKind::kOnline;
  program.number = static_cast<std::uint32_t>(unit.card);
  program.name = unit.axis;
  first_program_ = first_program;
  if (!unit.load.empty()) program.source = tables_.line(unit.load.front()->span);
  begin(unit.local_count);
  body(unit.load);
  finish(program);
  return program;
}

}  // namespace pmac::compiler::codegen
