// Superinstructions. fuse() writes another opcode over the first of some instructions that often follow each other; the fused
// body executes all of them and reads the operands where they stand. Nothing moves, so that targets, labels, lines and the
// counting of instructions stay as they were, and a jump into the middle finds the plain instruction.
//
//     3  load.p  t0, P1            3  load.p+load.int+add+store.p  t0, P1
//     4  load.int t1, 1     ->     4  load.int t1, 1
//     5  add     t0, t0, t1        5  add     t0, t0, t1
//     6  store.p t0, P1            6  store.p t0, P1
//
// The fused body hands values on in machine registers (and stores them in the frame as well), so the operands must follow each
// other as above: of one load before an arithmetic or test instruction the value is c, of two loads they are b and c; a
// variable is stored, and a jump decides, by the result. A second arithmetic instruction may have any operands.
#pragma once

#include <cstdint>

#include "compiler/bytecode/opcode.h"

namespace pmac::runtime {

/// Opcodes behind those of the table; verify() refuses them, so that they never come out of a file.
enum class FusedOpcode : std::uint16_t {
  kBeforeFirst = static_cast<std::uint16_t>(bytecode::Opcode::kCount) - 1,
#define FUSED2(loads, A, B) k##A##B,
#define FUSED3(loads, A, B, C) k##A##B##C,
#define FUSED4(loads, A, B, C, D) k##A##B##C##D,
#include "runtime/interpreter/fused.def"
#undef FUSED2
#undef FUSED3
#undef FUSED4
  kEnd
};

/// Makes the programs of a verified module faster. To be called once, before the module executes; afterwards the module can
/// neither be verified nor saved. Without it everything works as well.
void fuse(bytecode::Module& module);
/// The plain instructions again.
void unfuse(bytecode::Program& program);

}  // namespace pmac::runtime
