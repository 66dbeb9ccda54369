// Checks every operand of every instruction of a program. After this the interpreter may index registers, tables and code
// without looking.
#include "compiler/bytecode/verify_code.h"

#include <algorithm>
#include <cmath>

#include "compiler/bytecode/card.h"
#include "compiler/bytecode/control.h"
#include "compiler/bytecode/function.h"
#include "compiler/bytecode/letters.h"
#include "compiler/bytecode/module_text.h"
#include "compiler/bytecode/opcode.h"

namespace pmac::bytecode {
namespace {

constexpr unsigned kNoRegister = 0xffff;

/// Checks one instruction; every function returns what is wrong, or empty.
class InstructionCheck {
 public:
  InstructionCheck(const Module& module, const Program& program, std::uint32_t pc)
      : module_(module), program_(program), in_(program.code[pc]), pc_(static_cast<std::int64_t>(pc)) {}

  std::string run() const {
    if (in_.op >= Opcode::kCount) return "no such instruction";
    if (is_online_only(in_.op) && program_.kind != ProgramKind::kOnline) return "belongs to load scripts only";
    return operands();
  }

 private:
  static bool is_online_only(Opcode op) { return op >= Opcode::kAddressCoord && op <= Opcode::kReport; }

  std::string operands() const;
  std::string element_operand(const ElementRef& ref) const;
  std::string stored_element(std::size_t index) const;
  std::string sync_target(const SyncTarget& target) const;
  std::string function_operands() const;
  std::string control_operands() const;
  std::string card_operands() const;
  std::string word_operands() const;
  std::string line_word_operands() const;
  std::string code_operands() const;
  std::string letters() const;

  /// Registers first .. first + count - 1 are in the frame or its outgoing arguments.
  std::string registers(unsigned first, unsigned count = 1) const {
    const unsigned limit = program_.frame_size + program_.outgoing_count;
    if (first + count <= limit) return {};
    return "register " + std::to_string(first) + " is outside the frame of " + std::to_string(limit);
  }
  static std::string line_word(unsigned number) { return number < kMaxLineWords ? std::string() : "too many words in a line"; }
  std::string both(std::string first, std::string second) const { return first.empty() ? second : first; }
  std::string variable(int count) const { return index(static_cast<std::size_t>(count), "variable number"); }
  std::string index(std::size_t size, const char* what) const {
    if (in_.imm >= 0 && static_cast<std::size_t>(in_.imm) < size) return {};
    return std::string(what) + " " + std::to_string(in_.imm) + " is not below " + std::to_string(size);
  }
  std::string forward() const {
    if (in_.imm > pc_ && in_.imm < code_size()) return {};
    return "target " + std::to_string(in_.imm) + " is not further on in the program";
  }
  std::string backward() const {
    if (in_.imm >= 0 && in_.imm <= pc_) return {};
    return "target " + std::to_string(in_.imm) + " is not further back in the program";
  }
  std::int64_t code_size() const { return static_cast<std::int64_t>(program_.code.size()); }

  const Module& module_;
  const Program& program_;
  const Instruction& in_;
  std::int64_t pc_;
};

std::string InstructionCheck::element_operand(const ElementRef& ref) const {
  for (const ElementRef::Index& index : ref.index) {
    if (!index.is_register) continue;
    if (std::string why = registers(std::min(index.value, kNoRegister)); !why.empty()) return why;
  }
  return {};
}

std::string InstructionCheck::stored_element(std::size_t index) const {
  const ElementRef& ref = module_.element_refs[index];
  return ref.address ? "an address cannot be assigned" : element_operand(ref);
}

std::string InstructionCheck::sync_target(const SyncTarget& target) const {
  if (target.variable_class == VariableClass::kElement) return stored_element(target.element);
  if (target.number_register != kNoRegister) return registers(target.number_register);
  const bool is_local = target.variable_class == VariableClass::kL;
  if (is_local && static_cast<std::uint32_t>(target.number) >= program_.local_count) return "no such local variable";
  return {};
}

std::string InstructionCheck::function_operands() const {
  const auto function = static_cast<Function>(in_.b());
  if (function >= Function::kCount) return "no such function";
  if (function_info(function).uses_memory != (in_.op == Opcode::kMemoryFunction)) return "a function of another kind";
  return both(registers(in_.a), registers(in_.c(), static_cast<unsigned>(function_info(function).argument_count)));
}

std::string InstructionCheck::control_operands() const {
  const auto verb = static_cast<ControlVerb>(in_.a);
  if (verb >= ControlVerb::kCount) return "no such verb";
  if (in_.c() != control_argument_count(verb)) return "wrong number of arguments";
  return registers(in_.b(), in_.c());
}

std::string InstructionCheck::card_operands() const {
  const auto verb = static_cast<CardVerb>(in_.a);
  if (verb >= CardVerb::kCount) return "no such verb";
  if (in_.c() != card_verb_info(verb).argument_count) return "wrong number of arguments";
  return registers(in_.b(), in_.c());
}

std::string InstructionCheck::word_operands() const {
  const auto kind = static_cast<WordKind>(in_.c());
  if (kind >= WordKind::kCount) return "no such kind of word";
  const unsigned count = kind == WordKind::kCenter ? 6 : kind == WordKind::kRadius ? 1 : kAxisCount;
  return in_.b() < count ? registers(in_.a) : "no such axis or vector";
}

std::string InstructionCheck::line_word_operands() const {
  if (in_.b() < 1 || in_.b() > kLetterCount) return "no such letter";
  return both(line_word(in_.c()), registers(in_.a));
}

std::string InstructionCheck::code_operands() const {
  if (!is_code_letter(in_.b())) return "not a code letter";
  return in_.c() <= kMaxLineWords ? registers(in_.a) : "too many words in a line";
}

std::string InstructionCheck::letters() const {
  if (std::string why = index(module_.constants.size(), "constant"); !why.empty()) return why;
  const double mask = module_.constants[static_cast<std::size_t>(in_.imm)];
  return mask >= 0 && mask < kLetterMaskEnd && mask == std::floor(mask) ? std::string() : "not a mask of letters";
}

std::string InstructionCheck::operands() const {
  switch (opcode_info(in_.op).format) {
    case OperandFormat::kNone: return {};
    case OperandFormat::kReg: return registers(in_.a);
    case OperandFormat::kReg3: return in_.imm == 0 || in_.imm == 1 ? registers(in_.a, 3) : "no such set of axes";
    case OperandFormat::kRegReg: return both(registers(in_.a), registers(in_.b()));
    case OperandFormat::kRegRegReg: return both(registers(in_.a), both(registers(in_.b()), registers(in_.c())));
    case OperandFormat::kRegConst: return both(registers(in_.a), index(module_.constants.size(), "constant"));
    case OperandFormat::kRegInt: return registers(in_.a);
    case OperandFormat::kRegP: return both(registers(in_.a), variable(kPCount));
    case OperandFormat::kRegQ: return both(registers(in_.a), variable(kQCount));
    case OperandFormat::kRegM: return both(registers(in_.a), variable(kMCount));
    case OperandFormat::kRegI: return both(registers(in_.a), variable(kICount));
    case OperandFormat::kRegC: return both(registers(in_.a), variable(kCCount));
    case OperandFormat::kRegD: return both(registers(in_.a), variable(kDCount));
    case OperandFormat::kRegRegClass:
      if (in_.c() >= static_cast<unsigned>(VariableClass::kElement)) return "no such class of variables";
      return both(registers(in_.a), registers(in_.b()));
    case OperandFormat::kRegElement: {
      if (std::string why = both(registers(in_.a), index(module_.element_refs.size(), "element")); !why.empty()) return why;
      const auto ref = static_cast<std::size_t>(in_.imm);
      return in_.op == Opcode::kStoreElement ? stored_element(ref) : element_operand(module_.element_refs[ref]);
    }
    case OperandFormat::kFunc: return function_operands();
    case OperandFormat::kJump: return forward();
    case OperandFormat::kRegJump: return both(registers(in_.a), forward());
    case OperandFormat::kLoop: return backward();
    case OperandFormat::kRegLoop: return both(registers(in_.a), backward());
    case OperandFormat::kTarget: return index(program_.code.size(), "target");
    case OperandFormat::kCallTarget: return index(module_.call_targets.size(), "call target");
    case OperandFormat::kRegSync:
      if (std::string why = both(registers(in_.a), index(module_.sync_targets.size(), "target")); !why.empty()) return why;
      return sync_target(module_.sync_targets[static_cast<std::size_t>(in_.imm)]);
    case OperandFormat::kMoveMode:
      return in_.a < static_cast<unsigned>(MoveMode::kCount) ? std::string() : "no such move mode";
    case OperandFormat::kAxisMask: return in_.a <= 1 ? std::string() : "no such set of axes";
    case OperandFormat::kRegMotion:
      return in_.b() < static_cast<unsigned>(MotionParameter::kCount) ? registers(in_.a) : "no such motion parameter";
    case OperandFormat::kRegWord: return word_operands();
    case OperandFormat::kControl: return control_operands();
    case OperandFormat::kCard: return card_operands();
    case OperandFormat::kString: return index(module_.strings.size(), "text");
    case OperandFormat::kPortString: return index(module_.strings.size(), "text");
    case OperandFormat::kRegString: return both(registers(in_.a), index(module_.strings.size(), "text"));
    case OperandFormat::kAxisDef: return index(module_.axis_definitions.size(), "axis definition");
    case OperandFormat::kPointerDef: return index(module_.pointer_definitions.size(), "pointer definition");
    case OperandFormat::kRegWordOf: return line_word_operands();
    case OperandFormat::kWordJump: return both(line_word(in_.a), forward());
    case OperandFormat::kWord: return line_word(in_.a);
    case OperandFormat::kCodeOf: return code_operands();
    case OperandFormat::kLetters: return letters();
    case OperandFormat::kRegRun: return both(registers(in_.a), index(module_.move_runs.size(), "move run"));
    case OperandFormat::kProgram:
      if (std::string why = index(module_.programs.size(), "program"); !why.empty()) return why;
      return module_.programs[static_cast<std::size_t>(in_.imm)].kind != ProgramKind::kOnline ? std::string()
                                                                                                : "not a buffer";
  }
  return "no such operand format";
}

bool may_end_program(Opcode op) {
  return op == Opcode::kReturn || op == Opcode::kStop || op == Opcode::kJump || op == Opcode::kLoop ||
         op == Opcode::kGotoLabel;
}

bool is_source_of(const Module& module, const SourceLine& source) {
  return source.file >= -1 && source.file < static_cast<std::int64_t>(module.files.size()) && source.line >= 0 &&
         source.column >= 0;
}

std::string verify_kind(const Program& program) {
  if (program.kind >= ProgramKind::kCount) return "no such kind of program";
  if (program.kind == ProgramKind::kPlc && program.number >= kMaxPlcs) return "PLC number is not below 32";
  const bool of_coord = program.kind == ProgramKind::kForward || program.kind == ProgramKind::kInverse;
  return of_coord && program.number >= kMaxCoords ? "no such coordinate system" : std::string();
}

std::string verify_frame(const Program& program) {
  if (program.local_count > kLCount) return "too many local variables";
  if (program.frame_size > kMaxFrameSize || program.frame_size < program.local_count) return "wrong size of the frame";
  if (program.outgoing_count > kMaxOutgoing) return "too many outgoing arguments";
  return {};
}

std::string verify_places(const Module& module, const Program& program) {
  if (program.code.empty()) return "no instructions";
  if (program.code.size() > 0x7fffffffu) return "too many instructions";
  if (!is_source_of(module, program.source)) return "wrong source place";
  for (std::size_t i = 0; i < program.lines.size(); ++i) {
    const LineEntry& line = program.lines[i];
    if (line.pc >= program.code.size() || !is_source_of(module, line.source)) return "wrong entry in the line table";
    if (i > 0 && line.pc < program.lines[i - 1].pc) return "line table is not ascending";
  }
  for (std::size_t i = 0; i < program.labels.size(); ++i) {
    if (program.labels[i].pc >= program.code.size()) return "label outside the program";
    if (i > 0 && program.labels[i].number <= program.labels[i - 1].number) return "labels are not ascending";
  }
  return {};
}

std::string verify_instructions(const Module& module, const Program& program) {
  for (std::uint32_t pc = 0; pc < program.code.size(); ++pc) {
    const std::string why = InstructionCheck(module, program, pc).run();
    if (why.empty()) continue;
    return "instruction " + std::to_string(pc) + " (" + std::string(opcode_info(program.code[pc].op).text) + "): " + why;
  }
  return may_end_program(program.code.back().op) ? std::string() : "the last instruction runs past the end";
}

}  // namespace

std::string verify_program(const Module& module, const Program& program) {
  if (std::string why = verify_kind(program); !why.empty()) return why;
  if (std::string why = verify_frame(program); !why.empty()) return why;
  if (std::string why = verify_places(module, program); !why.empty()) return why;
  return verify_instructions(module, program);
}

}  // namespace pmac::bytecode
