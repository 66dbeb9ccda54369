// The readable form of a module: its tables, then its programs, one instruction a line with the source place at the right
// of the first instruction of a line.
#include <algorithm>
#include <cmath>

#include "compiler/bytecode/card.h"
#include "compiler/bytecode/control.h"
#include "compiler/bytecode/function.h"
#include "compiler/bytecode/letters.h"
#include "compiler/bytecode/missing.h"
#include "compiler/bytecode/module_text.h"
#include "compiler/bytecode/opcode.h"

namespace pmac::bytecode {
namespace {

constexpr std::size_t kSourceColumn = 48;

std::string padded(std::string text, std::size_t width) {
  if (text.size() < width) text.resize(width, ' ');
  return text;
}

std::string right_aligned(std::string text, std::size_t width) {
  return text.size() < width ? std::string(width - text.size(), ' ') + text : text;
}

std::string constant_text(double value) { return is_missing(value) ? "missing" : is_all(value) ? "all" : number_text(value); }

/// Texts of the operands of one instruction. Numbers outside the tables are shown as they are, so that a module that
/// verify() refuses can be looked at.
class OperandText {
 public:
  OperandText(const Module& module, const Program& program, const Instruction& in)
      : module_(module), program_(program), in_(in) {}
  std::string text() const;

 private:
  std::string reg(unsigned number) const { return register_name(program_, number); }
  std::string a_and(const std::string& rest) const { return reg(in_.a) + ", " + rest; }
  std::string variable(const char* letter) const { return a_and(letter + std::to_string(in_.imm)); }
  std::string target() const { return "-> " + std::to_string(in_.imm); }
  template <class T, class ToText>
  std::string entry(const std::vector<T>& table, ToText to_text) const {
    const bool exists = in_.imm >= 0 && static_cast<std::size_t>(in_.imm) < table.size();
    return exists ? to_text(table[static_cast<std::size_t>(in_.imm)]) : "?" + std::to_string(in_.imm);
  }
  std::string string() const { return entry(module_.strings, quoted); }
  std::string element() const {
    return entry(module_.element_refs, [&](const ElementRef& ref) { return element_text(program_, ref); });
  }
  std::string registers(unsigned first, int count) const;
  std::string axes() const;
  std::string sync() const;
  std::string call() const;
  std::string word() const;
  std::string control() const;
  std::string card() const;
  std::string letters() const;

  const Module& module_;
  const Program& program_;
  const Instruction& in_;
};

std::string OperandText::registers(unsigned first, int count) const {
  std::string result;
  for (int i = 0; i < count; ++i) result += (i == 0 ? "" : ", ") + reg(first + static_cast<unsigned>(i));
  return result;
}

std::string OperandText::axes() const {
  const auto mask = static_cast<std::uint32_t>(in_.imm);
  if (mask == 0xffffffffu) return in_.a == 0 ? "all" : "all, second";
  std::string names;
  for (int axis = 0; axis < kAxisCount; ++axis) {
    if (((mask >> axis) & 1u) == 0) continue;
    if (!names.empty()) names += ' ';
    names += axis_name(axis);
  }
  if (names.empty()) names = "none";
  return in_.a == 0 ? names : names + ", second";
}

std::string assign_operator(AssignOp op) {
  static constexpr const char* kTexts[] = {"==", "+==", "-==", "*==", "/==", "%==", "&==", "|==", "^==", "<<==", ">>=="};
  return op < AssignOp::kCount ? kTexts[static_cast<std::size_t>(op)] : "?";
}

std::string OperandText::sync() const {
  return entry(module_.sync_targets, [&](const SyncTarget& target) {
    std::string name = variable_class_name(target.variable_class);
    if (target.variable_class == VariableClass::kElement) {
      const bool exists = target.element < module_.element_refs.size();
      name = exists ? element_text(program_, module_.element_refs[target.element]) : "?";
    } else if (target.number_register != 0xffff) {
      name += "(" + reg(target.number_register) + ")";
    } else {
      name += std::to_string(target.number);
    }
    return name + " " + assign_operator(target.op) + " " + reg(in_.a);
  });
}

std::string OperandText::call() const {
  return entry(module_.call_targets, [&](const CallTarget& target) {
    const std::string name = "subprog " + std::to_string(target.subprogram);
    return target.label < 0 ? name : name + " N" + std::to_string(target.label);
  });
}

std::string word_name(WordKind kind, int index) {
  static constexpr const char* kCenters[] = {"I", "J", "K", "II", "JJ", "KK"};
  std::string name(axis_name(index));
  if (kind == WordKind::kCenter) name = index < 6 ? kCenters[index] : "?";
  if (kind == WordKind::kRadius) name = "R";
  if (kind == WordKind::kVelocity) name += " velocity";
  if (kind == WordKind::kTriggerDistance) name += " trigger";
  return name;
}

std::string OperandText::word() const { return word_name(static_cast<WordKind>(in_.c()), in_.b()) + ", " + reg(in_.a); }

std::string OperandText::control() const {
  const std::string verb(control_verb_name(static_cast<ControlVerb>(in_.a)));
  return in_.c() == 0 ? verb : verb + ", " + registers(in_.b(), in_.c() > kMaxArguments ? kMaxArguments : in_.c());
}

std::string OperandText::card() const {
  const std::string verb(card_verb_info(static_cast<CardVerb>(in_.a)).text);
  return in_.c() == 0 ? verb : verb + ", " + registers(in_.b(), in_.c() > kMaxArguments ? kMaxArguments : in_.c());
}

std::string OperandText::letters() const {
  return entry(module_.constants, [](double mask) {
    std::string names;
    for (int letter = 1; letter <= kLetterCount; ++letter) {
      if (std::fmod(std::floor(std::ldexp(mask, 1 - letter)), 2) != 1) continue;
      names += (names.empty() ? "" : " ") + letter_name(letter);
    }
    return names;
  });
}

std::string OperandText::text() const {
  switch (opcode_info(in_.op).format) {
    case OperandFormat::kNone: return {};
    case OperandFormat::kReg: return reg(in_.a);
    case OperandFormat::kReg3: return registers(in_.a, 3) + (in_.imm == 1 ? ", second" : "");
    case OperandFormat::kRegReg: return a_and(reg(in_.b()));
    case OperandFormat::kRegRegReg: return a_and(reg(in_.b()) + ", " + reg(in_.c()));
    case OperandFormat::kRegConst: return a_and(entry(module_.constants, constant_text));
    case OperandFormat::kRegInt: return a_and(std::to_string(in_.imm));
    case OperandFormat::kRegP: return variable("P");
    case OperandFormat::kRegQ: return variable("Q");
    case OperandFormat::kRegM: return variable("M");
    case OperandFormat::kRegI: return variable("I");
    case OperandFormat::kRegC: return variable("C");
    case OperandFormat::kRegD: return variable("D");
    case OperandFormat::kRegRegClass:
      return a_and(variable_class_name(static_cast<VariableClass>(in_.c())) + "(" + reg(in_.b()) + ")");
    case OperandFormat::kRegElement: return a_and(element());
    case OperandFormat::kFunc: {
      const FunctionInfo& function = function_info(static_cast<Function>(in_.b()));
      return a_and(std::string(function.name) + "(" + registers(in_.c(), function.argument_count) + ")");
    }
    case OperandFormat::kJump: return target();
    case OperandFormat::kRegJump: return a_and(target());
    case OperandFormat::kLoop: return target();
    case OperandFormat::kRegLoop: return a_and(target());
    case OperandFormat::kTarget: return target();
    case OperandFormat::kCallTarget: return call();
    case OperandFormat::kRegSync: return sync();
    case OperandFormat::kMoveMode: return std::string(move_mode_name(static_cast<MoveMode>(in_.a)));
    case OperandFormat::kAxisMask: return axes();
    case OperandFormat::kRegMotion:
      return std::string(motion_parameter_name(static_cast<MotionParameter>(in_.b()))) + ", " + reg(in_.a);
    case OperandFormat::kRegWord: return word();
    case OperandFormat::kControl: return control();
    case OperandFormat::kCard: return card();
    case OperandFormat::kString: return string();
    case OperandFormat::kPortString: return std::to_string(in_.a) + ", " + string();
    case OperandFormat::kRegString: return a_and(string());
    case OperandFormat::kAxisDef: return "axis " + std::to_string(in_.imm);
    case OperandFormat::kPointerDef: return "pointer " + std::to_string(in_.imm);
    case OperandFormat::kRegWordOf: return std::to_string(in_.c()) + ": " + letter_name(in_.b()) + " " + reg(in_.a);
    case OperandFormat::kWordJump: return std::to_string(in_.a) + ", " + target();
    case OperandFormat::kWord: return std::to_string(in_.a);
    case OperandFormat::kCodeOf: return letter_name(in_.b()) + " " + reg(in_.a) + ", words from " + std::to_string(in_.c());
    case OperandFormat::kLetters: return letters();
    case OperandFormat::kRegRun:
      return a_and(entry(module_.move_runs, [](const MoveRun& run) { return std::to_string(run.row_count()) + " rows"; }));
    case OperandFormat::kProgram: return entry(module_.programs, program_title);
  }
  return {};
}

std::string axis_definition_text(const AxisDefinition& definition) {
  std::string text = definition.motor < 0 ? "#" : "#" + std::to_string(definition.motor);
  text += "->";
  if (definition.kind == AxisDefinitionKind::kNull) return text + "0";
  if (definition.kind == AxisDefinitionKind::kInverseKinematics) return text + "I";
  if (definition.kind == AxisDefinitionKind::kSpindle) {
    return text + (definition.spindle == 0 ? "S" : "S" + std::to_string(definition.spindle - 1));
  }
  for (std::size_t i = 0; i < definition.terms.size(); ++i) {
    const AxisTerm& term = definition.terms[i];
    if (i > 0 && !(term.coefficient_mu_per_uu < 0)) text += '+';
    text += number_text(term.coefficient_mu_per_uu) + std::string(axis_name(term.axis));
  }
  if (definition.offset_mu != 0) text += (definition.offset_mu > 0 ? "+" : "") + number_text(definition.offset_mu);
  return text;
}

std::string field_text(const PointerDefinition& definition) {
  return "." + std::to_string(definition.start_bit) + "." + std::to_string(definition.width);
}

std::string hex_text(std::uint32_t value) {
  static constexpr char kHex[] = "0123456789ABCDEF";
  std::string digits;
  for (; value != 0 || digits.empty(); value >>= 4) digits.insert(digits.begin(), kHex[value & 15u]);
  return "$" + digits;
}

std::string pointer_target_text(const Module& module, const PointerDefinition& definition) {
  const std::string sign = definition.is_signed ? "s" : "u";
  switch (definition.kind) {
    case PointerKind::kSelf: return definition.has_field ? (definition.is_signed ? "*i." : "*u.") + std::to_string(definition.width) : "*";
    case PointerKind::kIo: return sign + ".io:" + hex_text(definition.address) + field_text(definition);
    case PointerKind::kUserInteger: return sign + ".user:" + std::to_string(definition.address) + field_text(definition);
    case PointerKind::kUserFloat: return "f.user:" + std::to_string(definition.address);
    case PointerKind::kUserDouble: return "d.user:" + std::to_string(definition.address);
    case PointerKind::kElement: {
      const bool exists = definition.element < module.element_refs.size();
      const std::string name = exists ? element_text(Program{}, module.element_refs[definition.element]) : "?";
      return definition.has_field ? name + field_text(definition) : name;
    }
    case PointerKind::kCount: break;
  }
  return "?";
}

std::string pointer_text(const Module& module, const PointerDefinition& definition) {
  std::string text = "M" + std::to_string(definition.first_m);
  if (definition.last_m != definition.first_m) text += ".." + std::to_string(definition.last_m);
  text += "->" + pointer_target_text(module, definition);
  return definition.name.empty() ? text : text + "  (" + definition.name + ")";
}

std::string symbol_text(const Symbol& symbol) {
  static constexpr const char* kKinds[] = {"global", "csglobal", "ptr", "prog", "plc", "subprog", "macro"};
  std::string text = symbol.kind < SymbolKind::kCount ? kKinds[static_cast<std::size_t>(symbol.kind)] : "?";
  text += " " + symbol.name;
  if (symbol.kind == SymbolKind::kMacro) return text + " " + symbol.text;
  if (symbol.size > 0) text += "(" + std::to_string(symbol.size) + ")";
  static constexpr const char* kLetters[] = {"P", "Q", "M"};
  text += " = ";
  if (symbol.kind <= SymbolKind::kPointer) text += kLetters[static_cast<std::size_t>(symbol.kind)];
  return text + std::to_string(symbol.number);
}

template <class T, class ToText>
void add_table(std::string& out, const char* title, const std::vector<T>& table, ToText to_text) {
  if (table.empty()) return;
  out += std::string(title) + "\n";
  for (std::size_t i = 0; i < table.size(); ++i) out += right_aligned(std::to_string(i), 6) + "  " + to_text(table[i]) + "\n";
  out += "\n";
}

void add_instruction(std::string& out, const Module& module, const Program& program, std::uint32_t pc) {
  std::string line = right_aligned(std::to_string(pc), 6) + "  " + instruction_text(module, program, program.code[pc]);
  const SourceLine source = source_of(program, pc);
  const bool starts_line = pc == 0 || !(source == source_of(program, pc - 1));
  if (starts_line && source.file >= 0) line = padded(line, kSourceColumn) + "  ; " + to_string(module, source);
  out += line + "\n";
}

void add_move_run(std::string& out, const Module& module, std::size_t number) {
  const MoveRun& run = module.move_runs[number];
  out += "move run " + std::to_string(number) + ": " + std::to_string(run.row_count()) + " rows\n";
  const std::size_t rows = std::min({run.row_count(), run.column.size(), std::max<std::size_t>(run.first_word.size(), 1) - 1});
  for (std::size_t row = 0; row < rows; ++row) {
    std::string line = right_aligned(std::to_string(row), 6) + " ";
    for (std::size_t i = run.first_word[row]; i < std::min<std::size_t>(run.first_word[row + 1], std::min(run.words.size(), run.values.size())); ++i)
      line += " " + word_name(move_word_kind(run.words[i]), move_word_index(run.words[i])) + " " + number_text(run.values[i]);
    out += padded(line, kSourceColumn) + "  ; " + to_string(module, run.source(row)) + "\n";
  }
  out += "\n";
}

std::vector<LabelEntry> labels_by_place(const Program& program) {
  std::vector<LabelEntry> labels = program.labels;
  std::stable_sort(labels.begin(), labels.end(), [](const auto& left, const auto& right) { return left.pc < right.pc; });
  return labels;
}

void add_program(std::string& out, const Module& module, const Program& program) {
  std::string line = program_title(program) + ": " + std::to_string(program.local_count) + " locals, " +
                     std::to_string(program.frame_size) + " registers, " + std::to_string(program.outgoing_count) +
                     " outgoing";
  if (program.source.file >= 0) line = padded(line, kSourceColumn) + "  ; " + to_string(module, program.source);
  out += line + "\n";
  const std::vector<LabelEntry> labels = labels_by_place(program);
  auto label = labels.begin();
  for (std::uint32_t pc = 0; pc < program.code.size(); ++pc) {
    for (; label != labels.end() && label->pc == pc; ++label) out += "  N" + std::to_string(label->number) + ":\n";
    add_instruction(out, module, program, pc);
  }
  out += "\n";
}

}  // namespace

std::string instruction_text(const Module& module, const Program& program, const Instruction& in) {
  const std::string operands = OperandText(module, program, in).text();
  const std::string name(opcode_info(in.op).text);
  return operands.empty() ? name : padded(name, 14) + operands;
}

std::string disassemble(const Module& module) {
  std::string out;
  add_table(out, "files", module.files, [](const std::string& name) { return name; });
  add_table(out, "symbols", module.symbols, symbol_text);
  add_table(out, "axis definitions", module.axis_definitions, axis_definition_text);
  add_table(out, "pointer definitions", module.pointer_definitions,
            [&](const PointerDefinition& definition) { return pointer_text(module, definition); });
  for (std::size_t i = 0; i < module.move_runs.size(); ++i) add_move_run(out, module, i);
  for (const Program& program : module.programs) add_program(out, module, program);
  if (!module.load_order.empty()) {
    out += "load order:";
    for (const std::uint32_t index : module.load_order) out += " " + std::to_string(index);
    out += "\n";
  }
  return out;
}

}  // namespace pmac::bytecode
