// The instructions, made from the rows of opcode.def.
#pragma once

#include "compiler/bytecode/bytecode.h"

namespace pmac::bytecode {

enum class Opcode : std::uint16_t {
#define OPCODE(Name, text, format, meaning) k##Name,
#include "compiler/bytecode/opcode.def"
#undef OPCODE
  kCount
};

/// How the operands of an instruction are read; see the rows of opcode.def.
enum class OperandFormat : std::uint8_t {
  kNone, kReg, kReg3, kRegReg, kRegRegReg, kRegConst, kRegInt,
  kRegP, kRegQ, kRegM, kRegI, kRegC, kRegD, kRegRegClass, kRegElement,
  kFunc, kJump, kRegJump, kLoop, kRegLoop, kTarget, kCallTarget, kRegSync,
  kMoveMode, kAxisMask, kRegMotion, kRegWord, kControl, kString, kPortString, kRegString,
  kAxisDef, kPointerDef, kProgram,
  kRegWordOf, kWordJump, kWord, kCodeOf, kLetters, kRegRun,
  kCard,
};

struct OpcodeInfo { std::string_view text; OperandFormat format; std::string_view meaning; };
const OpcodeInfo& opcode_info(Opcode opcode);

}  // namespace pmac::bytecode
