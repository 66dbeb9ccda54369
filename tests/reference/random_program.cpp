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
  ExpressionPtr plain_variable();
  std::shared_ptr<Statement> assignment();
  std::shared_ptr<Statement> statement(int depth, bool in_loop);
  void add_if(Statement& result, int depth, bool in_loop);
  void add_switch(Statement& result, int depth, bool in_loop);
  void add_call(Statement& result);
  Block block(int depth, bool in_loop, int most);
  void add_initial_values(Block& block);
  void add_jumps(RandomProgram& program);

  std::mt19937 random_;
  int loops_ = 0;
  bool may_call_ = true;
  bool has_l_ = true, has_list_ = true;   // variables of the frame that only some routines have
};

ExpressionPtr Maker::number() {
  static constexpr double kValues[] = {0, 1, 2, 3, 7, 10, 0.5, 0.25, 100, 1e6, 3.75, 12345678, 1e-3, 1e300, 9007199254740993.0, 4294967296.0};
  auto result = std::make_shared<Expression>();
  result->number = kValues[below(16)];
  return result;
}

ExpressionPtr Maker::variable() {
  static constexpr Kind kKinds[] = {Kind::kLocal, Kind::kLocal, Kind::kLocal, Kind::kLocal, Kind::kP, Kind::kP,
                                    Kind::kQ, Kind::kComputedP, Kind::kM, Kind::kL, Kind::kRow, Kind::kList};
  auto result = std::make_shared<Expression>();
  result->kind = kKinds[below(12)];
  if ((result->kind == Kind::kL && !has_l_) || (result->kind == Kind::kList && !has_list_)) result->kind = Kind::kP;
  result->variable = below(4);
  const bool is_computed = result->kind == Kind::kComputedP || result->kind == Kind::kRow || result->kind == Kind::kList;
  if (is_computed) result->operands = {expression(1)};
  return result;
}

/// One whose place does not depend on others.
ExpressionPtr Maker::plain_variable() {
  ExpressionPtr result = variable();
  while (!result->operands.empty()) result = variable();
  return result;
}

ExpressionPtr Maker::expression(int depth) {
  static constexpr const char* kOperators[] = {"+", "-", "*", "/", "%", "&", "|", "^", "<<", ">>", "+", "-", "*"};
  static constexpr const char* kFunctions[] = {"abs", "floor", "ceil", "int", "sqrt", "sgn", "rint", "isnan", "madd", "rem",
                                               "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "asinh", "acosh", "atanh",
                                               "exp", "exp2", "ln", "log", "log2", "log10", "pow", "atan2", "cbrt", "qrrt", "rnd"};
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
    const int count = result->text == "madd" ? 3 : result->text == "rem" || result->text == "pow" || result->text == "atan2" ? 2 : 1;
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

void Maker::add_if(Statement& result, int depth, bool in_loop) {
  result.kind = Statement::Kind::kIf;
  result.condition = condition(2);
  result.bare = below(3) == 0;
  const bool has_else = below(2) == 0;
  if (result.bare) result.body = {assignment()};
  else result.body = block(depth - 1, in_loop, 3);
  if (!has_else) return;
  if (result.bare) result.otherwise = {assignment()};
  else result.otherwise = block(depth - 1, in_loop, 3);
}

void Maker::add_switch(Statement& result, int depth, bool in_loop) {
  result.kind = Statement::Kind::kSwitch;
  result.value = expression(1);
  for (int label = 0; label < 4; ++label) {
    if (below(3) == 0) continue;
    result.cases.emplace_back(label, block(depth - 1, in_loop, 2));
    result.falls.push_back(below(3) == 0);
  }
  result.otherwise = block(depth - 1, in_loop, 2);
}

void Maker::add_call(Statement& result) {
  static constexpr Statement::Kind kKinds[] = {Statement::Kind::kGosub, Statement::Kind::kCall, Statement::Kind::kCallsub};
  result.kind = kKinds[below(3)];
  result.routine = below(2);
  result.value = expression(2);
  result.target = plain_variable();
}

std::shared_ptr<Statement> Maker::assignment() {
  static constexpr const char* kAssignments[] = {"=", "=", "=", "=", "+=", "-=", "*=", "/=", "%=", "&=", "|=", "^=", "<<=", ">>=", "++", "--"};
  auto result = std::make_shared<Statement>();
  result->target = variable();
  result->text = any(kAssignments);
  result->value = expression(3);
  return result;
}

std::shared_ptr<Statement> Maker::statement(int depth, bool in_loop) {
  auto result = std::make_shared<Statement>();
  const int kind = depth <= 0 ? below(7) : below(14);
  if (kind == 6 && in_loop) {
    result->kind = below(2) == 0 ? Statement::Kind::kBreakIf : Statement::Kind::kContinueIf;
    result->condition = condition(1);
  } else if (kind <= 7) {
    return assignment();
  } else if (kind <= 9) {
    add_if(*result, depth, in_loop);
  } else if (kind <= 11) {
    result->kind = kind == 10 ? Statement::Kind::kWhile : Statement::Kind::kDo;
    result->counter = loops_++;
    result->condition = condition(1);
    result->body = block(depth - 1, true, 4);
  } else if (kind == 12) {
    add_switch(*result, depth, in_loop);
  } else if (may_call_) {
    add_call(*result);
  } else {
    return assignment();
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
  for (const Kind kind : {Kind::kLocal, Kind::kP, Kind::kQ, Kind::kM, Kind::kL}) {
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

void Maker::add_jumps(RandomProgram& program) {
  const int count = below(2) * (1 + below(4));
  for (int i = 0; i < count; ++i) {
    JumpBlock jump;
    jump.body = block(1, false, 3);
    jump.condition = condition(1);
    jump.if_true = below(count + 1) - 1;
    jump.otherwise = below(3) == 0 ? below(count + 1) - 1 : i + 1 < count ? i + 1 : -1;
    jump.computed = below(3) == 0;
    program.jumps.push_back(std::move(jump));
  }
}

RandomProgram Maker::make() {
  RandomProgram program;
  add_initial_values(program.body);
  for (auto& statement : block(3, false, 8)) program.body.push_back(statement);
  add_jumps(program);
  may_call_ = false;
  for (Block& routine : program.routines) routine = block(1, false, 4);
  has_l_ = has_list_ = false;
  program.own_frame = block(1, false, 4);
  has_list_ = true;
  program.subprogram = block(2, false, 4);
  return program;
}

}  // namespace

RandomProgram random_program(std::uint32_t seed) { return Maker(seed).make(); }

}  // namespace pmac::reference
