// Expressions, variables, data-structure elements.
#include <fmt/format.h>

#include <cctype>
#include <charconv>
#include <cmath>

#include "compiler/bytecode/function.h"
#include "compiler/frontend/power_pmac/lowering.h"

namespace pmac::compiler::power_pmac {
namespace {

using ir::Operator;

std::optional<ir::VariableClass> class_of_letter(char letter) {
  switch (std::tolower(static_cast<unsigned char>(letter))) {
    case 'p': return ir::VariableClass::kP;
    case 'q': return ir::VariableClass::kQ;
    case 'm': return ir::VariableClass::kM;
    case 'i': return ir::VariableClass::kI;
    case 'l': return ir::VariableClass::kL;
    case 'r': return ir::VariableClass::kR;
    case 'c': return ir::VariableClass::kC;
    case 'd': return ir::VariableClass::kD;
    default: return std::nullopt;
  }
}

Operator binary_operator(std::string_view text) {
  struct Row { std::string_view text; Operator op; };
  constexpr Row kRows[] = {
      {"+", Operator::kAdd}, {"-", Operator::kSub}, {"*", Operator::kMul}, {"/", Operator::kDiv}, {"%", Operator::kMod},
      {"&", Operator::kBitAnd}, {"|", Operator::kBitOr}, {"^", Operator::kBitXor}, {"<<", Operator::kShiftLeft}, {">>", Operator::kShiftRight},
      {"==", Operator::kEqual}, {"!=", Operator::kNotEqual}, {"<>", Operator::kNotEqual}, {"<", Operator::kLess}, {">", Operator::kGreater},
      {"<=", Operator::kLessEqual}, {">=", Operator::kGreaterEqual}, {"!>", Operator::kNotGreater}, {"!<", Operator::kNotLess},
      {"~", Operator::kNear}, {"!~", Operator::kNotNear}, {"&&", Operator::kAnd}, {"||", Operator::kOr},
      {"=", Operator::kEqual}, {"and", Operator::kAnd}, {"or", Operator::kOr}};  // of Turbo PMAC, reported by now
  const std::string word = lower_case(text);
  for (const Row& row : kRows)
    if (row.text == word) return row.op;
  return Operator::kAdd;
}

}  // namespace

std::string lower_case(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return result;
}

double Lowering::number_value(const antlr4::Token& token) const {
  const std::string_view text = tree_.text_of(token);
  if (text.starts_with('$')) {
    std::uint64_t value = 0;
    const auto read = std::from_chars(text.data() + 1, text.data() + text.size(), value, 16);
    if (read.ec != std::errc()) diagnostics_.error("PM3001", tree_.span_of(token), "this number has more than 64 bits");
    return static_cast<double>(value);
  }
  double value = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
  if (read.ec == std::errc::result_out_of_range) diagnostics_.error("PM3001", tree_.span_of(token), "this number is out of range");
  return value;
}

ir::ExprPtr Lowering::lower_number(antlr4::Token* token) {
  return token ? ir::make_number(number_value(*token), span_of(token)) : ir::make_number(0, {});
}

/// A number without fraction in [0, most]; reports others.
std::optional<std::int64_t> Lowering::whole_number(antlr4::Token* token, std::int64_t most) {
  if (!token) return std::nullopt;
  const double value = number_value(*token);
  if (value >= 0 && value <= static_cast<double>(most) && value == std::floor(value)) return static_cast<std::int64_t>(value);
  diagnostics_.error("PM3002", span_of(token), fmt::format("'{}' must be a whole number from 0 to {}", tree_.text_of(*token), most));
  return std::nullopt;
}

ir::ExprPtr Lowering::lower_expression(P::ExpressionContext* expression) {
  if (!expression || expression->exception) return ir::make_number(0, span_of(expression));
  const source::Span span = span_of(expression);
  const auto operands = expression->expression();
  if (expression->operation && operands.size() == 1) {
    const char op = text_of(expression->operation)[0];
    ir::ExprPtr operand = lower_expression(operands[0]);
    if (op == '+') return operand;
    if (auto* number = std::get_if<ir::Number>(&operand->node); number && op == '-') return ir::make_number(-number->value, span);
    const Operator unary = op == '-' ? Operator::kNegate : op == '~' ? Operator::kInvert : Operator::kNot;
    return std::make_unique<ir::Expr>(ir::Expr{span, ir::Unary{unary, std::move(operand)}});
  }
  if (expression->operation) {
    const Operator op = binary_operator(text_of(expression->operation));
    ir::ExprPtr left = lower_expression(operands[0]);
    ir::ExprPtr right = lower_expression(operands.size() > 1 ? operands[1] : nullptr);
    return std::make_unique<ir::Expr>(ir::Expr{span, ir::Binary{op, std::move(left), std::move(right)}});
  }
  if (expression->ABS()) {
    ir::FunctionCall call{bytecode::Function::kAbs, {}};
    call.arguments.push_back(lower_expression(operands.empty() ? nullptr : operands[0]));
    return std::make_unique<ir::Expr>(ir::Expr{span, std::move(call)});
  }
  if (!operands.empty()) return lower_expression(operands[0]);
  if (expression->NUMBER()) return lower_number(token_of(expression->NUMBER()));
  if (expression->variable()) return lower_variable(expression->variable());
  if (expression->reference()) return lower_reference(expression->reference());
  if (expression->STRING()) return std::make_unique<ir::Expr>(ir::Expr{span, ir::Text{string_value(*expression->STRING()->getSymbol())}});
  return ir::make_number(0, span);
}

ir::ExprPtr Lowering::lower_condition(P::ConditionContext* condition) {
  if (!condition) return ir::make_number(0, {});
  const auto sides = condition->expression();
  if (condition->wrong) {
    auto& error = diagnostics_.error("PM2011", span_of(condition->wrong), "a condition compares with ==; a single = assigns");
    error.fix = source::FixIt{span_of(condition->wrong), "=="};
  }
  return lower_expression(sides.empty() ? nullptr : sides[0]);
}

ir::ExprPtr Lowering::lower_data(P::DataContext* data) {
  if (!data || data->exception) return ir::make_number(0, span_of(data));
  if (data->NUMBER()) {
    ir::ExprPtr number = lower_number(token_of(data->NUMBER()));
    number->span = span_of(data);
    if (data->sign && text_of(data->sign) == "-") std::get<ir::Number>(number->node).value *= -1;
    return number;
  }
  if (data->expression()) return lower_expression(data->expression());
  const source::Span span = span_of(data);
  const std::string text(tree_.expanded.text().substr(data->start->getStartIndex(), data->stop->getStopIndex() + 1 - data->start->getStartIndex()));
  auto& error = diagnostics_.error("PM2012", span, fmt::format("a value that is no constant stands in parentheses: ({})", text));
  error.fix = source::FixIt{span, "(" + text + ")"};
  return lower_lvalue(data->lvalue());
}

ir::ExprPtr Lowering::lower_lvalue(P::LvalueContext* lvalue) {
  if (lvalue && lvalue->variable()) return lower_variable(lvalue->variable());
  return lower_reference(lvalue ? lvalue->reference() : nullptr);
}

ir::ExprPtr Lowering::lower_variable(P::VariableContext* variable) {
  ir::Variable result;
  if (const auto known = class_of_letter(text_of(variable->start)[0])) result.variable_class = *known;
  if (variable->NUMBER()) {
    result.number = whole_number(token_of(variable->NUMBER()), 65535).value_or(0);
  } else {
    result.index = lower_expression(variable->expression());
    if (const auto constant = ir::constant_value(*result.index); constant && std::abs(*constant) < 1e6) {
      result.number = static_cast<std::int64_t>(*constant);
      result.index.reset();
    }
  }
  return std::make_unique<ir::Expr>(ir::Expr{span_of(variable), std::move(result)});
}

std::vector<ir::ExprPtr> Lowering::lower_arguments(P::ArgumentsContext* arguments) {
  std::vector<ir::ExprPtr> values;
  if (!arguments) return values;
  for (P::ArgumentContext* argument : arguments->argument()) values.push_back(lower_argument(argument));
  return values;
}

ir::ExprPtr Lowering::lower_argument(P::ArgumentContext* argument) {
  if (argument->expression()) return lower_expression(argument->expression());
  return std::make_unique<ir::Expr>(ir::Expr{span_of(argument), ir::AddressOf{lower_lvalue(argument->lvalue())}});
}

ir::ExprPtr Lowering::lower_reference(P::ReferenceContext* reference) {
  if (!reference || !reference->NAME()) return ir::make_number(0, span_of(reference));
  const auto suffixes = reference->suffix();
  const bool is_element = !suffixes.empty() && !(suffixes.size() == 1 && suffixes[0]->arguments());
  if (is_element) return lower_element(reference);
  ir::NameUse use{text_of(token_of(reference->NAME())), !suffixes.empty(), {}};
  if (!suffixes.empty()) use.arguments = lower_arguments(suffixes[0]->arguments());
  return std::make_unique<ir::Expr>(ir::Expr{span_of(reference), std::move(use)});
}

ir::ExprPtr Lowering::lower_element(P::ReferenceContext* reference) {
  ir::Element element;
  element.pattern = text_of(token_of(reference->NAME()));
  const auto suffixes = reference->suffix();
  for (std::size_t i = 0; i < suffixes.size(); ++i) {
    P::SuffixContext* suffix = suffixes[i];
    const std::string member = suffix->MEMBER() ? text_of(token_of(suffix->MEMBER())) : std::string();
    if (suffix->arguments()) {
      diagnostics_.error("PM3003", span_of(suffix), "an element has its indices in square brackets, and is no function");
    } else if (suffix->MEMBER() && lower_case(member) == "a" && i + 1 == suffixes.size()) {
      element.address = true;
    } else if (suffix->MEMBER()) {
      element.pattern += "." + member;
    } else {
      for (P::ExpressionContext* index : suffix->expression()) {
        element.pattern += "[]";
        element.indices.push_back(lower_expression(index));
      }
    }
  }
  return std::make_unique<ir::Expr>(ir::Expr{span_of(reference), std::move(element)});
}

void Lowering::not_supported(source::Span span, std::string_view what) {
  diagnostics_.error("PM5001", span, fmt::format("{} is not supported yet", what));
}

}  // namespace pmac::compiler::power_pmac
