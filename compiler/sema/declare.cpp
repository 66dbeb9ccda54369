// First pass over a unit: every global name and every program gets its number.
#include <fmt/format.h>

#include "compiler/sema/sema.h"

namespace pmac::compiler::sema {
namespace {

using bytecode::ProgramKind;
using bytecode::SymbolKind;

SymbolKind symbol_kind(ProgramKind kind) {
  return kind == ProgramKind::kPlc ? SymbolKind::kPlc : kind == ProgramKind::kSubprog ? SymbolKind::kSubprog : SymbolKind::kProg;
}

class Declarer {
 public:
  Declarer(Project& project, source::Diagnostics& diagnostics) : project_(project), diagnostics_(diagnostics) {}

  void declare_globals(ir::Globals& globals) {
    const SymbolKind kind = globals.names.empty() || globals.names[0].variable_class == ir::VariableClass::kP ? SymbolKind::kGlobal : SymbolKind::kCsGlobal;
    for (ir::GlobalDeclaration& name : globals.names) {
      const auto size = array_size(name.size.get());
      warn_if_redeclared(name.name, name.name_span);
      const auto number = project_.names.declare_variable(name.name, kind, size, name.name_span);
      if (number) name.number = *number;
      else diagnostics_.error("PM3020", name.name_span, fmt::format("no variable numbers are left for '{}'", name.name));
    }
  }

  void declare_pointer(ir::DefinePointer& pointer) {
    if (pointer.name.empty() || pointer.size < 0) return;
    warn_if_redeclared(pointer.name, pointer.name_span);
    const auto number = project_.names.declare_variable(pointer.name, SymbolKind::kPointer, pointer.size, pointer.name_span);
    if (!number) diagnostics_.error("PM3020", pointer.name_span, fmt::format("no variable numbers are left for '{}'", pointer.name));
    pointer.definition.first_m = pointer.definition.last_m = static_cast<std::int32_t>(number.value_or(0));
    if (pointer.size <= 1) return;
    if (pointer.definition.kind == bytecode::PointerKind::kSelf) pointer.definition.last_m += pointer.size - 1;
    else diagnostics_.error("PM3012", pointer.name_span, fmt::format("the array '{}' of pointers can only be made self-referenced: ->*", pointer.name));
  }

  void declare_buffer(ir::Buffer& buffer) {
    const bool is_named_kind = buffer.kind == ProgramKind::kProg || buffer.kind == ProgramKind::kPlc || buffer.kind == ProgramKind::kSubprog;
    if (buffer.name.empty() && buffer.kind == ProgramKind::kSubprog) project_.names.declare_numbered(buffer.number, buffer.parameters);
    if (buffer.name.empty() || !is_named_kind) return;
    const auto number = project_.names.declare_program(buffer.name, symbol_kind(buffer.kind), buffer.span);
    if (!number) diagnostics_.error("PM3020", buffer.span, fmt::format("no program number is left for '{}'", buffer.name));
    buffer.number = number.value_or(0);
    Name* name = project_.names.find(buffer.name);
    if (!name) return;
    name->parameters = buffer.parameters;
    for (ir::Routine& routine : buffer.routines) {
      const auto known = name->routines.find(routine.name);
      routine.label = known != name->routines.end() ? known->second.label : project_.names.next_routine_label();
      name->routines[routine.name] = {routine.label, routine.parameters};
    }
  }

  void number_routines(ir::Buffer& buffer) {
    for (ir::Routine& routine : buffer.routines)
      if (routine.label < 0) routine.label = project_.names.next_routine_label();
  }

 private:
  std::int64_t array_size(const ir::Expr* size) {
    if (!size) return 0;
    const auto value = ir::constant_value(*size);
    if (value && *value >= 1 && *value <= bytecode::kPCount) return static_cast<std::int64_t>(*value);
    diagnostics_.error("PM3021", size->span, "the size of an array is a constant of at least 1");
    return 1;
  }

  void warn_if_redeclared(const std::string& name, const source::Span& span) {
    const Name* known = project_.names.find(name);
    if (!known) return;
    auto& warning = diagnostics_.warning("PM3022", span, fmt::format("'{}' is declared again", name));
    if (known->span.valid()) warning.notes.push_back({known->span, "the first declaration is here"});
  }

  Project& project_;
  source::Diagnostics& diagnostics_;
};

void declare_in_body(ir::Body& body, Declarer& declarer) {
  for (ir::StmtPtr& statement : body)
    if (auto* globals = std::get_if<ir::Globals>(&statement->node)) declarer.declare_globals(*globals);
}

}  // namespace

void reserve_numbers(const ir::Unit& unit, Project& project) {
  for (const ir::Buffer& buffer : unit.buffers)
    if (buffer.kind == ProgramKind::kPlc && buffer.name.empty()) project.names.use_plc_number(buffer.number);
}

void declare(ir::Unit& unit, Project& project, source::Diagnostics& diagnostics) {
  Declarer declarer(project, diagnostics);
  std::set<std::size_t> declared;
  const auto declare_buffer = [&](std::size_t index) {
    if (!declared.insert(index).second) return;
    declarer.declare_buffer(unit.buffers[index]);
    declarer.number_routines(unit.buffers[index]);
    declare_in_body(unit.buffers[index].body, declarer);
  };
  for (ir::StmtPtr& statement : unit.load) {  // in the order of the text
    if (auto* globals = std::get_if<ir::Globals>(&statement->node)) declarer.declare_globals(*globals);
    if (auto* pointer = std::get_if<ir::DefinePointer>(&statement->node)) declarer.declare_pointer(*pointer);
    if (auto* open = std::get_if<ir::OpenBuffer>(&statement->node)) declare_buffer(open->buffer);
  }
  for (std::size_t i = 0; i < unit.buffers.size(); ++i) declare_buffer(i);
}

}  // namespace pmac::compiler::sema
