// Expressions: names become variables, constants and function calls; elements are found in the table; types are checked.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "compiler/bytecode/element.h"
#include "compiler/bytecode/function.h"
#include "compiler/sema/binder.h"

namespace pmac::compiler::sema {
namespace {

using ir::Operator;
using ir::VariableClass;

struct ClassRange { std::string_view letter; std::int64_t count; };

ClassRange range_of(VariableClass variable_class) {
  switch (variable_class) {
    case VariableClass::kP: return {"P", bytecode::kPCount};
    case VariableClass::kQ: return {"Q", bytecode::kQCount};
    case VariableClass::kM: return {"M", bytecode::kMCount};
    case VariableClass::kI: return {"I", bytecode::kICount};
    case VariableClass::kL: return {"L", bytecode::kLCount};
    case VariableClass::kR: return {"R", bytecode::kMaxOutgoing};
    case VariableClass::kC: return {"C", bytecode::kCCount};
    default: return {"D", bytecode::kDCount};
  }
}

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return result;
}

std::optional<std::int64_t> number_suffix(std::string_view text) {
  std::int64_t value = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || read.ec != std::errc() || read.ptr != text.data() + text.size()) return std::nullopt;
  return value;
}

std::optional<std::int64_t> small_integer(const ir::Expr& expr) {
  const auto value = ir::constant_value(expr);
  if (!value || *value != std::floor(*value) || std::abs(*value) > 1e9) return std::nullopt;
  return static_cast<std::int64_t>(*value);
}

/// P(8192 + i): the constant part goes to the number, as in an array that begins there.
void fold_constant_part(ir::Variable& variable) {
  auto* sum = variable.index ? std::get_if<ir::Binary>(&variable.index->node) : nullptr;
  const auto first = sum && sum->op == Operator::kAdd ? small_integer(*sum->left) : std::nullopt;
  const auto in_range = [&](std::int64_t number) { return number >= 0 && number < range_of(variable.variable_class).count; };
  if (!first || !in_range(variable.number + *first)) return;
  variable.number += *first;
  ir::ExprPtr rest = std::move(sum->right);
  const auto constant = small_integer(*rest);
  if (constant && in_range(variable.number + *constant)) {
    variable.number += *constant;
    rest.reset();
  }
  variable.index = std::move(rest);
}

}  // namespace

void Binder::bind_value(ir::Expr& expr) {
  bind_expr(expr);
  const auto* binary = std::get_if<ir::Binary>(&expr.node);
  const auto* unary = std::get_if<ir::Unary>(&expr.node);
  const bool is_condition = (binary && (ir::is_comparison(binary->op) || binary->op == Operator::kAnd || binary->op == Operator::kOr)) || (unary && unary->op == Operator::kNot);
  if (is_condition) diagnostics_.error("PM3040", expr.span, "a comparison is no number; it stands in the condition of if or while");
  if (std::holds_alternative<ir::Text>(expr.node)) diagnostics_.error("PM3041", expr.span, "a text is no number");
}

void Binder::bind_condition(ir::Expr& expr) {
  if (auto* unary = std::get_if<ir::Unary>(&expr.node); unary && unary->op == Operator::kNot) return bind_condition(*unary->operand);
  auto* binary = std::get_if<ir::Binary>(&expr.node);
  if (binary && (binary->op == Operator::kAnd || binary->op == Operator::kOr)) {
    bind_condition(*binary->left);
    return bind_condition(*binary->right);
  }
  if (binary && ir::is_comparison(binary->op)) {
    bind_value(*binary->left);
    return bind_value(*binary->right);
  }
  bind_value(expr);
}

void Binder::bind_target(ir::Expr& expr) {
  bind_expr(expr);
  if (is_assignable(expr)) {
    const auto* element = std::get_if<ir::Element>(&expr.node);
    if (element && element->element != bytecode::kNoElement) note_stored_element(*element, expr.span);
    return;
  }
  const auto* element = std::get_if<ir::Element>(&expr.node);
  if (element && element->element == bytecode::kNoElement) return;  // reported
  if (element && element->address) diagnostics_.error("PM3042", expr.span, "the address of an element cannot be assigned");
  else if (element && !buffer_ && !settings_.online) diagnostics_.warning("PM6011", expr.span, fmt::format("{} is a status element here; this assignment is left out", bytecode::element_info(element->element).name));
  else if (element) diagnostics_.error("PM3043", expr.span, fmt::format("{} is a status element; it can only be read", bytecode::element_info(element->element).name));
  else if (!std::holds_alternative<ir::NameUse>(expr.node)) diagnostics_.error("PM3044", expr.span, "this cannot be assigned");
}

bool Binder::is_assignable(const ir::Expr& expr) const {
  if (std::holds_alternative<ir::Variable>(expr.node)) return true;
  const auto* element = std::get_if<ir::Element>(&expr.node);
  if (!element || element->element == bytecode::kNoElement || element->address) return false;
  return bytecode::element_info(element->element).access != bytecode::ElementAccess::kStatus;
}

void Binder::bind_expr(ir::Expr& expr) {
  if (auto* variable = std::get_if<ir::Variable>(&expr.node)) return bind_variable(*variable, expr.span);
  if (std::holds_alternative<ir::NameUse>(expr.node)) return bind_name(expr);
  if (auto* element = std::get_if<ir::Element>(&expr.node)) {
    bind_element(*element, expr.span);
    if (element->element != bytecode::kNoElement && !element->address) note_uncomputed_element(*element, expr.span);
    return;
  }
  if (auto* unary = std::get_if<ir::Unary>(&expr.node)) return unary->op == Operator::kNot ? bind_condition(*unary->operand) : bind_value(*unary->operand);
  if (auto* binary = std::get_if<ir::Binary>(&expr.node)) {
    const bool logical = binary->op == Operator::kAnd || binary->op == Operator::kOr;
    logical ? bind_condition(*binary->left) : bind_value(*binary->left);
    logical ? bind_condition(*binary->right) : bind_value(*binary->right);
  }
  if (auto* call = std::get_if<ir::FunctionCall>(&expr.node))
    for (ir::ExprPtr& argument : call->arguments) bind_value(*argument);
  if (std::holds_alternative<ir::AddressOf>(expr.node)) diagnostics_.error("PM3070", expr.span, "an address stands only among the arguments of functions, send and cmd that work on variables");
}

void Binder::bind_variable(ir::Variable& variable, const source::Span& span) {
  fold_constant_part(variable);
  if (variable.index) bind_value(*variable.index);
  const ClassRange range = range_of(variable.variable_class);
  const bool fits = variable.number >= 0 && variable.number < range.count;
  if (!fits) {
    diagnostics_.error("PM3045", span, fmt::format("{} variables are numbered 0 to {}", range.letter, range.count - 1));
    variable.number = 0;
  }
  const bool computed_local = variable.variable_class == VariableClass::kL && variable.index && variable.name.empty();
  if (variable.variable_class == VariableClass::kL) highest_local_ = std::max(highest_local_, computed_local ? std::max<std::int64_t>(variable.number, 255) : variable.number);
}

void Binder::bind_name(ir::Expr& expr) {
  auto use = std::move(std::get<ir::NameUse>(expr.node));
  if (use.has_arguments && is_function(use.name) && !is_declared(use.name)) return bind_function(expr, use);
  for (ir::ExprPtr& argument : use.arguments) bind_value(*argument);
  if (const auto local = locals_.find(use.name); local != locals_.end()) return bind_indexed(expr, use, VariableClass::kL, local->second.number, local->second.size);
  if (bind_declared_name(expr, use)) return;
  if (!use.has_arguments && bind_kinematic_name(expr, use.name)) return;
  report_unknown(use.name, expr.span, use.has_arguments ? "function or array" : "name");
  expr.node = std::move(use);
}

bool Binder::bind_declared_name(ir::Expr& expr, ir::NameUse& use) {
  const Name* name = project_.names.find(use.name);
  if (!name) return false;
  if (const auto variable_class = name->variable_class()) {
    bind_indexed(expr, use, *variable_class, name->number, name->size);
    return true;
  }
  if (use.has_arguments) return false;
  expr.node = ir::Number{static_cast<double>(name->number)};
  return true;
}

/// A scalar, or an element of an array: first + index.
void Binder::bind_indexed(ir::Expr& expr, ir::NameUse& use, VariableClass variable_class, std::int64_t first, std::int64_t size) {
  ir::Variable variable{variable_class, first, nullptr, use.name};
  if (use.has_arguments && use.arguments.size() != 1) diagnostics_.error("PM3046", expr.span, fmt::format("array '{}' takes one index", use.name));
  if (use.has_arguments && use.arguments.size() == 1) {
    const auto constant = ir::constant_value(*use.arguments[0]);
    if (constant && size > 0 && (*constant < 0 || *constant >= static_cast<double>(size)))
      diagnostics_.warning("PM3047", use.arguments[0]->span, fmt::format("the array '{}' has the elements 0 to {}", use.name, size - 1));
    if (constant && std::abs(*constant) < 1e9) variable.number += static_cast<std::int64_t>(*constant);
    else variable.index = std::move(use.arguments[0]);
  }
  expr.node = std::move(variable);
  bind_variable(std::get<ir::Variable>(expr.node), expr.span);
}

/// KinPosMotor1, KinAxisUsed and their kind: fixed names of the variables that kinematic routines exchange.
bool Binder::bind_kinematic_name(ir::Expr& expr, std::string_view name) {
  const auto make = [&](VariableClass variable_class, std::int64_t number) {
    expr.node = ir::Variable{variable_class, number, nullptr, std::string(name)};
    bind_variable(std::get<ir::Variable>(expr.node), expr.span);
    return true;
  };
  const auto after = [&](std::string_view prefix) { return name.starts_with(prefix) ? name.substr(prefix.size()) : std::string_view(); };
  if (name == "KinAxisUsed" || name == "KinVelEna") return make(VariableClass::kD, 0);
  if (const auto motor = number_suffix(after("KinPosMotor")); motor && *motor < bytecode::kMaxMotors) return make(VariableClass::kL, *motor);
  if (const auto motor = number_suffix(after("KinVelMotor")); motor && *motor < bytecode::kMaxMotors) return make(VariableClass::kR, *motor);
  if (const int axis = bytecode::axis_index_from_name(after("KinPosAxis")); axis >= 0) return make(VariableClass::kC, axis);
  if (const int axis = bytecode::axis_index_from_name(after("KinVelAxis")); axis >= 0) return make(VariableClass::kC, 32 + axis);
  if (const int axis = bytecode::axis_index_from_name(after("KinEnaAxis")); axis >= 0) return expr.node = ir::Number{std::ldexp(1.0, axis)}, true;
  return false;
}

// --- elements ---------------------------------------------------------------------------------------------------------------

void Binder::bind_element(ir::Element& element, const source::Span& span) {
  for (ir::ExprPtr& index : element.indices) bind_value(*index);
  element.element = bytecode::find_element(element.pattern);
  if (element.element == bytecode::kNoElement) return report_unknown_element(element, span);
  const bytecode::ElementInfo& info = bytecode::element_info(element.element);
  const bool address_only = info.type == bytecode::ElementType::kStructure && !element.address;
  if (address_only) diagnostics_.error("PM3055", span, fmt::format("{} is a structure; name one of its elements, or {}.a for its address", info.name, info.name));
  for (std::size_t i = 0; i < element.indices.size(); ++i) check_element_index(*element.indices[i], info.index_counts[i], info.name);
}

void Binder::check_element_index(const ir::Expr& index, int count, std::string_view element) {
  if (const auto value = ir::constant_value(index)) {
    const bool fits = *value >= 0 && *value < count && *value == std::floor(*value);
    if (!fits) diagnostics_.error("PM3050", index.span, fmt::format("the index of {} is 0 to {}", element, count - 1));
    return;
  }
  const auto* variable = std::get_if<ir::Variable>(&index.node);
  const bool one_local = variable && variable->variable_class == VariableClass::kL && !variable->index;
  if (!one_local) diagnostics_.error("PM3051", index.span, "the index of an element is a constant or one local variable; assign the value to a local first");
}

void Binder::report_unknown_element(const ir::Element& element, const source::Span& span) {
  const std::string structure = element.pattern.substr(0, element.pattern.find_first_of(".["));
  const auto local = locals_.find(structure);
  const Name* name = project_.names.find(structure);
  if (local != locals_.end() || (name && name->variable_class())) {
    diagnostics_.error("PM3052", span, fmt::format("'{}' is an array; its index stands in round brackets: {}(...)", structure, structure));
    return;
  }
  const bool reported = !project_.reported_elements.insert(lower(element.pattern)).second;
  if (reported && diagnostics_.has_errors()) return;  // once a compilation; a later command line is refused for itself
  std::vector<std::string_view> candidates;
  for (std::uint16_t i = 0; diagnostics_.dropped_count() == 0 && i < static_cast<std::uint16_t>(bytecode::ElementId::kCount); ++i) candidates.push_back(bytecode::element_info(static_cast<bytecode::ElementId>(i)).name);
  const source::Guess near = source::guess_word(element.pattern, candidates);
  const std::string hint = near.word.empty() ? std::string() : fmt::format("; did you mean {}?", near.word);
  auto& error = diagnostics_.error("PM3053", span, fmt::format("unknown element {}{}", element.pattern, hint));
  const std::size_t member = element.pattern.rfind('.');
  const bool only_member_differs = member != std::string::npos && near.word.substr(0, member + 1) == std::string_view(element.pattern).substr(0, member + 1);
  if (!only_member_differs || element.address || element.pattern.ends_with(']')) return;
  const auto length = static_cast<std::uint32_t>(element.pattern.size() - member - 1);
  error.fix = source::guess_fix({span.file, span.end - length, span.end, span.expansion}, {near.word.substr(member + 1), near.certain});
}

/// Once for each element, where the program relies on something that the simulation keeps without acting on it.
void Binder::note_stored_element(const ir::Element& element, const source::Span& span) {
  const bytecode::ElementInfo& info = bytecode::element_info(element.element);
  if (info.simulation != bytecode::ElementSimulation::kStored || !project_.reported_elements.insert(std::string(info.name)).second) return;
  diagnostics_.warning("PM6010", span, fmt::format("the simulation stores {} and does not act on it", info.name));
}

/// Once for each element, where the program reads a status that stays at its default here.
void Binder::note_uncomputed_element(const ir::Element& element, const source::Span& span) {
  const bytecode::ElementInfo& info = bytecode::element_info(element.element);
  if (info.simulation != bytecode::ElementSimulation::kUnknown || !project_.reported_elements.insert(std::string(info.name)).second) return;
  diagnostics_.warning("PM6012", span, fmt::format("the simulation does not compute {}; it reads {}", info.name, info.default_value));
}

void Binder::report_unknown(std::string_view name, const source::Span& span, std::string_view what) {
  if (diagnostics_.has_errors() && project_.lexed_names.contains(std::string(name))) return;  // its declaration was refused
  if (diagnostics_.dropped_count() > 0) {
    diagnostics_.error("PM3054", span, fmt::format("{} '{}' is not declared", what, name));
    return;
  }
  std::vector<std::string_view> candidates;
  std::string_view other_case = project_.names.find_other_case(name);
  const auto same = [&](std::string_view other) { return other != name && lower(other) == lower(name); };
  for (const auto& [local, entry] : locals_) {
    candidates.push_back(local);
    if (same(local)) other_case = local;
  }
  for (const auto& [global, entry] : project_.names.all()) candidates.push_back(global);
  const bool is_function = what.starts_with("function");
  for (std::uint16_t i = 0; is_function && i < static_cast<std::uint16_t>(bytecode::Function::kCount); ++i) candidates.push_back(bytecode::function_info(static_cast<bytecode::Function>(i)).name);
  const source::Guess near = other_case.empty() ? source::guess_word(name, candidates) : source::Guess{other_case, true};
  std::string hint;
  if (!other_case.empty()) hint = fmt::format("; '{}' differs only in upper and lower case, which counts in names", other_case);
  else if (!near.word.empty()) hint = fmt::format("; did you mean '{}'?", near.word);
  auto& error = diagnostics_.error("PM3054", span, fmt::format("{} '{}' is not declared{}", what, name, hint));
  if (!near.word.empty()) error.fix = source::guess_fix({span.file, span.begin, static_cast<std::uint32_t>(span.begin + name.size()), span.expansion}, near);
}

}  // namespace pmac::compiler::sema
