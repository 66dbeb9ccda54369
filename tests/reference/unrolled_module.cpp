#include "tests/reference/unrolled_module.h"

#include "compiler/bytecode/opcode.h"

namespace pmac::reference {

using namespace bytecode;

namespace {

/// Copies a program and keeps where every instruction went.
class Unrolled {
 public:
  Unrolled(Module& module, const Program& from) : module_(module), from_(from), new_pc_(from.code.size() + 1) {}

  Program program() {
    Program result = from_;
    for (std::uint32_t pc = 0; pc < from_.code.size(); ++pc) copy(pc);
    new_pc_.back() = static_cast<std::uint32_t>(code_.size());
    for (Instruction& in : code_)
      if (jumps(in)) in.imm = static_cast<std::int32_t>(new_pc_[static_cast<std::size_t>(in.imm)]);
    for (LabelEntry& label : result.labels) label.pc = new_pc_[label.pc];
    result.code = std::move(code_);
    result.lines = std::move(lines_);
    return result;
  }

 private:
  static bool jumps(const Instruction& in) {
    switch (opcode_info(in.op).format) {
      case OperandFormat::kJump:
      case OperandFormat::kRegJump:
      case OperandFormat::kLoop:
      case OperandFormat::kRegLoop:
      case OperandFormat::kTarget:
      case OperandFormat::kWordJump: return true;
      default: return false;
    }
  }

  void copy(std::uint32_t pc) {
    const Instruction& in = from_.code[pc];
    new_pc_[pc] = static_cast<std::uint32_t>(code_.size());
    const bool clears_row = in.op == Opcode::kLoadInt && pc + 1 < from_.code.size() && from_.code[pc + 1].op == Opcode::kRowWords;
    const bool ends_row = pc > 0 && from_.code[pc - 1].op == Opcode::kRowWords;
    if (clears_row || ends_row || in.op == Opcode::kRowLoop) return;
    if (in.op == Opcode::kRowWords) return rows(module_.move_runs[static_cast<std::size_t>(in.imm)], in.a);
    place(source_of(from_, pc));
    code_.push_back(in);
  }

  void rows(const MoveRun& run, unsigned reg) {
    for (std::size_t row = 0; row < run.row_count(); ++row) {
      place(run.source(row));
      for (std::size_t i = run.first_word[row]; i < run.first_word[row + 1]; ++i) {
        code_.push_back(load(run.values[i], reg));
        code_.push_back(Instruction::with_bc(Opcode::kAxisWord, reg, static_cast<unsigned>(move_word_index(run.words[i])), static_cast<unsigned>(move_word_kind(run.words[i]))));
      }
      code_.push_back(Instruction::with_imm(Opcode::kBlockEnd, 0, 0));
    }
  }

  Instruction load(double value, unsigned reg) {
    module_.constants.push_back(value);
    return Instruction::with_imm(Opcode::kLoadConst, reg, static_cast<std::int32_t>(module_.constants.size() - 1));
  }

  void place(const SourceLine& source) {
    if (!lines_.empty() && lines_.back().source == source) return;
    lines_.push_back({static_cast<std::uint32_t>(code_.size()), source});
  }

  Module& module_;
  const Program& from_;
  std::vector<std::uint32_t> new_pc_;
  std::vector<Instruction> code_;
  std::vector<LineEntry> lines_;
};

}  // namespace

Module unrolled(const Module& module) {
  Module result = module;
  for (Program& program : result.programs) program = Unrolled(result, program).program();
  result.move_runs.clear();
  return result;
}

}  // namespace pmac::reference
