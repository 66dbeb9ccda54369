// Proves that a module is safe to execute: the tables here, the programs in verify_code.cpp.
#include <array>
#include <cmath>

#include "compiler/bytecode/element.h"
#include "compiler/bytecode/module_text.h"
#include "compiler/bytecode/verify_code.h"

namespace pmac::bytecode {
namespace {

std::string verify_element(const ElementRef& ref) {
  if (ref.id >= ElementId::kCount) return "no such element";
  const ElementInfo& info = element_info(ref.id);
  for (int i = 0; i < kMaxElementIndices; ++i) {
    const ElementRef::Index& index = ref.index[i];
    const int count = info.index_counts[i];
    if (count == 0 && (index.is_register || index.value != 0)) return "element has no such index";
    if (count > 0 && !index.is_register && index.value >= static_cast<std::uint32_t>(count)) {
      return std::string(info.name) + " has no index " + std::to_string(index.value);
    }
  }
  return {};
}

bool can_be_synchronous(VariableClass variable_class) {
  return variable_class <= VariableClass::kElement && variable_class != VariableClass::kR &&
         variable_class != VariableClass::kC;
}

std::string verify_sync(const Module& module, const SyncTarget& target) {
  if (!can_be_synchronous(target.variable_class)) return "no synchronous assignment to this class of variables";
  if (target.op >= AssignOp::kCount) return "no such assignment";
  if (target.variable_class == VariableClass::kElement) {
    return target.element < module.element_refs.size() ? std::string() : "no such element reference";
  }
  const bool in_range = target.number >= 0 && target.number < variable_class_count(target.variable_class);
  return in_range || target.number_register != 0xffff ? std::string() : "variable number out of range";
}

std::string verify_axis(const Module&, const AxisDefinition& definition) {
  if (definition.motor < -1 || definition.motor >= kMaxMotors) return "no such motor";
  if (definition.kind >= AxisDefinitionKind::kCount) return "no such kind of axis definition";
  if (definition.spindle > 2) return "no such spindle";
  if (!std::isfinite(definition.offset_mu)) return "offset is not finite";
  if (definition.terms.size() > kAxisCount) return "too many axes";
  for (const AxisTerm& term : definition.terms) {
    if (term.axis >= kAxisCount) return "no such axis";
    if (!std::isfinite(term.coefficient_mu_per_uu)) return "coefficient is not finite";
  }
  return {};
}

bool has_only_constant_indices(const ElementRef& ref) {
  for (const ElementRef::Index& index : ref.index) {
    if (index.is_register) return false;
  }
  return true;
}

std::string verify_pointer_element(const Module& module, const PointerDefinition& definition) {
  if (definition.element >= module.element_refs.size()) return "no such element reference";
  const ElementRef& ref = module.element_refs[definition.element];
  return !ref.address && has_only_constant_indices(ref) ? std::string() : "not an element with constant indices";
}

std::string verify_pointer(const Module& module, const PointerDefinition& definition) {
  if (definition.first_m < 0 || definition.last_m < definition.first_m || definition.last_m >= kMCount) {
    return "M variable out of range";
  }
  if (definition.kind >= PointerKind::kCount) return "no such kind of pointer";
  const bool is_range = definition.first_m != definition.last_m;
  if (is_range && definition.kind != PointerKind::kSelf) return "only M variables of their own can be a range";
  if (definition.width < 1 || definition.start_bit + definition.width > 32) return "bit field does not fit into 32 bits";
  return definition.kind == PointerKind::kElement ? verify_pointer_element(module, definition) : std::string();
}

std::string verify_symbol(const Module&, const Symbol& symbol) {
  return symbol.kind < SymbolKind::kCount ? std::string() : "no such kind of symbol";
}

constexpr bool is_move_word(std::uint8_t code) {
  const int index = move_word_index(code);
  switch (move_word_kind(code)) {
    case WordKind::kTarget:
    case WordKind::kVelocity:
    case WordKind::kTriggerDistance: return true;
    case WordKind::kCenter: return index < 6;
    case WordKind::kRadius: return index == 0;
    default: return false;
  }
}

/// is_move_word() of every code.
constexpr std::array<bool, 256> kMoveWords = [] {
  std::array<bool, 256> are{};
  for (unsigned code = 0; code < 256; ++code) are[code] = is_move_word(static_cast<std::uint8_t>(code));
  return are;
}();

std::string verify_run(const Module& module, const MoveRun& run) {
  const std::size_t rows = run.row_count();
  if (rows == 0 || rows > kMaxRunRows || run.words.size() > kMaxRunWords) return "wrong number of rows";
  if (run.first_word.size() != rows + 1 || run.column.size() != rows || run.values.size() != run.words.size()) return "columns differ in length";
  if (run.file < 0 || static_cast<std::size_t>(run.file) >= module.files.size()) return "no such file";
  if (run.first_word.front() != 0 || run.first_word.back() != run.words.size()) return "rows do not share out the words";
  for (std::size_t row = 0; row < rows; ++row) {
    if (run.first_word[row] >= run.first_word[row + 1]) return "a row has no words";
    if (run.line[row] > 0x7fffffffu) return "wrong line";
  }
  for (const std::uint8_t code : run.words)
    if (!kMoveWords[code]) return "no such word";
  return {};
}

/// First complaint of check(module, entry) over a table, with the entry's place.
template <class T, class Check>
std::string verify_table(const Module& module, const std::vector<T>& table, const char* what, Check check) {
  if (table.size() > 0x7fffffffu) return std::string("too many entries: ") + what;
  for (std::size_t i = 0; i < table.size(); ++i) {
    if (std::string why = check(module, table[i]); !why.empty()) return what + (" " + std::to_string(i)) + ": " + why;
  }
  return {};
}

std::string verify_tables(const Module& module) {
  const auto element = [](const Module&, const ElementRef& ref) { return verify_element(ref); };
  const auto call = [](const Module&, const CallTarget& target) {
    return target.label >= -1 && target.label <= 0xffffffffll ? std::string() : std::string("no such label");
  };
  if (auto why = verify_table(module, module.element_refs, "element reference", element); !why.empty()) return why;
  if (auto why = verify_table(module, module.sync_targets, "synchronous target", verify_sync); !why.empty()) return why;
  if (auto why = verify_table(module, module.call_targets, "call target", call); !why.empty()) return why;
  if (auto why = verify_table(module, module.axis_definitions, "axis definition", verify_axis); !why.empty()) return why;
  if (auto why = verify_table(module, module.pointer_definitions, "pointer definition", verify_pointer); !why.empty()) {
    return why;
  }
  if (auto why = verify_table(module, module.move_runs, "move run", verify_run); !why.empty()) return why;
  return verify_table(module, module.symbols, "symbol", verify_symbol);
}

std::string verify_load_order(const Module& module) {
  for (const std::uint32_t index : module.load_order) {
    if (index >= module.programs.size()) return "load order: no program " + std::to_string(index);
    if (module.programs[index].kind != ProgramKind::kOnline) return "load order: not a load script";
  }
  return {};
}

}  // namespace

std::string verify(const Module& module) {
  if (std::string why = verify_tables(module); !why.empty()) return why;
  for (const Program& program : module.programs) {
    if (std::string why = verify_program(module, program); !why.empty()) return program_title(program) + ": " + why;
  }
  return verify_load_order(module);
}

}  // namespace pmac::bytecode
