// Commands for motors, coordinate systems and PLC programs: the numbers and names of what they act on.
#include <fmt/format.h>

#include <cmath>

#include "compiler/bytecode/control.h"
#include "compiler/sema/binder.h"

namespace pmac::compiler::sema {
namespace {

using bytecode::SymbolKind;
using ir::ControlVerb;

bool is_plc_verb(ControlVerb verb) { return verb >= ControlVerb::kEnablePlc && verb <= ControlVerb::kStepPlc; }

}  // namespace

void Binder::bind(ir::Control& node, const source::Span&) {
  const bool names_program = node.verb == ControlVerb::kBegin || node.verb == ControlVerb::kStart;
  for (std::size_t i = 0; i < node.arguments.size(); ++i) {
    ir::ExprPtr& argument = node.arguments[i];
    if (!argument) continue;
    auto* use = std::get_if<ir::NameUse>(&argument->node);
    const bool without_parentheses = use && argument->span.end - argument->span.begin == use->name.size();
    const bool bare_number = without_parentheses && i == 0 && !use->has_arguments && !is_plc_verb(node.verb) && node.verb != ControlVerb::kReportPointer;
    if (use && is_plc_verb(node.verb) && !is_variable(use->name)) bind_program_name(*argument, SymbolKind::kPlc, "PLC program");
    else if (use && names_program && i == 1) bind_program_name(*argument, SymbolKind::kProg, "motion program");
    else if (use && node.verb == ControlVerb::kReportPointer && use->has_arguments) bind_pointer_element(*argument);
    else if (use && node.verb == ControlVerb::kReportPointer) bind_program_name(*argument, SymbolKind::kPointer, "pointer");
    else bind_value(*argument);
    if (bare_number) check_bare_number(*argument);
  }
  check_control_number(node);
}

/// kill m: the name of a local variable; of another one its value stands in parentheses.
void Binder::check_bare_number(const ir::Expr& number) {
  const auto* variable = std::get_if<ir::Variable>(&number.node);
  if (!variable || (variable->variable_class == ir::VariableClass::kL && !variable->index)) return;
  diagnostics_.error("PM3039", number.span, fmt::format("the number of a thing is a constant, a local variable, or an expression in parentheses: ({})", variable->name)).fix =
      source::FixIt{number.span, "(" + variable->name + ")", source::FixSafety::kSuggestion, {}};
}

void Binder::check_control_number(const ir::Control& node) {
  if (node.arguments.empty() || !node.arguments[0] || node.verb == ControlVerb::kPset || node.verb == ControlVerb::kReportPointer) return;
  const auto value = ir::constant_value(*node.arguments[0]);
  if (!value) return;
  if (node.verb == ControlVerb::kReportPointer || node.verb == ControlVerb::kReportAlias) return;  // a variable
  const bool jogs = node.verb >= ControlVerb::kJogPlus && node.verb <= ControlVerb::kOpenLoop;
  const bool asks = node.verb >= ControlVerb::kReportPosition && node.verb <= ControlVerb::kReportStatus;
  const bool motor = jogs || asks || node.verb == ControlVerb::kReportAxisDefinition;
  const int most = (is_plc_verb(node.verb) ? bytecode::kMaxPlcs : motor ? bytecode::kMaxMotors : bytecode::kMaxCoords) - 1;
  const bool all = std::isinf(*value) && *value > 0;
  const bool fits = all || (*value >= 0 && *value <= most && *value == std::floor(*value));
  const char* thing = is_plc_verb(node.verb) ? "PLC program" : motor ? "motor" : "coordinate system";
  if (!fits) diagnostics_.error("PM3009", node.arguments[0]->span, fmt::format("the number of a {} is 0 to {}", thing, most));
}

/// Name(2)->: the number of the variable.
void Binder::bind_pointer_element(ir::Expr& expr) {
  bind_value(expr);
  const auto* variable = std::get_if<ir::Variable>(&expr.node);
  const bool is_pointer = variable && variable->variable_class == ir::VariableClass::kM && !variable->index;
  if (!is_pointer) diagnostics_.error("PM3004", expr.span, "an element of an array of pointers is wanted, with a constant index");
  expr.node = ir::Number{is_pointer ? static_cast<double>(variable->number) : 0};
}

void Binder::bind_program_name(ir::Expr& expr, SymbolKind kind, std::string_view what) {
  const std::string text = std::get<ir::NameUse>(expr.node).name;
  const Name* name = project_.names.find(text);
  if (name && name->kind == kind) {
    expr.node = ir::Number{static_cast<double>(name->number)};
    return;
  }
  report_unknown(text, expr.span, what);
  expr.node = ir::Number{0};
}

}  // namespace pmac::compiler::sema
