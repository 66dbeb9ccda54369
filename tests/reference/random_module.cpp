#include "tests/reference/random_module.h"
#include "compiler/bytecode/card.h"
#include "compiler/bytecode/control.h"
#include "compiler/bytecode/element.h"
#include "compiler/bytecode/function.h"
#include "compiler/bytecode/letters.h"
#include "compiler/bytecode/opcode.h"

namespace pmac::reference {
namespace {

using namespace pmac::bytecode;

class Maker {
 public:
  explicit Maker(std::uint32_t seed) : random_(seed) {}
  Module make();

 private:
  unsigned below(unsigned limit) { return static_cast<unsigned>(random_() % limit); }
  bool flip() { return below(2) == 0; }
  template <class Enum>
  Enum any(Enum count) { return static_cast<Enum>(below(static_cast<unsigned>(count))); }
  double number();
  std::string word();
  SourceLine place();
  ElementRef element(bool constant_only);
  SyncTarget sync();
  AxisDefinition axis();
  PointerDefinition pointer();
  MoveRun move_run();
  Symbol symbol();
  void fill_tables();
  Program program(ProgramKind kind, std::uint32_t number);
  Instruction instruction(const Program& program, std::uint32_t pc, std::uint32_t size);
  unsigned reg(unsigned count = 1) { return below(kRegisters + kOutgoing - count + 1); }

  static constexpr unsigned kLocals = 6;
  static constexpr unsigned kRegisters = 16;
  static constexpr unsigned kOutgoing = 5;
  std::mt19937 random_;
  Module module_;
};

double Maker::number() {
  static constexpr double kOdd[] = {0, -0.0, 1, -1, 0.5, 3, 1e300, -1e300, 1e-310, 9007199254740993.0, 2147483648.0, 65535.9};
  return flip() ? kOdd[below(12)] : static_cast<double>(static_cast<int>(random_())) / 1024.0;
}

std::string Maker::word() {
  std::string text;
  for (unsigned i = below(12); i > 0; --i) text += static_cast<char>(below(256));
  return text;
}

SourceLine Maker::place() {
  if (below(4) == 0) return {};
  return {static_cast<std::int32_t>(below(static_cast<unsigned>(module_.files.size()))),
          static_cast<std::int32_t>(below(1000)), static_cast<std::int32_t>(below(80))};
}

ElementRef Maker::element(bool constant_only) {
  ElementRef ref;
  ref.id = any(ElementId::kCount);
  const ElementInfo& info = element_info(ref.id);
  for (int i = 0; i < info.index_count(); ++i) {
    ref.index[i].is_register = !constant_only && flip();
    ref.index[i].value = ref.index[i].is_register ? reg() : below(static_cast<unsigned>(info.index_counts[i]));
  }
  return ref;
}

SyncTarget Maker::sync() {
  static constexpr VariableClass kClasses[] = {VariableClass::kP, VariableClass::kQ, VariableClass::kM,
                                               VariableClass::kI, VariableClass::kL, VariableClass::kElement};
  SyncTarget target;
  target.variable_class = kClasses[below(6)];
  target.number = static_cast<std::int32_t>(below(kLocals));
  if (flip()) target.number_register = static_cast<std::uint16_t>(reg());
  target.element = 0;
  target.op = any(AssignOp::kCount);
  return target;
}

AxisDefinition Maker::axis() {
  AxisDefinition definition;
  definition.motor = static_cast<std::int32_t>(below(kMaxMotors + 1)) - 1;
  definition.kind = any(AxisDefinitionKind::kCount);
  definition.spindle = static_cast<std::uint8_t>(below(3));
  for (unsigned i = below(4); i > 0; --i) definition.terms.push_back({static_cast<std::uint8_t>(below(kAxisCount)), number()});
  definition.offset_mu = number();
  return definition;
}

PointerDefinition Maker::pointer() {
  PointerDefinition definition;
  definition.kind = any(PointerKind::kCount);
  definition.first_m = definition.last_m = static_cast<std::int32_t>(below(kMCount));
  if (definition.kind == PointerKind::kSelf) definition.last_m = kMCount - 1;
  definition.is_signed = flip();
  definition.address = static_cast<std::uint32_t>(random_());
  definition.start_bit = static_cast<std::uint8_t>(below(32));
  definition.width = static_cast<std::uint8_t>(1 + below(32u - definition.start_bit));
  definition.has_field = flip();
  definition.name = word();
  return definition;
}

Symbol Maker::symbol() { return {any(SymbolKind::kCount), word(), below(9000), below(9), word()}; }

MoveRun Maker::move_run() {
  MoveRun run;
  run.file = 0;
  run.first_word.push_back(0);
  for (unsigned rows = 1 + below(4); rows > 0; --rows) {
    for (unsigned words = 1 + below(3); words > 0; --words) {
      run.words.push_back(move_word_code(any(WordKind::kCount), 0));
      run.values.push_back(number());
    }
    run.first_word.push_back(static_cast<std::uint32_t>(run.words.size()));
    run.line.push_back(below(99));
    run.column.push_back(static_cast<std::uint8_t>(below(256)));
  }
  return run;
}

void Maker::fill_tables() {
  for (unsigned i = 1 + below(3); i > 0; --i) module_.files.push_back(word());
  module_.constants.push_back(static_cast<double>(random_()) * (kLetterMaskEnd / 4294967296.0));
  for (unsigned i = 1 + below(20); i > 0; --i) module_.constants.push_back(number());
  for (unsigned i = 1 + below(5); i > 0; --i) module_.strings.push_back(word());
  module_.element_refs.push_back(element(true));
  for (unsigned i = below(10); i > 0; --i) module_.element_refs.push_back(element(false));
  for (unsigned i = 1 + below(6); i > 0; --i) module_.sync_targets.push_back(sync());
  for (unsigned i = 1 + below(4); i > 0; --i) module_.call_targets.push_back({below(4), static_cast<std::int64_t>(below(4)) - 1});
  for (unsigned i = 1 + below(3); i > 0; --i) module_.axis_definitions.push_back(axis());
  for (unsigned i = 1 + below(3); i > 0; --i) module_.pointer_definitions.push_back(pointer());
  for (unsigned i = below(5); i > 0; --i) module_.symbols.push_back(symbol());
  for (unsigned i = 1 + below(3); i > 0; --i) module_.move_runs.push_back(move_run());
}

Instruction Maker::instruction(const Program& program, std::uint32_t pc, std::uint32_t size) {
  const auto imm_below = [&](std::size_t limit) { return static_cast<std::int32_t>(below(static_cast<unsigned>(limit))); };
  Opcode op = any(Opcode::kCount);
  const bool online = op >= Opcode::kAddressCoord && op <= Opcode::kReport;
  if (online && program.kind != ProgramKind::kOnline) op = Opcode::kAdd;
  const bool last = pc + 1 == size;
  if (last) op = flip() ? Opcode::kLoop : Opcode::kReturn;
  switch (opcode_info(op).format) {
    case OperandFormat::kNone: return Instruction::with_imm(op, 0, 0);
    case OperandFormat::kReg: return Instruction::with_imm(op, reg(), 0);
    case OperandFormat::kReg3: return Instruction::with_imm(op, reg(3), imm_below(2));
    case OperandFormat::kRegReg: return Instruction::with_bc(op, reg(), reg());
    case OperandFormat::kRegRegReg: return Instruction::with_bc(op, reg(), reg(), reg());
    case OperandFormat::kRegConst: return Instruction::with_imm(op, reg(), imm_below(module_.constants.size()));
    case OperandFormat::kRegInt: return Instruction::with_imm(op, reg(), static_cast<std::int32_t>(below(70000)) - 100);
    case OperandFormat::kRegP: return Instruction::with_imm(op, reg(), imm_below(kPCount));
    case OperandFormat::kRegQ: return Instruction::with_imm(op, reg(), imm_below(kQCount));
    case OperandFormat::kRegM: return Instruction::with_imm(op, reg(), imm_below(kMCount));
    case OperandFormat::kRegI: return Instruction::with_imm(op, reg(), imm_below(kICount));
    case OperandFormat::kRegC: return Instruction::with_imm(op, reg(), imm_below(kCCount));
    case OperandFormat::kRegD: return Instruction::with_imm(op, reg(), imm_below(kDCount));
    case OperandFormat::kRegRegClass: return Instruction::with_bc(op, reg(), reg(), below(8));
    case OperandFormat::kRegElement: return Instruction::with_imm(op, reg(), imm_below(module_.element_refs.size()));
    case OperandFormat::kFunc: {
      Function function = any(Function::kCount);
      while (function_info(function).uses_memory != (op == Opcode::kMemoryFunction)) function = any(Function::kCount);
      return Instruction::with_bc(op, reg(), static_cast<unsigned>(function), reg(9));
    }
    case OperandFormat::kJump:
    case OperandFormat::kRegJump: return Instruction::with_imm(op, reg(), static_cast<std::int32_t>(pc + 1 + below(size - pc - 1)));
    case OperandFormat::kLoop:
    case OperandFormat::kRegLoop: return Instruction::with_imm(op, reg(), imm_below(pc + 1));
    case OperandFormat::kTarget: return Instruction::with_imm(op, 0, imm_below(size));
    case OperandFormat::kCallTarget: return Instruction::with_imm(op, 0, imm_below(module_.call_targets.size()));
    case OperandFormat::kRegSync: return Instruction::with_imm(op, reg(), imm_below(module_.sync_targets.size()));
    case OperandFormat::kMoveMode: return Instruction::with_imm(op, below(8), 0);
    case OperandFormat::kAxisMask: return Instruction::with_imm(op, below(2), static_cast<std::int32_t>(random_()));
    case OperandFormat::kRegMotion: return Instruction::with_bc(op, reg(), below(static_cast<unsigned>(MotionParameter::kCount)));
    case OperandFormat::kRegWord: return Instruction::with_bc(op, reg(), 0, below(static_cast<unsigned>(WordKind::kCount)));
    case OperandFormat::kControl: {
      const ControlVerb verb = any(ControlVerb::kCount);
      return Instruction::with_bc(op, static_cast<unsigned>(verb), reg(3), static_cast<unsigned>(control_argument_count(verb)));
    }
    case OperandFormat::kCard: {
      const CardVerb verb = any(CardVerb::kCount);
      return Instruction::with_bc(op, static_cast<unsigned>(verb), reg(5), static_cast<unsigned>(card_verb_info(verb).argument_count));
    }
    case OperandFormat::kString:
    case OperandFormat::kPortString:
    case OperandFormat::kRegString: return Instruction::with_imm(op, reg(), imm_below(module_.strings.size()));
    case OperandFormat::kAxisDef: return Instruction::with_imm(op, 0, imm_below(module_.axis_definitions.size()));
    case OperandFormat::kPointerDef: return Instruction::with_imm(op, 0, imm_below(module_.pointer_definitions.size()));
    case OperandFormat::kRegWordOf: return Instruction::with_bc(op, reg(), 1 + below(kLetterCount), below(flip() ? 4 : kMaxLineWords));
    case OperandFormat::kWordJump: return Instruction::with_imm(op, below(4), static_cast<std::int32_t>(pc + 1 + below(size - pc - 1)));
    case OperandFormat::kWord: return Instruction::with_imm(op, below(4), 0);
    case OperandFormat::kCodeOf: return Instruction::with_bc(op, reg(), static_cast<unsigned>(letter_number(std::string(1, "DFGHMST"[below(7)]))), below(4));
    case OperandFormat::kLetters: return Instruction::with_imm(op, 0, 0);  // constant 0 is a mask
    case OperandFormat::kRegRun: return Instruction::with_imm(op, reg(), imm_below(module_.move_runs.size()));
    case OperandFormat::kProgram: return Instruction::with_imm(op, 0, 0);  // program 0 is a buffer
  }
  return {};
}

Program Maker::program(ProgramKind kind, std::uint32_t number) {
  Program result;
  result.kind = kind;
  result.number = number;
  result.name = word();
  result.local_count = kLocals;
  result.frame_size = kRegisters;
  result.outgoing_count = kOutgoing;
  result.source = place();
  const std::uint32_t size = 2 + below(60);
  for (std::uint32_t pc = 0; pc < size; ++pc) {
    result.code.push_back(instruction(result, pc, size));
    if (flip()) result.lines.push_back({pc, place()});
    if (below(8) == 0) result.labels.push_back({static_cast<std::uint32_t>(result.labels.size()), pc});
  }
  return result;
}

Module Maker::make() {
  fill_tables();
  module_.programs.push_back(program(ProgramKind::kProg, 1));
  for (unsigned i = below(4); i > 0; --i) module_.programs.push_back(program(ProgramKind::kSubprog, i));
  module_.programs.push_back(program(ProgramKind::kOnline, 0));
  module_.load_order.push_back(static_cast<std::uint32_t>(module_.programs.size() - 1));
  return std::move(module_);
}

}  // namespace

bytecode::Module random_module(std::uint32_t seed) { return Maker(seed).make(); }

void damage(bytecode::Module& module, std::mt19937& random) {
  Program& program = module.programs[random() % module.programs.size()];
  Instruction& instruction = program.code[random() % program.code.size()];
  const auto wild = static_cast<std::uint32_t>(random() % 2 ? random() : random() % 64);
  switch (random() % 14) {
    case 0: instruction.op = static_cast<Opcode>(wild); break;
    case 1: instruction.a = static_cast<std::uint16_t>(wild); break;
    case 2: instruction.imm = static_cast<std::int32_t>(wild); break;
    case 3: instruction = Instruction::with_bc(instruction.op, instruction.a, wild & 0xffffu, instruction.c()); break;
    case 4: instruction = Instruction::with_bc(instruction.op, instruction.a, instruction.b(), wild & 0xffffu); break;
    case 5: program.frame_size = wild; break;
    case 6: program.outgoing_count = wild; break;
    case 7: program.local_count = wild; break;
    case 8: program.code.resize(1 + wild % program.code.size()); break;
    case 9: module.element_refs[wild % module.element_refs.size()].index[random() % 3].value = static_cast<std::uint32_t>(random()); break;
    case 10: module.sync_targets[wild % module.sync_targets.size()].number = static_cast<std::int32_t>(random()); break;
    case 11: module.move_runs[wild % module.move_runs.size()].words[0] = static_cast<std::uint8_t>(random()); break;
    case 12: module.move_runs[wild % module.move_runs.size()].first_word.back() = wild; break;
    default: module.constants.resize(wild % (module.constants.size() + 1)); break;
  }
}

}  // namespace pmac::reference
