// Execution of one source line, for debugging: a copy of the module in which every other line begins with a backward jump to itself,
// so that the interpreter's own rule stops it there. Only stepping pays for it.
#include "runtime/interpreter/core.h"

#include "compiler/bytecode/opcode.h"
#include "runtime/interpreter/fuse.h"

namespace pmac::runtime {
namespace {

bool is_same_line(const bytecode::SourceLine& a, const bytecode::SourceLine& b) { return a.file == b.file && a.line == b.line; }

void stop_at_other_lines(bytecode::Program& program, const bytecode::SourceLine& here) {
  unfuse(program);
  for (bytecode::Instruction& in : program.code)
    if (in.op == bytecode::Opcode::kRowLoop) in.op = bytecode::Opcode::kLoopIfTrue;
  for (const bytecode::LineEntry& entry : program.lines) {
    const auto pc = static_cast<std::int32_t>(entry.pc);
    if (!is_same_line(entry.source, here)) program.code[entry.pc] = bytecode::Instruction::with_imm(bytecode::Opcode::kLoop, 0, pc);
  }
}

}  // namespace

/// The place of execution and the frames go over to the same programs of another module.
void Thread::replace_module(const std::shared_ptr<const bytecode::Module>& from, const std::shared_ptr<const bytecode::Module>& by) {
  const auto replace = [&](ProgramHandle& handle) {
    if (handle && handle.module == from) handle = {by, by->programs.data() + (handle.program - from->programs.data())};
  };
  replace(program_);
  for (SavedFrame& frame : frames_) replace(frame.program);
}

RunResult Thread::run_line(Host& host, std::uint64_t instruction_budget) {
  if (!program_) return {};
  const std::shared_ptr<const bytecode::Module> module = program_.module;
  const auto copy = std::make_shared<bytecode::Module>(*module);
  for (bytecode::Program& program : copy->programs) stop_at_other_lines(program, source());
  replace_module(module, copy);
  reset_jump_backs();
  one_line_ = true;
  RunResult result = run(host, instruction_budget, 1);
  one_line_ = false;
  replace_module(copy, module);
  return result;
}

}  // namespace pmac::runtime
