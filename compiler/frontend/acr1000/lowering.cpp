#include "compiler/frontend/acr1000/lowering.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <limits>
#include <utility>

#include "compiler/bytecode/card.h"

namespace pmac::compiler::acr1000 {
namespace {

using ir::CardVerb;

constexpr double kLeastInteger = -2147483648.0, kMostInteger = 2147483647.0;
constexpr double kMaxRelay = 65535;
constexpr std::int64_t kMaxAddress = 0xffff, kMaxByte = 0xff;

ir::StmtPtr card_action(const source::Span& span, CardVerb verb, std::vector<ir::ExprPtr> arguments) {
  return ir::make_stmt(span, ir::CardAction{verb, std::move(arguments)});
}

template <class... Argument>
std::vector<ir::ExprPtr> list(Argument... argument) {
  std::vector<ir::ExprPtr> all;
  (all.push_back(std::move(argument)), ...);
  return all;
}

bool is_single(const ir::Expr& value) { return std::holds_alternative<ir::Variable>(value.node) || ir::constant_value(value).has_value(); }

}  // namespace

ir::StmtPtr card_action(const source::Span& span, CardVerb verb) { return card_action(span, verb, std::vector<ir::ExprPtr>{}); }
ir::StmtPtr card_action(const source::Span& span, CardVerb verb, ir::ExprPtr argument) { return card_action(span, verb, list(std::move(argument))); }

std::optional<std::int64_t> line_number_of(std::string_view digits) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || value > kMaxLineNumber) return std::nullopt;
  return value;
}

void LineLowering::lower(Parser::CommandsContext* commands, ir::Body& out) {
  const std::vector<Parser::CommandContext*> all = commands->command();
  if (all.size() > 1 && !settings_.joins_commands())
    diagnostics_.error("ACR-E15", line_.token(commands->COLON(0)).span, fmt::format("several commands on a line need executive version 2.6.966 or later, and this is {}; give each a line of its own, or say VERSION=2.7", settings_.version_text()));
  for (Parser::CommandContext* one : all) command(one, out);
}

void LineLowering::command(Parser::CommandContext* node, ir::Body& out) {
  if (auto* a = node->assignment()) assignment(a, out);
  else if (auto* b = node->rate()) rate(b, out);
  else if (auto* c = node->move()) move(c, out);
  else if (auto* d = node->circle()) circle(d, out);
  else if (auto* e = node->branch()) branch(e, out);
  else if (auto* f = node->conditional()) conditional(f, out);
  else if (auto* g = node->relay()) relay(g, out);
  else if (auto* h = node->print()) print(h, out);
  else if (auto* i = node->poke()) poke(i, out);
  else if (auto* j = node->peek()) peek(j, out);
  else if (auto* k = node->plain()) plain(k, out);
}

// --- values ----------------------------------------------------------------------------------------------------------------------

void LineLowering::check_range(const ir::Expr& value, double least, double most, const std::string& what) {
  const auto constant = ir::constant_value(value);
  if (!constant || (*constant >= least && *constant <= most)) return;
  diagnostics_.error("ACR-E04", value.span, fmt::format("{} is from {} to {}, not {}", what, static_cast<std::int64_t>(least), static_cast<std::int64_t>(most), static_cast<std::int64_t>(*constant)));
}

ir::ExprPtr LineLowering::parameter(const Token& token) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(token.text.data(), token.text.data() + token.text.size(), value);
  if (error != std::errc() || value >= settings_.parameter_count()) {
    diagnostics_.error("ACR-E05", token.span, fmt::format("the card has the parameters P0 to P{}; the setting PARAMS=n says otherwise", settings_.parameter_count() - 1));
    value = 0;
  }
  return std::make_unique<ir::Expr>(ir::Expr{token.span, ir::Variable{ir::VariableClass::kP, value, nullptr, {}}});
}

/// Decimal numbers have 32 bits with their sign; hexadecimal ones are 32 bits of two's complement.
ir::ExprPtr LineLowering::number(const Token& token, bool negative, const source::Span& span) {
  const bool hex = token.type == Parser::HEX_NUMBER;
  std::uint64_t digits = 0;
  const auto [end, error] = std::from_chars(token.text.data(), token.text.data() + token.text.size(), digits, hex ? 16 : 10);
  double value = hex ? static_cast<double>(static_cast<std::int32_t>(static_cast<std::uint32_t>(digits))) : static_cast<double>(digits);
  if (negative) value = -value;
  const bool fits = error == std::errc() && (hex ? digits <= 0xffffffffu : true) && value >= kLeastInteger && value <= kMostInteger;
  if (!fits) diagnostics_.error("ACR-E04", span, hex ? "a hexadecimal number has at most 8 digits (32 bits)" : "a number is from -2147483648 to 2147483647 (32 bits)");
  return ir::make_number(fits ? value : 0, span);
}

ir::ExprPtr LineLowering::operand(Parser::OperandContext* node) {
  const source::Span span = span_of(*node);
  const bool negative = node->MINUS() != nullptr;
  if (auto* leaf = node->NUMBER()) return number(line_.token(leaf), negative, span);
  if (auto* leaf = node->HEX_NUMBER()) return number(line_.token(leaf), negative, span);
  const bool has_sign = negative || node->PLUS() != nullptr;
  if (node->PARAMETER() && has_sign && !settings_.arithmetic())
    diagnostics_.error("ACR-E02", span, "a sign stands before a number, not before a parameter; the setting ARITHMETIC=1 allows it");
  if (!node->PARAMETER() && !settings_.arithmetic())
    diagnostics_.error("ACR-E02", span, "a value is one number or parameter; the setting ARITHMETIC=1 allows more, which no manual describes");
  ir::ExprPtr inner = node->PARAMETER() ? parameter(line_.token(node->PARAMETER())) : sum(node->sum());
  if (!negative) return inner;
  return std::make_unique<ir::Expr>(ir::Expr{span, ir::Unary{ir::Operator::kNegate, std::move(inner)}});
}

/// Quotients are cut to whole numbers, as every value of the card is.
ir::ExprPtr LineLowering::product(Parser::ProductContext* node) {
  ir::ExprPtr value = operand(node->operand(0));
  for (std::size_t i = 1; i < node->operand().size(); ++i) {
    const Token& sign = line_.token(dynamic_cast<antlr4::tree::TerminalNode*>(node->children[2 * i - 1]));
    const bool divides = sign.type == Parser::SLASH;
    ir::ExprPtr right = operand(node->operand(i));
    const source::Span span = source::join(value->span, right->span);
    value = std::make_unique<ir::Expr>(ir::Expr{span, ir::Binary{divides ? ir::Operator::kDiv : ir::Operator::kMul, std::move(value), std::move(right)}});
    if (divides) value = std::make_unique<ir::Expr>(ir::Expr{span, ir::Binary{ir::Operator::kBitOr, std::move(value), ir::make_number(0, span)}});
  }
  return value;
}

ir::ExprPtr LineLowering::sum(Parser::SumContext* node) {
  ir::ExprPtr value = product(node->product(0));
  for (std::size_t i = 1; i < node->product().size(); ++i) {
    const Token& sign = line_.token(dynamic_cast<antlr4::tree::TerminalNode*>(node->children[2 * i - 1]));
    ir::ExprPtr right = product(node->product(i));
    const source::Span span = source::join(value->span, right->span);
    const auto op = sign.type == Parser::PLUS ? ir::Operator::kAdd : ir::Operator::kSub;
    value = std::make_unique<ir::Expr>(ir::Expr{span, ir::Binary{op, std::move(value), std::move(right)}});
  }
  return value;
}

ir::ExprPtr LineLowering::expression(Parser::ExpressionContext* node) {
  const std::size_t before = diagnostics_.error_count();
  ir::ExprPtr value = sum(node->sum());
  const bool computed = !is_single(*value) || node->sum()->product().size() > 1 || node->sum()->product(0)->operand().size() > 1;
  if (computed && !settings_.arithmetic() && diagnostics_.error_count() == before)
    diagnostics_.error("ACR-E02", span_of(*node), "a value is one number or parameter; the setting ARITHMETIC=1 allows more, which no manual describes");
  return value;
}

ir::ExprPtr LineLowering::rotation(Parser::RotationContext* node) {
  if (node->expression()) return expression(node->expression());
  return ir::make_number(node->MINUS() ? -1 : 1, span_of(*node));
}

ir::ExprPtr LineLowering::bare_hex(antlr4::tree::TerminalNode* leaf, std::int64_t most, const char* what) {
  const Token& token = line_.token(leaf);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(token.text.data(), token.text.data() + token.text.size(), value, 16);
  if (error != std::errc() || value > most) {
    diagnostics_.error("ACR-E04", token.span, fmt::format("{} is hexadecimal from 0 to {:X}, not {}", what, most, token.text));
    value = 0;
  }
  return ir::make_number(static_cast<double>(value), token.span);
}

// --- commands ----------------------------------------------------------------------------------------------------------------------

void LineLowering::assignment(Parser::AssignmentContext* node, ir::Body& out) {
  const Token& target = line_.token(node->PARAMETER());
  ir::Assign assign;
  assign.target = parameter(target);
  assign.values.push_back(expression(node->expression()));
  const auto* variable = std::get_if<ir::Variable>(&assign.target->node);
  constexpr std::int64_t kMasterLength = 28;
  if (variable && variable->number == kMasterLength && !settings_.interpolates())
    diagnostics_.error("ACR-E15", target.span, fmt::format("P28 joins cards in executive versions 2.7 and 4, and this is {}; say VERSION=2.7", settings_.version_text()));
  out.push_back(ir::make_stmt(span_of(*node), std::move(assign)));
}

void LineLowering::rate(Parser::RateContext* node, ir::Body& out) {
  ir::ExprPtr value = expression(node->expression());
  const CardVerb verb = node->VEL() ? CardVerb::kVel : node->ACC() ? CardVerb::kAcc : node->DEC() ? CardVerb::kDec : CardVerb::kStp;
  const auto constant = ir::constant_value(*value);
  const bool needs_24_bits = verb == CardVerb::kVel && constant && *constant > settings_.max_velocity();
  if (needs_24_bits && *constant <= 16777215)
    diagnostics_.error("ACR-E04", value->span, fmt::format("VEL is from 0 to 65535 in executive version {}; version 4 has velocities of 24 bits (VERSION=4)", settings_.version_text()));
  else if (verb == CardVerb::kVel) check_range(*value, 0, settings_.max_velocity(), "VEL");
  else check_range(*value, 0, kMostInteger, std::string(line_.token(*node->start).text));
  out.push_back(card_action(span_of(*node), verb, list(std::move(value))));
}

void LineLowering::move(Parser::MoveContext* node, ir::Body& out) {
  out.push_back(card_action(span_of(*node), node->SLASH() ? CardVerb::kMoveBy : CardVerb::kMoveTo, list(expression(node->expression()))));
}

void LineLowering::circle(Parser::CircleContext* node, ir::Body& out) {
  const source::Span span = span_of(*node);
  if (!settings_.interpolates())
    diagnostics_.error("ACR-E15", line_.token(node->CIR()).span, fmt::format("CIRCLE exists in executive versions 2.7 and 4, and this is {}; say VERSION=2.7", settings_.version_text()));
  std::vector<ir::ExprPtr> arguments;
  arguments.push_back(rotation(node->rotation()));
  for (Parser::ExpressionContext* one : node->expression()) arguments.push_back(expression(one));
  const auto constant = [&](std::size_t i) { return ir::constant_value(*arguments[i]); };
  if (const auto way = constant(0); way && std::abs(*way) != 1) diagnostics_.error("ACR-E10", arguments[0]->span, "the direction of a CIRCLE is 1 (clockwise) or -1 (counter-clockwise)");
  if (const auto radius = constant(1); radius && *radius <= 0) diagnostics_.error("ACR-E10", arguments[1]->span, "the radius of a CIRCLE is above 0");
  if (const auto distance = constant(4); distance && *distance < 0) diagnostics_.error("ACR-E10", arguments[4]->span, "the distance of a CIRCLE is not negative; the direction is its first argument");
  out.push_back(card_action(span, CardVerb::kCircle, std::move(arguments)));
}

std::optional<std::int64_t> LineLowering::line_number(const Token& token) {
  if (token.type != Parser::NUMBER) {
    diagnostics_.error("ACR-E06", token.span, "a branch goes to a line number in decimal digits, not to a parameter or a hexadecimal number");
    return std::nullopt;
  }
  const auto number = line_number_of(token.text);
  if (!number) diagnostics_.error("ACR-E03", token.span, fmt::format("line numbers are from 0 to {}", kMaxLineNumber));
  return number;
}

void LineLowering::jump(std::int64_t number, bool call, const source::Span& number_span, const source::Span& span, ir::Body& out) {
  if (store_ && call) return void(diagnostics_.error("ACR-E09", span, "a subroutine can be called from a stored line only; give the line a number"));
  if (store_) return store_->run(span, out, ir::make_number(static_cast<double>(number), number_span));
  if (is_stored && !is_stored(number)) {
    diagnostics_.warning("ACR-W01", number_span, fmt::format("line {} is not stored; the program stops with an error where this is taken", number));
    return out.push_back(card_action(span, CardVerb::kMissingLine, list(ir::make_number(static_cast<double>(number), number_span))));
  }
  if (call) out.push_back(card_action(span, CardVerb::kCall));
  ir::Jump jump;
  jump.kind = call ? ir::JumpKind::kGosub : ir::JumpKind::kGoto;
  jump.label = ir::make_number(static_cast<double>(number), number_span);
  out.push_back(ir::make_stmt(span, std::move(jump)));
}

void LineLowering::branch(Parser::BranchContext* node, ir::Body& out) {
  const auto* operand = node->expression()->sum()->product(0)->operand(0);
  const Token& token = line_.token(*operand->start);
  const source::Span target = span_of(*node->expression());
  if (node->expression()->start != node->expression()->stop) return void(diagnostics_.error("ACR-E06", target, "a branch goes to a line number in decimal digits"));
  if (const auto number = line_number(token)) jump(*number, node->GSB() != nullptr, target, span_of(*node), out);
}

void LineLowering::conditional(Parser::ConditionalContext* node, ir::Body& out) {
  ir::RelayCondition condition;
  condition.relay = expression(node->expression());
  check_range(*condition.relay, 0, kMaxRelay, "the number of a relay");
  const bool outer = std::exchange(in_condition_, true);
  antlr4::tree::TerminalNode* target = node->NUMBER() ? node->NUMBER() : node->PARAMETER() ? node->PARAMETER() : node->HEX_NUMBER();
  if (node->commands()) lower(node->commands(), condition.rest);
  else if (const Token& token = line_.token(target); const auto number = line_number(token)) jump(*number, false, token.span, token.span, condition.rest);
  in_condition_ = outer;
  out.push_back(ir::make_stmt(span_of(*node), std::move(condition)));
}

void LineLowering::relay(Parser::RelayContext* node, ir::Body& out) {
  ir::ExprPtr number = expression(node->expression());
  check_range(*number, 0, kMaxRelay, "the number of a relay");
  out.push_back(card_action(span_of(*node), node->SET() ? CardVerb::kSetRelay : CardVerb::kClearRelay, list(std::move(number))));
}

void LineLowering::print(Parser::PrintContext* node, ir::Body& out) {
  const source::Span span = span_of(*node);
  if (node->expression()) return out.push_back(card_action(span, CardVerb::kPrint, list(expression(node->expression()))));
  out.push_back(ir::make_stmt(span, ir::Send{0, (node->STRING() ? line_.token(node->STRING()).text : std::string()) + "\r\n", {}}));
}

void LineLowering::poke(Parser::PokeContext* node, ir::Body& out) {
  const std::vector<antlr4::tree::TerminalNode*> numbers = node->BARE_HEX();
  const ir::ExprPtr first = bare_hex(numbers[0], kMaxAddress, "an address");
  const double address = ir::constant_value(*first).value_or(0);
  for (std::size_t i = 1; i < numbers.size(); ++i) {
    ir::ExprPtr byte = bare_hex(numbers[i], kMaxByte, "a byte");
    const double at = address + static_cast<double>(i - 1);
    if (at > kMaxAddress) return void(diagnostics_.error("ACR-E04", byte->span, "this byte is behind the last address, FFFF"));
    out.push_back(card_action(span_of(*node), CardVerb::kPoke, list(ir::make_number(at, first->span), std::move(byte))));
  }
}

void LineLowering::peek(Parser::PeekContext* node, ir::Body& out) {
  ir::ExprPtr address = bare_hex(node->BARE_HEX(0), kMaxAddress, "an address");
  ir::ExprPtr count = bare_hex(node->BARE_HEX(1), kMaxAddress + 1, "the number of bytes");
  if (*ir::constant_value(*address) + *ir::constant_value(*count) > kMaxAddress + 1) diagnostics_.error("ACR-E04", count->span, "the bytes go beyond the last address, FFFF");
  out.push_back(card_action(span_of(*node), CardVerb::kPeek, list(std::move(address), std::move(count))));
}

void LineLowering::return_from_subroutine(const source::Span& span, ir::Body& out) {
  if (store_) return void(diagnostics_.error("ACR-E09", span, "RET ends a subroutine of the stored program; give the line a number"));
  out.push_back(card_action(span, CardVerb::kReturn));
  out.push_back(ir::make_stmt(span, ir::Return{}));
}

void LineLowering::plain(Parser::PlainContext* node, ir::Body& out) {
  const source::Span span = span_of(*node);
  if (node->RET()) return return_from_subroutine(span, out);
  if (node->HAL()) return out.push_back(card_action(span, CardVerb::kHalt));
  if (node->REN() && !store_) return void(diagnostics_.error("ACR-E09", span, "RENUMBER works in command mode only; it cannot be stored in a program"));
  if (store_ && (node->REN() || node->NEW()) && in_condition_) return void(diagnostics_.error("ACR-E09", span, fmt::format("{} cannot depend on a relay", line_.token(*node->start).text)));
  if (node->PBO()) return;  // what counts is that it stands first
  ir::ExprPtr from_first = ir::make_number(std::numeric_limits<double>::quiet_NaN(), span);
  if (!store_) {
    if (node->RUN()) out.push_back(card_action(span, CardVerb::kRun, list(std::move(from_first))));
    else out.push_back(card_action(span, node->LIS() ? CardVerb::kList : CardVerb::kNew));
    return;
  }
  if (node->RUN()) store_->run(span, out, std::move(from_first));
  else if (node->LIS()) store_->list(span, out);
  else if (node->NEW()) store_->erase(span, out);
  else store_->renumber(span, out);
}

}  // namespace pmac::compiler::acr1000
