// Calls and jumps: what is called must exist, and what comes back needs a variable to go to.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "compiler/sema/binder.h"

namespace pmac::compiler::sema {

using bytecode::SymbolKind;

void Binder::bind(ir::Jump& node, const source::Span& span) {
  bind_arguments_of_call(node.arguments, node.by_reference);
  if (node.kind != ir::JumpKind::kCallsub && !node.arguments.empty()) diagnostics_.error("PM3026", span, "only call and callsub take arguments");
  if (!node.name.empty()) bind_routine_name(node, span);
  if (!node.label) return;
  bind_value(*node.label);
  const auto constant = ir::constant_value(*node.label);
  if (!constant) return;
  const bool whole = *constant >= 0 && *constant <= 4294967295.0 && *constant == std::floor(*constant);
  if (whole) jumps_.emplace_back(static_cast<std::int64_t>(*constant), span);
  else diagnostics_.error("PM3027", span, "a label is a whole number from 0 to 4294967295");
}

void Binder::bind_routine_name(ir::Jump& node, const source::Span& span) {
  if (buffer_) {
    for (const ir::Routine& routine : buffer_->routines) {
      if (routine.name != node.name) continue;
      node.label = ir::make_number(static_cast<double>(routine.label), span);
      mark_references(node.by_reference, node.arguments, routine.parameters, span, node.name);
      return;
    }
  }
  diagnostics_.error("PM3028", span, fmt::format("this buffer has no routine '{}'", node.name));
}

/// &P100 among the arguments of a call: the value comes back in it. What is called need not say so where its parameters are not known.
void Binder::bind_arguments_of_call(std::vector<ir::ExprPtr>& arguments, std::vector<bool>& by_reference) {
  by_reference.clear();
  for (ir::ExprPtr& argument : arguments) {
    auto* address = std::get_if<ir::AddressOf>(&argument->node);
    by_reference.push_back(address != nullptr);
    if (address) {
      ir::ExprPtr place = std::move(address->place);
      place->span = argument->span;
      argument = std::move(place);
    }
    bind_value(*argument);
    if (by_reference.back()) check_returned(*argument, "the call");
  }
}

void Binder::check_returned(const ir::Expr& argument, std::string_view name) {
  if (is_assignable(argument)) return;
  diagnostics_.error("PM3035", argument.span, fmt::format("{} returns a value in this argument, so it must be a variable", name));
}

void Binder::mark_references(std::vector<bool>& by_reference, std::vector<ir::ExprPtr>& arguments, const std::vector<ir::Parameter>& parameters, const source::Span& span, std::string_view name) {
  if (arguments.size() != parameters.size())
    diagnostics_.error("PM3029", span, fmt::format("'{}' takes {} argument(s), not {}", name, parameters.size(), arguments.size()));
  for (std::size_t i = 0; i < std::min(arguments.size(), parameters.size()); ++i) {
    if (by_reference[i] && !parameters[i].by_reference) {
      auto& error = diagnostics_.error("PM3038", arguments[i]->span, fmt::format("'{}' returns nothing in '{}'; leave out the &, or declare it as &{}", name, parameters[i].name, parameters[i].name));
      if (parameters[i].span.valid()) error.notes.push_back({parameters[i].span, "the parameter is declared here"});
    }
    if (!by_reference[i] && parameters[i].by_reference) check_returned(*arguments[i], fmt::format("'{}'", name));
    by_reference[i] = parameters[i].by_reference;
  }
}

void Binder::bind(ir::Call& node, const source::Span& span) {
  bind_arguments_of_call(node.arguments, node.by_reference);
  if (node.arguments.size() > bytecode::kMaxArguments) diagnostics_.error("PM3007", span, fmt::format("a call has at most {} arguments", bytecode::kMaxArguments));
  if (!node.name.empty()) return bind_named_call(node, span);
  bind_value(*node.number);
  const auto constant = ir::constant_value(*node.number);
  if (!constant) return;
  if (!(*constant >= 0 && *constant <= 4294967295.0)) return void(diagnostics_.error("PM3027", span, "a subprogram number is from 0 to 4294967295"));
  const double whole = std::floor(*constant);
  node.subprogram = static_cast<std::int64_t>(whole);
  const auto label = static_cast<std::int64_t>(std::llround((*constant - whole) * 1e6));
  node.label = label > 0 ? label : -1;
  const std::vector<ir::Parameter>* parameters = label > 0 ? nullptr : project_.names.parameters_of(node.subprogram);
  if (parameters && !parameters->empty()) mark_references(node.by_reference, node.arguments, *parameters, span, fmt::format("subprog {}", node.subprogram));
}

void Binder::bind_named_call(ir::Call& node, const source::Span& span) {
  const Name* name = project_.names.find(node.name);
  if (!name || name->kind != SymbolKind::kSubprog) {
    report_unknown(node.name, node.name_span, "subprogram");
    return;
  }
  node.subprogram = name->number;
  if (node.routine.empty()) return mark_references(node.by_reference, node.arguments, name->parameters, span, node.name);
  const auto routine = name->routines.find(node.routine);
  if (routine == name->routines.end()) {
    diagnostics_.error("PM3028", node.name_span, fmt::format("subprogram '{}' has no routine '{}'", node.name, node.routine));
    return;
  }
  node.label = routine->second.label;
  mark_references(node.by_reference, node.arguments, routine->second.parameters, span, node.routine);
}

}  // namespace pmac::compiler::sema
