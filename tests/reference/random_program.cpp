#include "tests/reference/random_program.h"

#include <random>

namespace pmac::reference {
namespace {

using Kind = Expression::Kind;

class Maker {
 public:
  explicit Maker(std::uint32_t seed) : random_(seed) {}
  RandomProgram make();

 private:
  int below(int limit) { return static_cast<int>(random_() % static_cast<unsigned>(limit)); }
  template <std::size_t N>
  std::string any(const char* const (&texts)[N]) { return texts[below(static_cast<int>(N))]; }
  ExpressionPtr number();
  ExpressionPtr variable();
  ExpressionPtr expression(int depth);
  std::shared_ptr<const Condition> condition(int depth);
  std::shared_ptr<Statement> statement(int depth, bool in_loop);
  void add_switch(Statement& result, int depth);
  Block block(int depth, bool in_loop, int most);
  void add_initial_values(Block& block);

  std::mt19937 random_;
  int loops_ = 0;
  bool may_call_ = true;
};

ExpressionPtr Maker::number() {
  static constexpr double kValues[] = {0, 1, 2, 3, 7, 10, 0.5, 0.25, 100, 1e6, 3.75, 12345678, 1e-3};
  auto result = std::make_shared<Expression>();
  result->number = kValues[below(13)];
  return result;
}

ExpressionPtr Maker::variable() {
  auto result = std::make_shared<Expression>();
  const int kind = below(8);
  result->kind = kind < 4 ? Kind::kLocal : kind < 6 ? Kind::kP : kind == 6 ? Kind::kQ : Kind::kComputedP;
  result->variable = below(4);
  if (result->kind == Kind::kComputedP) result->operands = {expression(1)};
  return result;
}

ExpressionPtr Maker::expression(int depth) {
  static constexpr const char* kOperators[] = {"+", "-", "*", "/", "%", "&", "|", "^", "<<", ">>", "+", "-", "*"};
  static constexpr const char* kFunctions[] = {"abs", "floor", "ceil", "int", "sqrt", "sgn", "rint", "isnan", "madd", "rem"};
  const int kind = depth <= 0 ? below(2) : below(10);
  if (kind == 0) return number();
  if (kind <= 2) return variable();
  auto result = std::make_shared<Expression>();
  if (kind == 3) {
    result->kind = Kind::kUnary;
    result->text = below(2) == 0 ? "-" : "~";
    result->operands = {expression(depth - 1)};
  } else if (kind == 4) {
    result->kind = Kind::kFunction;
    result->text = any(kFunctions);
    const int count = result->text == "madd" ? 3 : result->text == "rem" ? 2 : 1;
    for (int i = 0; i < count; ++i) result->operands.push_back(expression(depth - 1));
  } else {
    result->kind = Kind::kBinary;
    result->text = any(kOperators);
    result->operands = {expression(depth - 1), expression(depth - 1)};
  }
  return result;
}

std::shared_ptr<const Condition> Maker::condition(int depth) {
  static constexpr const char* kComparators[] = {"==", "!=", "<>", "<", ">", "<=", ">=", "!>", "!<", "~", "!~"};
  auto result = std::make_shared<Condition>();
  const int kind = depth <= 0 ? 3 + below(4) : below(7);
  if (kind <= 1) {
    result->kind = kind == 0 ? Condition::Kind::kAnd : Condition::Kind::kOr;
    result->operands = {condition(depth - 1), condition(depth - 1)};
  } else if (kind == 2) {
    result->kind = Condition::Kind::kNot;
    result->operands = {condition(depth - 1)};
  } else if (kind == 3) {
    result->values = {expression(1)};
  } else {
    result->kind = Condition::Kind::kCompare;
    result->text = any(kComparators);
    result->values = {expression(2), expression(2)};
  }
  return result;
}

void Maker::add_switch(Statement& result, int depth) {
  result.value = expression(1);
  for (int label = 0; label < 4; ++label) {
    if (below(3) == 0) continue;
    result.cases.emplace_back(label, block(depth - 1, false, 2));
    result.falls.push_back(below(3) == 0);
  }
  result.otherwise = block(depth - 1, false, 2);
}

std::shared_ptr<Statement> Maker::statement(int depth, bool in_loop) {
  static constexpr const char* kAssignments[] = {"=", "=", "=", "=", "+=", "-=", "*=", "/=", "%=", "&=", "|=", "^=", "++", "--"};
  auto result = std::make_shared<Statement>();
  const int kind = depth <= 0 ? below(7) : below(14);
  if (kind == 6 && in_loop) {
    result->kind = below(2) == 0 ? Statement::Kind::kBreakIf : Statement::Kind::kContinueIf;
    result->condition = condition(1);
  } else if (kind <= 7) {
    result->target = variable();
    result->text = any(kAssignments);
    result->value = expression(3);
  } else if (kind <= 9) {
    result->kind = Statement::Kind::kIf;
    result->condition = condition(2);
    result->body = block(depth - 1, in_loop, 3);
    if (below(2) == 0) result->otherwise = block(depth - 1, in_loop, 3);
  } else if (kind <= 11) {
    result->kind = kind == 10 ? Statement::Kind::kWhile : Statement::Kind::kDo;
    result->counter = loops_++;
    result->condition = condition(1);
    result->body = block(depth - 1, true, 4);
  } else if (kind == 12) {
    result->kind = Statement::Kind::kSwitch;
    add_switch(*result, depth);
  } else if (may_call_) {
    result->kind = below(2) == 0 ? Statement::Kind::kGosub : Statement::Kind::kCall;
    result->routine = below(2);
    result->value = expression(2);
    result->target = variable();
    while (result->target->kind == Kind::kComputedP) result->target = variable();
  } else {
    result->target = variable();
    result->text = "=";
    result->value = expression(2);
  }
  return result;
}

Block Maker::block(int depth, bool in_loop, int most) {
  Block result;
  for (int i = 1 + below(most); i > 0; --i) result.push_back(statement(depth, in_loop));
  return result;
}

/// Numbers in all variables, so that not everything is 0 or nan.
void Maker::add_initial_values(Block& block) {
  for (const Kind kind : {Kind::kLocal, Kind::kP, Kind::kQ}) {
    for (int i = 0; i < 4; ++i) {
      auto target = std::make_shared<Expression>();
      target->kind = kind;
      target->variable = i;
      auto assignment = std::make_shared<Statement>();
      assignment->target = target;
      assignment->text = "=";
      assignment->value = number();
      block.push_back(assignment);
    }
  }
}

RandomProgram Maker::make() {
  RandomProgram program;
  add_initial_values(program.body);
  for (auto& statement : block(3, false, 8)) program.body.push_back(statement);
  may_call_ = false;
  for (Block& routine : program.routines) routine = block(1, false, 4);
  program.subprogram = block(2, false, 4);
  return program;
}

}  // namespace

RandomProgram random_program(std::uint32_t seed) { return Maker(seed).make(); }

}  // namespace pmac::reference
