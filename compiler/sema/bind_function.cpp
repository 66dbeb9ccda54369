// Calls of functions: arguments against the signatures of function.def, addresses, and the values of printf formats.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "compiler/bytecode/element.h"
#include "compiler/bytecode/format_text.h"
#include "compiler/bytecode/function.h"
#include "compiler/frontend/power_pmac/frontend.h"
#include "compiler/sema/binder.h"

namespace pmac::compiler::sema {
namespace {

using bytecode::ConversionKind;
using bytecode::ElementId;

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return result;
}

bytecode::Function find_function(std::string_view name) {
  const std::string wanted = lower(name);
  for (std::uint16_t i = 0; i < static_cast<std::uint16_t>(bytecode::Function::kCount); ++i)
    if (bytecode::function_info(static_cast<bytecode::Function>(i)).name == wanted) return static_cast<bytecode::Function>(i);
  return bytecode::kNoFunction;
}

/// Why a function of the controller is not made here, or empty.
std::string_view reason_of_absence(std::string_view name) {
  const std::string wanted = lower(name);
  if (wanted == "dcopy" || wanted == "lrcopy" || wanted == "rlcopy") return "; copy with vcopy";
  if (wanted.starts_with("ecat")) return "; there is no EtherCAT network in the simulation";
  return {};
}

bool is_text(const ir::Expr& expr) { return std::holds_alternative<ir::Text>(expr.node); }
bool is_address(const ir::Expr& expr) { return std::holds_alternative<ir::AddressOf>(expr.node); }

}  // namespace

bool Binder::is_function(std::string_view name) const { return find_function(name) != bytecode::kNoFunction || !reason_of_absence(name).empty(); }

bool Binder::is_declared(std::string_view name) const { return locals_.contains(name) || project_.names.find(name) != nullptr; }

bool Binder::is_variable(std::string_view name) const {
  const Name* known = project_.names.find(name);
  return locals_.contains(name) || (known && known->variable_class());
}

void Binder::bind_function(ir::Expr& expr, ir::NameUse& use) {
  const bytecode::Function function = find_function(use.name);
  if (function == bytecode::kNoFunction) {
    diagnostics_.error("PM5001", expr.span, fmt::format("the function {} is not supported{}", lower(use.name), reason_of_absence(use.name)));
    expr.node = ir::Number{0};
    return;
  }
  bind_arguments(function, use.arguments, expr.span);
  if (function == bytecode::Function::kCFromScript) report_user_routine(expr.span);
  expr.node = ir::FunctionCall{function, std::move(use.arguments)};
}

/// Once in a project.
void Binder::report_user_routine(const source::Span& span) {
  if (project_.reported_elements.insert("cfromscript").second) diagnostics_.warning("PM5003", span, "CfromScript calls a C routine of the user, which the simulation cannot run; there this is a fault");
}

/// Every argument by its letter of the signature; optional ones that are missing become 1.
void Binder::bind_arguments(bytecode::Function function, std::vector<ir::ExprPtr>& arguments, const source::Span& span) {
  const bytecode::FunctionInfo& info = bytecode::function_info(function);
  const auto most = static_cast<std::size_t>(info.argument_count);
  const std::size_t least = most - static_cast<std::size_t>(std::count(info.signature.begin(), info.signature.end(), 'N'));
  const bool has_values = info.signature.ends_with('.');
  if (arguments.size() < least || (arguments.size() > most && !has_values)) {
    const std::string wanted = least == most ? fmt::format("{}{}", has_values ? "at least " : "", most) : fmt::format("{} to {}", least, most);
    diagnostics_.error("PM3048", span, fmt::format("{} takes {} argument(s), not {}", info.name, wanted, arguments.size()));
    arguments.resize(std::min(arguments.size(), most));
  }
  while (arguments.size() < most) arguments.push_back(ir::make_number(1, span));
  for (std::size_t i = 0; i < most; ++i) bind_argument(*arguments[i], info.signature[i], info.name, i + 1);
  if (!has_values) return;
  std::vector<ir::Expr*> values;
  for (std::size_t i = most; i < arguments.size(); ++i) values.push_back(arguments[i].get());
  const ir::Expr& format = *arguments[most - 1];
  if (is_text(format)) bind_format(std::get<ir::Text>(format.node).value, values, format.span);
}

void Binder::bind_argument(ir::Expr& argument, char letter, std::string_view function, std::size_t number) {
  switch (letter) {
    case 'n':
    case 'N':
    case 'c':
    case 't': return bind_value(argument);
    case 'f':
      if (!is_text(argument)) diagnostics_.error("PM3071", argument.span, fmt::format("argument {} of {} is a format in quotation marks", number, function));
      return;
    case 's':
      if (is_text(argument)) return;
      break;
    default: break;
  }
  if (is_address(argument)) return bind_address(argument, letter == 'v');
  const std::string what = letter == 'v' ? "the first variable of an array, as in &P100" : letter == 's' ? "a text or its address, as in &P100" : "the address of bytes, as in &P100";
  auto& error = diagnostics_.error("PM3071", argument.span, fmt::format("argument {} of {} is {}", number, function, what));
  const bool could_be_address = std::holds_alternative<ir::Variable>(argument.node) || std::holds_alternative<ir::NameUse>(argument.node) || std::holds_alternative<ir::Element>(argument.node);
  if (could_be_address) error.fix = source::FixIt{{argument.span.file, argument.span.begin, argument.span.begin, argument.span.expansion}, "&"};
}

/// &P100, &Table(0), &Sys.Cdata[40]. variables_only: a vector or matrix, no bytes.
void Binder::bind_address(ir::Expr& argument, bool variables_only) {
  auto& address = std::get<ir::AddressOf>(argument.node);
  ir::Expr& place = *address.place;
  bind_expr(place);
  if (const auto* variable = std::get_if<ir::Variable>(&place.node)) {
    address.end = array_end(*variable);
    const bool unbounded_local = variable->variable_class == ir::VariableClass::kL && address.end == 0;
    if (unbounded_local) highest_local_ = std::max<std::int64_t>(highest_local_, 255);
    return;
  }
  const auto* element = std::get_if<ir::Element>(&place.node);
  if (!element) {
    if (!std::holds_alternative<ir::NameUse>(place.node)) diagnostics_.error("PM3070", place.span, "this has no address; variables and the user buffer have");
    return;
  }
  if (element->element == bytecode::kNoElement) return;  // reported
  const bool in_buffer = element->element >= ElementId::kSysCdata && element->element <= ElementId::kSysDdata;
  if (!in_buffer || variables_only || element->address)
    diagnostics_.error("PM3070", place.span, fmt::format("{} has no address that this function can use; {}", bytecode::element_info(element->element).name,
                                                         variables_only ? "vectors and matrices are made of variables" : "variables and the user buffer Sys.Cdata[] have"));
}

/// One past the last number of the declared array that a variable belongs to; 0: none.
std::int64_t Binder::array_end(const ir::Variable& variable) const {
  if (const auto local = locals_.find(variable.name); local != locals_.end()) return local->second.size > 0 ? local->second.number + local->second.size : 0;
  const Name* name = variable.name.empty() ? nullptr : project_.names.find(variable.name);
  return name && name->size > 0 ? name->number + name->size : 0;
}

// --- formats ----------------------------------------------------------------------------------------------------------------

void Binder::bind_format(const std::string& text, const std::vector<ir::Expr*>& values, const source::Span& span) {
  const bytecode::FormatText format = bytecode::parse_format(text);
  if (!format.problem.empty()) {
    diagnostics_.error("PM3072", span, fmt::format("\"{}\" is no conversion: {}", text.substr(format.problem_at, 8), format.problem));
  } else if (format.value_count() != values.size()) {
    diagnostics_.error("PM3072", span, fmt::format("the format asks for {} value(s); {} follow(s)", format.value_count(), values.size()));
  }
  std::size_t next = 0;
  for (const bytecode::Conversion& conversion : format.conversions) {
    if (conversion.kind == ConversionKind::kPercent || next >= values.size()) continue;
    bind_format_value(*values[next++], conversion);
  }
  for (; next < values.size(); ++next) bind_format_value(*values[next], {});
}

void Binder::bind_format_value(ir::Expr& value, const bytecode::Conversion& conversion) {
  const bool text_given = is_text(value) || is_address(value);
  const bool text_wanted = conversion.kind == ConversionKind::kText;
  const bool any_wanted = conversion.kind == ConversionKind::kPercent;  // more values than conversions: reported
  if (is_address(value)) bind_address(value, false);
  else if (!is_text(value)) bind_value(value);
  if (any_wanted || text_given == text_wanted) return;
  if (text_wanted) diagnostics_.error("PM3073", value.span, "%s prints a text: a literal, or the address of its bytes, as in &P100");
  else diagnostics_.error("PM3073", value.span, fmt::format("%{} prints a number, and this is a text", conversion.letter));
}

void Binder::bind_text_out(const std::string& text, std::vector<ir::ExprPtr>& values, const source::Span& span) {
  std::vector<ir::Expr*> all;
  for (ir::ExprPtr& value : values) all.push_back(value.get());
  if (!all.empty()) return bind_format(text, all, span);
  const bytecode::FormatText format = bytecode::parse_format(text);
  if (format.problem.empty() && !format.conversions.empty())
    diagnostics_.warning("PM6020", span, "no values follow, so the conversions with % stand in the text as they are");
}

void Binder::bind(ir::Command& node, const source::Span& span) { bind_text_out(node.text, node.values, span); }
void Binder::bind(ir::Send& node, const source::Span& span) { bind_text_out(node.text, node.values, span); }

/// Foo(5) that is no function: a subprogram without call, or whiel (P1). False where it is like nothing.
bool Binder::report_misspelt_statement(const std::string& name, const source::Span& span) {
  const source::Span word{span.file, span.begin, static_cast<std::uint32_t>(span.begin + name.size()), span.expansion};
  const Name* known = project_.names.find(name);
  if (known && known->kind == bytecode::SymbolKind::kSubprog) {
    diagnostics_.error("PM3054", word, fmt::format("'{0}' is a subprogram; write call {0}(...)", name)).fix = source::FixIt{{span.file, span.begin, span.begin, span.expansion}, "call "};
    return true;
  }
  const std::string written = lower(name);
  const source::Guess near = source::guess_word(written, power_pmac::keyword_names());
  if (known || near.word.empty()) return false;
  diagnostics_.error("PM2008", word, fmt::format("unknown word '{}'; did you mean '{}'?", name, near.word)).fix = source::guess_fix(word, near);
  return true;
}

/// A call that stands alone must do something.
void Binder::bind(ir::Evaluate& node, const source::Span& span) {
  const auto* use = std::get_if<ir::NameUse>(&node.value->node);
  if (use && !is_function(use->name) && !is_variable(use->name) && report_misspelt_statement(use->name, span)) return;
  bind_expr(*node.value);
  const auto* call = std::get_if<ir::FunctionCall>(&node.value->node);
  if (call && bytecode::function_info(call->function).uses_memory) return;
  if (std::holds_alternative<ir::NameUse>(node.value->node)) return;  // reported
  diagnostics_.error("PM3074", span, "the value is not used; assign it, or call a function that stores its result");
}

}  // namespace pmac::compiler::sema
