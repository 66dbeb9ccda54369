#include "runtime/interpreter/fuse.h"

#include <algorithm>
#include <array>
#include <vector>

namespace pmac::runtime {
namespace {

using bytecode::Instruction;
using bytecode::Opcode;

struct Sequence {
  std::size_t loads;
  std::vector<Opcode> opcodes;
  FusedOpcode fused;
};

/// Sequences by their first opcode, longer ones first.
using Sequences = std::array<std::vector<Sequence>, static_cast<std::size_t>(Opcode::kCount)>;

Sequences make_sequences() {
  const Sequence rows[] = {
#define FUSED2(loads, A, B) {loads, {Opcode::k##A, Opcode::k##B}, FusedOpcode::k##A##B},
#define FUSED3(loads, A, B, C) {loads, {Opcode::k##A, Opcode::k##B, Opcode::k##C}, FusedOpcode::k##A##B##C},
#define FUSED4(loads, A, B, C, D) {loads, {Opcode::k##A, Opcode::k##B, Opcode::k##C, Opcode::k##D}, FusedOpcode::k##A##B##C##D},
#include "runtime/interpreter/fused.def"
#undef FUSED2
#undef FUSED3
#undef FUSED4
  };
  Sequences sequences;
  for (const Sequence& row : rows) sequences[static_cast<std::size_t>(row.opcodes[0])].push_back(row);
  for (std::vector<Sequence>& list : sequences) {
    std::stable_sort(list.begin(), list.end(), [](const Sequence& left, const Sequence& right) {
      return left.opcodes.size() > right.opcodes.size();
    });
  }
  return sequences;
}

bool begins_with(const Instruction* code, const Instruction* end, const std::vector<Opcode>& opcodes) {
  if (static_cast<std::size_t>(end - code) < opcodes.size()) return false;
  return std::equal(opcodes.begin(), opcodes.end(), code, [](Opcode op, const Instruction& in) { return op == in.op; });
}

bool uses_result(Opcode op) {
  return op == Opcode::kStoreP || op == Opcode::kJumpIfTrue || op == Opcode::kJumpIfFalse || op == Opcode::kLoopIfTrue;
}

/// True if the loaded values are the operands, and what follows uses the result (see fuse.h).
bool values_follow(const Instruction* code, const Sequence& sequence) {
  const Instruction& operation = code[sequence.loads];
  if (sequence.loads == 1 && (operation.c() != code[0].a || operation.b() == code[0].a)) return false;
  if (sequence.loads == 2 && (operation.b() != code[0].a || operation.c() != code[1].a || code[0].a == code[1].a)) return false;
  return !uses_result(sequence.opcodes.back()) || code[sequence.loads + 1].a == operation.a;
}

/// From the front, so that the opcodes further on are still the plain ones.
void fuse_code(std::vector<Instruction>& code, const Sequences& sequences) {
  for (std::size_t pc = 0; pc < code.size(); ++pc) {
    for (const Sequence& sequence : sequences[static_cast<std::size_t>(code[pc].op)]) {
      const bool fits = begins_with(&code[pc], code.data() + code.size(), sequence.opcodes) && values_follow(&code[pc], sequence);
      if (!fits) continue;
      code[pc].op = static_cast<Opcode>(sequence.fused);
      break;
    }
  }
}

}  // namespace

void fuse(bytecode::Module& module) {
  static const Sequences sequences = make_sequences();
  for (bytecode::Program& program : module.programs) fuse_code(program.code, sequences);
}

void unfuse(bytecode::Program& program) {
  static const Opcode kFirst[] = {
#define FUSED2(loads, A, B) Opcode::k##A,
#define FUSED3(loads, A, B, C) Opcode::k##A,
#define FUSED4(loads, A, B, C, D) Opcode::k##A,
#include "runtime/interpreter/fused.def"
#undef FUSED2
#undef FUSED3
#undef FUSED4
  };
  constexpr auto kPlain = static_cast<std::size_t>(Opcode::kCount);
  for (Instruction& in : program.code)
    if (static_cast<std::size_t>(in.op) >= kPlain) in.op = kFirst[static_cast<std::size_t>(in.op) - kPlain];
}

}  // namespace pmac::runtime
