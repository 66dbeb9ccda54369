#include "compiler/ir/ir.h"
#include "compiler/bytecode/opcode.h"

#include <cmath>

namespace pmac::compiler::ir {

std::string_view operator_text(Operator op) {
  constexpr std::string_view kTexts[] = {"+", "-", "*", "/", "%", "&", "|", "^", "<<", ">>", "==", "!=", "<", ">", "<=", ">=", "!>", "!<", "~", "!~", "&&", "||", "-", "~", "!"};
  return kTexts[static_cast<std::size_t>(op)];
}

bool is_comparison(Operator op) { return op >= Operator::kEqual && op <= Operator::kNotNear; }

ExprPtr make_number(double value, Span span) { return std::make_unique<Expr>(Expr{span, Number{value}}); }

namespace {

std::optional<bytecode::Opcode> opcode_of(Operator op) {
  using bytecode::Opcode;
  switch (op) {
    case Operator::kAdd: return Opcode::kAdd;
    case Operator::kSub: return Opcode::kSub;
    case Operator::kMul: return Opcode::kMul;
    case Operator::kDiv: return Opcode::kDiv;
    case Operator::kMod: return Opcode::kMod;
    case Operator::kBitAnd: return Opcode::kBitAnd;
    case Operator::kBitOr: return Opcode::kBitOr;
    case Operator::kBitXor: return Opcode::kBitXor;
    case Operator::kShiftLeft: return Opcode::kShiftLeft;
    case Operator::kShiftRight: return Opcode::kShiftRight;
    default: return std::nullopt;
  }
}

}  // namespace

std::optional<double> constant_value(const Expr& expr) {
  if (const auto* number = std::get_if<Number>(&expr.node)) return number->value;
  if (const auto* unary = std::get_if<Unary>(&expr.node)) {
    const auto value = constant_value(*unary->operand);
    if (value && unary->op == Operator::kNegate) return -*value;
    return std::nullopt;
  }
  if (const auto* binary = std::get_if<Binary>(&expr.node)) {
    const auto opcode = opcode_of(binary->op);
    const auto left = opcode ? constant_value(*binary->left) : std::nullopt;
    const auto right = left ? constant_value(*binary->right) : std::nullopt;
    if (right) return bytecode::apply_binary(*opcode, *left, *right);
  }
  return std::nullopt;
}

}  // namespace pmac::compiler::ir
