#include "runtime/interpreter/fuse.h"

#include <algorithm>
#include <array>
#include <vector>

namespace pmac::runtime {
namespace {

using bytecode::Instruction;
using bytecode::Opcode;

struct Sequence {
  std::vector<Opcode> opcodes;
  FusedOpcode fused;
};

/// Sequences by their first opcode, longer ones first.
using Sequences = std::array<std::vector<Sequence>, static_cast<std::size_t>(Opcode::kCount)>;

Sequences make_sequences() {
  const Sequence rows[] = {
#define FUSED2(A, B) {{Opcode::k##A, Opcode::k##B}, FusedOpcode::k##A##B},
#define FUSED3(A, B, C) {{Opcode::k##A, Opcode::k##B, Opcode::k##C}, FusedOpcode::k##A##B##C},
#define FUSED4(A, B, C, D) {{Opcode::k##A, Opcode::k##B, Opcode::k##C, Opcode::k##D}, FusedOpcode::k##A##B##C##D},
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

/// From the front, so that the opcodes further on are still the plain ones.
void fuse_code(std::vector<Instruction>& code, const Sequences& sequences) {
  for (std::size_t pc = 0; pc < code.size(); ++pc) {
    for (const Sequence& sequence : sequences[static_cast<std::size_t>(code[pc].op)]) {
      if (!begins_with(&code[pc], code.data() + code.size(), sequence.opcodes)) continue;
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

}  // namespace pmac::runtime
