// Second pass: expressions are bound, local variables get their numbers, everything is checked.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "compiler/bytecode/control.h"
#include "compiler/bytecode/element.h"
#include "compiler/bytecode/module_text.h"
#include "compiler/sema/binder.h"

namespace pmac::compiler::sema {
namespace {

using bytecode::ProgramKind;
using bytecode::SymbolKind;

bool uses_q_of_addressed_coord(const ir::Stmt& statement) {
  if (const auto* globals = std::get_if<ir::Globals>(&statement.node))
    return std::any_of(globals->names.begin(), globals->names.end(), [](const auto& name) { return name.variable_class == ir::VariableClass::kQ && name.value; });
  const auto* assign = std::get_if<ir::Assign>(&statement.node);
  const auto* variable = assign ? std::get_if<ir::Variable>(&assign->target->node) : nullptr;
  return variable && variable->variable_class == ir::VariableClass::kQ;
}

/// Labels of a buffer and the constant jumps to them.
void check_labels(const ir::Buffer& buffer, const std::vector<std::pair<std::int64_t, source::Span>>& labels, const std::vector<std::pair<std::int64_t, source::Span>>& jumps, source::Diagnostics& diagnostics) {
  std::map<std::int64_t, source::Span> known;
  for (const auto& [number, span] : labels) {
    const auto [at, fresh] = known.emplace(number, span);
    if (!fresh) diagnostics.error("PM3030", span, fmt::format("label N{} stands here twice", number)).notes.push_back({at->second, "the first one is here"});
  }
  for (const ir::Routine& routine : buffer.routines) known.emplace(routine.label, routine.span);
  std::set<std::int64_t> missing;
  for (const auto& [number, span] : jumps) {
    if (known.contains(number)) continue;
    if (!missing.insert(number).second) continue;
    diagnostics.error("PM3031", buffer.close_span, fmt::format("the label N{}: is missing in this buffer", number)).notes.push_back({span, "this goes to it"});
  }
}

}  // namespace

void Binder::bind_body(ir::Body& body) {
  for (ir::StmtPtr& statement : body) bind_statement(*statement);
}

void Binder::bind_optional(ir::ExprPtr& expr) {
  if (expr) bind_value(*expr);
}

void Binder::bind_statement(ir::Stmt& statement) {
  std::visit([&](auto& node) { bind(node, statement.span); }, statement.node);
}

void Binder::bind(ir::Block& node, const source::Span&) { bind_body(node.body); }

void Binder::bind(ir::Assign& node, const source::Span& span) {
  for (ir::ExprPtr& value : node.values) bind_value(*value);
  bind_target(*node.target);
  check_element_values(node, diagnostics_);
  check_list_bounds(node);
  const auto* variable = std::get_if<ir::Variable>(&node.target->node);
  const auto* element = std::get_if<ir::Element>(&node.target->node);
  const bool indexed_element = element && !element->indices.empty();
  const bool listable = (variable || indexed_element) && node.op == bytecode::AssignOp::kSet && !node.synchronous;
  if (node.values.size() > 1 && !listable) diagnostics_.error("PM3023", span, "a list of values is assigned with = to variables, or to elements with an index");
  const auto first_index = indexed_element ? ir::constant_value(*element->indices.back()) : std::nullopt;
  if (node.values.size() > 1 && first_index && element->element != bytecode::kNoElement) {
    const double last = *first_index + static_cast<double>(node.values.size()) - 1;
    const int count = bytecode::element_info(element->element).index_counts[element->indices.size() - 1];
    if (last >= count) diagnostics_.error("PM3050", span, fmt::format("the list goes on to index {}; the last one of {} is {}", last, bytecode::element_info(element->element).name, count - 1));
  }
  const bool no_sync = node.synchronous && variable && (variable->variable_class == ir::VariableClass::kR || variable->variable_class == ir::VariableClass::kC);
  if (no_sync) diagnostics_.error("PM3024", span, "R and C variables cannot be assigned synchronously; write = instead of ==");
}

/// Table(2) = 1,2,3: the list may go on behind the array.
void Binder::check_list_bounds(const ir::Assign& node) {
  const auto* variable = std::get_if<ir::Variable>(&node.target->node);
  if (!variable || variable->index || variable->name.empty()) return;
  const std::int64_t end = array_end(*variable);
  const std::int64_t last = variable->number + static_cast<std::int64_t>(node.values.size()) - 1;
  if (end == 0 || variable->number >= end || last < end) return;
  const auto beyond = static_cast<std::size_t>(end - variable->number);
  diagnostics_.warning("PM3047", node.values[beyond]->span, fmt::format("the list goes on behind the end of the array '{}'", variable->name));
}

/// P1,10,2=5: every variable of the series must exist.
void Binder::bind(ir::AssignSeries& node, const source::Span& span) {
  bind_target(*node.target);
  bind_value(*node.value);
  const auto* first = std::get_if<ir::Variable>(&node.target->node);
  if (!first) return;
  if (first->index) return void(diagnostics_.error("PM3023", span, "a series of variables begins with a constant number"));
  if (node.count < 1) return void(diagnostics_.error("PM3023", span, "a series has at least one variable"));
  const std::int64_t last = first->number + (node.count - 1) * node.step;
  const std::string letter = bytecode::variable_class_name(first->variable_class);
  const int most = bytecode::variable_class_count(first->variable_class) - 1;
  if (last > most) diagnostics_.error("PM3045", span, fmt::format("the series goes on to {0}{1}; the last one is {0}{2}", letter, last, most));
}

void Binder::bind(ir::If& node, const source::Span&) {
  for (ir::IfBranch& branch : node.branches) {
    bind_condition(*branch.condition);
    bind_statement(*branch.body);
  }
  if (node.otherwise) bind_statement(*node.otherwise);
}

void Binder::bind(ir::While& node, const source::Span&) {
  bind_condition(*node.condition);
  ++loops_;
  bind_statement(*node.body);
  --loops_;
}

void Binder::bind(ir::DoWhile& node, const source::Span&) {
  ++loops_;
  bind_statement(*node.body);
  --loops_;
  bind_condition(*node.condition);
}

void Binder::bind(ir::Switch& node, const source::Span&) {
  bind_value(*node.value);
  std::set<std::int64_t> seen;
  bool has_default = false;
  for (ir::Case& label : node.cases) {
    if (!label.value) {
      if (has_default) diagnostics_.error("PM3033", label.span, "this default stands here twice");
      has_default = true;
      continue;
    }
    bind_value(*label.value);
    const auto value = ir::constant_value(*label.value);
    if (!value) diagnostics_.error("PM3032", label.span, "the value of a case is a constant");
    else if (!seen.insert(static_cast<std::int64_t>(std::clamp(*value, -9e15, 9e15))).second) diagnostics_.error("PM3033", label.span, "this case stands here twice");
  }
  ++switches_;
  bind_body(node.body);
  --switches_;
}

void Binder::bind(ir::Break&, const source::Span& span) {
  if (loops_ == 0 && switches_ == 0) diagnostics_.error("PM3034", span, "break stands outside of a loop or switch");
}

void Binder::bind(ir::Continue&, const source::Span& span) {
  if (loops_ == 0) diagnostics_.error("PM3034", span, "continue stands outside of a loop");
}

void Binder::bind(ir::Label& node, const source::Span& span) { labels_.emplace_back(node.number, span); }

void Binder::bind(ir::Locals& node, const source::Span& span) {
  if (!buffer_) diagnostics_.error("PM3025", span, "local variables belong to a program buffer");
  for (ir::LocalDeclaration& name : node.names) {
    bind_optional(name.value);
    std::int64_t size = 0;
    if (name.size) {
      bind_value(*name.size);
      const auto value = ir::constant_value(*name.size);
      if (value && *value >= 1 && *value <= bytecode::kLCount) size = static_cast<std::int64_t>(*value);
      else diagnostics_.error("PM3021", name.size->span, "the size of an array is a constant of at least 1");
    }
    name.number = declare_local(name.name, size, name.name_span);
  }
}

void Binder::bind(ir::CodeLine& node, const source::Span&) {
  if (node.call) bind_statement(*node.call);
  for (ir::LineWord& word : node.words) {
    bind_value(*word.value);
    bind_optional(word.velocity);
    bind_optional(word.trigger);
  }
}

void Binder::bind(ir::LineCondition& node, const source::Span&) {
  bind_value(*node.flag);
  check_flag(*node.flag);
  bind_body(node.rest);
}

void Binder::bind(ir::SetFlag& node, const source::Span&) {
  bind_value(*node.flag);
  check_flag(*node.flag);
}

void Binder::check_flag(const ir::Expr& flag) {
  constexpr int kFlags = 32;
  const auto value = ir::constant_value(flag);
  if (value && !(*value >= 0 && *value < kFlags && *value == std::floor(*value))) diagnostics_.error("PM3090", flag.span, fmt::format("the flags of a coordinate system are numbered 0 to {}", kFlags - 1));
}

void Binder::bind(ir::Cycle& node, const source::Span&) { bind_optional(node.number); }

void Binder::bind(ir::SetParameter& node, const source::Span&) { bind_value(*node.value); }
void Binder::bind(ir::SetNormal& node, const source::Span&) { for (ir::ExprPtr& component : node.vector) bind_value(*component); }
void Binder::bind(ir::Move& node, const source::Span& span) {
  const bool kinematic = buffer_ && (buffer_->kind == ProgramKind::kForward || buffer_->kind == ProgramKind::kInverse);
  if (kinematic) diagnostics_.error("PM4006", span, "a kinematic routine cannot command moves");
  for (ir::Word& word : node.words) bind_value(*word.value);
}
void Binder::bind(ir::Dwell& node, const source::Span&) { bind_value(*node.time_ms); }
void Binder::bind(ir::Delay& node, const source::Span&) { bind_value(*node.time_ms); }

void Binder::bind(ir::AddressCoord& node, const source::Span&) {
  project_.addressed_coord = static_cast<std::int64_t>(ir::constant_value(*node.number).value_or(1));
}
void Binder::bind(ir::AddressMotor&, const source::Span&) {}

void Binder::bind(ir::DefineAxis& node, const source::Span&) {
  project_.has_axis_definitions = true;
  project_.uses_inverse_kinematics |= node.definition.kind == bytecode::AxisDefinitionKind::kInverseKinematics;
  for (const bytecode::AxisTerm& term : node.definition.terms) project_.defined_axes.insert(term.axis);
}

void Binder::bind(ir::DefinePointer& node, const source::Span& span) {
  if (node.size < 0) {
    const Name* name = project_.names.find(node.name);
    const std::int64_t index = std::max(node.definition.first_m, 0);
    const bool known = name && name->kind == SymbolKind::kPointer;
    if (!known) report_unknown(node.name, node.name_span, "pointer");
    else if (index >= std::max<std::int64_t>(name->size, 1)) diagnostics_.error("PM3004", node.name_span, fmt::format("the array '{}' of pointers has the elements 0 to {}", node.name, std::max<std::int64_t>(name->size, 1) - 1));
    node.definition.first_m = node.definition.last_m = known ? static_cast<std::int32_t>(name->number + index) : 0;
  }
  if (!node.element) return;
  bind_value(*node.element);
  const auto* element = std::get_if<ir::Element>(&node.element->node);
  const bool constant = element && !element->address && std::all_of(element->indices.begin(), element->indices.end(), [](const ir::ExprPtr& i) { return ir::constant_value(*i).has_value(); });
  if (!constant) diagnostics_.error("PM3004", span, "a pointer points at an I/O address or at an element with constant indices");
}

void Binder::bind(ir::Globals& node, const source::Span& span) {
  for (ir::GlobalDeclaration& name : node.names) {
    bind_optional(name.value);
    if (buffer_ && name.value) diagnostics_.error("PM3036", span, "a global variable that is declared inside a buffer cannot be given a value there");
  }
}

void Binder::bind(ir::Report& node, const source::Span&) { bind_value(*node.value); }

// --- buffers --------------------------------------------------------------------------------------------------------------

void Binder::begin_buffer(ir::Buffer& buffer) {
  buffer_ = &buffer;
  labels_.clear();
  jumps_.clear();
  highest_local_ = -1;
  begin_routine(buffer.parameters);
}

void Binder::begin_routine(const std::vector<ir::Parameter>& parameters) {
  const bool kinematic = buffer_->kind == ProgramKind::kForward || buffer_->kind == ProgramKind::kInverse;
  locals_.clear();
  next_local_ = kinematic ? bytecode::kFirstKinematicLocal : 0;
  if (kinematic) highest_local_ = bytecode::kFirstKinematicLocal - 1;
  for (const ir::Parameter& parameter : parameters) declare_local(parameter.name, 0, parameter.span);
}

std::int64_t Binder::declare_local(const std::string& name, std::int64_t size, const source::Span& span) {
  const std::int64_t room = std::max<std::int64_t>(size, 1);
  if (next_local_ + room > bytecode::kLCount) {
    diagnostics_.error("PM3020", span, fmt::format("no local variables are left for '{}'", name));
    return 0;
  }
  const auto [at, fresh] = locals_.emplace(name, Local{next_local_, size, span});
  if (!fresh) diagnostics_.error("PM3037", span, fmt::format("local '{}' is declared twice", name)).notes.push_back({at->second.span, "the first declaration is here"});
  next_local_ += room;
  highest_local_ = std::max(highest_local_, next_local_ - 1);
  return at->second.number;
}

void Binder::bind_buffer(ir::Buffer& buffer) {
  begin_buffer(buffer);
  if (buffer.number < 0) resolve_addressed(buffer);
  std::size_t next_routine = 0;
  for (std::size_t i = 0; i <= buffer.body.size(); ++i) {
    for (; next_routine < buffer.routines.size() && buffer.routines[next_routine].first == i; ++next_routine) begin_routine(buffer.routines[next_routine].parameters);
    if (i < buffer.body.size()) bind_statement(*buffer.body[i]);
  }
  check_labels(buffer, labels_, jumps_, diagnostics_);
  check_motion(buffer.body, diagnostics_);
  buffer.local_count = highest_local_ + 1;
  highest_local_ = -1;
  buffer_ = nullptr;
  locals_.clear();
}

/// open forward without a number belongs to the addressed coordinate system.
void Binder::resolve_addressed(ir::Buffer& buffer) {
  buffer.number = std::max<std::int64_t>(project_.addressed_coord, 0);
  if (project_.addressed_coord >= 0) return;
  diagnostics_.warning("PM6001", buffer.span, "no coordinate system is addressed; taking 1 (write &1 before it)");
  buffer.number = 1;
}

void check(ir::Unit& unit, Project& project, const Settings& settings, source::Diagnostics& diagnostics) {
  Binder binder(project, settings, diagnostics);
  for (std::size_t i = 0; i < unit.load.size(); ++i) {
    const auto* open = std::get_if<ir::OpenBuffer>(&unit.load[i]->node);
    const auto* at_once = std::get_if<ir::ExecuteAtOnce>(&unit.load[i]->node);
    if (open || at_once) {
      binder.bind_buffer(unit.buffers[open ? open->buffer : at_once->buffer]);
      continue;
    }
    binder.bind_statement(*unit.load[i]);
    unit.local_count = std::max(unit.local_count, binder.local_count());
    const bool needs_coord = project.addressed_coord < 0 && !settings.online && uses_q_of_addressed_coord(*unit.load[i]);
    if (!needs_coord) continue;
    const source::Span span = unit.load[i]->span;
    diagnostics.warning("PM6002", span, "this sets a variable of the addressed coordinate system, but none is addressed; taking 1 (write &1 before it)");
    project.addressed_coord = 1;
    unit.load.insert(unit.load.begin() + static_cast<std::ptrdiff_t>(i), ir::make_stmt(span, ir::AddressCoord{ir::make_number(1, span)}));
    ++i;
  }
}

}  // namespace pmac::compiler::sema
