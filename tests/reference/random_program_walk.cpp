// Executes a random program by walking over its tree.
#include <cmath>
#include <limits>
#include <map>

#include "tests/reference/random_program.h"

namespace pmac::reference {
namespace {

constexpr int kMaxSteps = 200000;

struct TooManySteps {};

/// Truncated toward zero to 64 bits: nan 0, top-bit masks by their bits, further out the nearest end.
long long to_integer(double value) {
  if (std::isnan(value)) return 0;
  const double whole = std::trunc(value);
  if (whole < -9223372036854775808.0) return std::numeric_limits<long long>::min();
  if (whole >= 18446744073709551616.0) return std::numeric_limits<long long>::max();
  if (whole >= 9223372036854775808.0) return static_cast<long long>(static_cast<unsigned long long>(whole));
  return static_cast<long long>(whole);
}

double modulo(double a, double b) {
  if (std::isnan(a) || std::isnan(b) || std::isinf(a) || std::isinf(2 * b) || b == 0) return std::nan("");
  const double modulus = b > 0 ? b : -2 * b;
  const double low = b > 0 ? 0 : b;
  double rest = std::fmod(a, modulus);
  while (rest < low) rest += modulus;
  while (rest >= low + modulus) rest -= modulus;
  if (rest >= low + modulus || rest < low) rest = low;
  return rest == 0 ? 0.0 : rest;
}

double shift(double left, double count, bool is_left) {
  const int bits = !(count >= 1) ? 0 : count >= 64 ? 64 : static_cast<int>(count);
  long long value = to_integer(left);
  for (int i = 0; i < bits; ++i) {
    if (is_left) value = static_cast<long long>(static_cast<unsigned long long>(value) * 2u);
    else value = value >= 0 ? value / 2 : -((-(value + 1)) / 2) - 1;
  }
  return static_cast<double>(value);
}

double binary(const std::string& op, double a, double b) {
  if (op == "+") return a + b;
  if (op == "-") return a - b;
  if (op == "*") return a * b;
  if (op == "/") return a / b;
  if (op == "%") return modulo(a, b);
  if (op == "&") return static_cast<double>(to_integer(a) & to_integer(b));
  if (op == "|") return static_cast<double>(to_integer(a) | to_integer(b));
  if (op == "^") return static_cast<double>(to_integer(a) ^ to_integer(b));
  return shift(a, b, op == "<<");
}

using OneArgument = double (*)(double);
OneArgument library_function(const std::string& name) {
  static const std::map<std::string, OneArgument> kFunctions = {
      {"sin", std::sin}, {"cos", std::cos}, {"tan", std::tan}, {"asin", std::asin}, {"acos", std::acos}, {"atan", std::atan},
      {"sinh", std::sinh}, {"cosh", std::cosh}, {"tanh", std::tanh}, {"asinh", std::asinh}, {"acosh", std::acosh}, {"atanh", std::atanh},
      {"exp", std::exp}, {"exp2", std::exp2}, {"ln", std::log}, {"log", std::log}, {"log2", std::log2}, {"log10", std::log10},
      {"cbrt", std::cbrt}, {"rnd", std::round}};
  return kFunctions.at(name);
}

double function(const std::string& name, const std::vector<double>& x) {
  if (name == "abs") return std::fabs(x[0]);
  if (name == "floor" || name == "int") return std::floor(x[0]);
  if (name == "ceil") return std::ceil(x[0]);
  if (name == "sqrt") return std::sqrt(x[0]);
  if (name == "sgn") return std::isnan(x[0]) ? x[0] : x[0] > 0 ? 1 : x[0] < 0 ? -1 : 0;
  if (name == "rint") return std::nearbyint(x[0]);
  if (name == "isnan") return std::isnan(x[0]) ? 1 : 0;
  if (name == "madd") return x[0] * x[1] + x[2];
  if (name == "rem") return std::fmod(x[0], x[1]);
  if (name == "pow") return std::pow(x[0], x[1]);
  if (name == "atan2") return std::atan2(x[0], x[1]);
  if (name == "qrrt") return std::sqrt(std::sqrt(x[0]));
  return library_function(name)(x[0]);
}

bool compare(const std::string& op, double a, double b) {
  if (op == "==") return a == b;
  if (op == "!=" || op == "<>") return a != b;
  if (op == "<") return a < b;
  if (op == ">") return a > b;
  if (op == "<=" ) return a <= b;
  if (op == ">=") return a >= b;
  if (op == "!>") return !(a > b);
  if (op == "!<") return !(a < b);
  const bool near = std::fabs(a - b) < 0.5;
  return op == "~" ? near : !near;
}

enum class Leave { kNo, kBreak, kContinue };

class Walker {
 public:
  explicit Walker(const RandomProgram& program) : program_(program) {}
  Outcome outcome;
  void run() {
    execute(program_.body);
    follow_jumps();
    for (std::size_t i = 0; i < kLocals; ++i) {
      outcome.p[4 + i] += frame_.locals[i];
      outcome.m[i] += frame_.numbered[i];
      outcome.row[i] += frame_.list[i];
    }
  }

 private:
  void step() {
    if (++steps_ > kMaxSteps) throw TooManySteps{};
  }
  double& variable(const Expression& expression);
  double value(const Expression& expression);
  bool holds(const Condition& condition);
  void assign(const Statement& statement);
  Leave execute(const Block& block);
  Leave execute(const Statement& statement);
  void follow_jumps();
  void loop(const Statement& statement);
  Leave select(const Statement& statement);
  void call(const Statement& statement);
  void call_with_own_frame(const Statement& statement);

  struct Frame { std::array<double, kLocals> locals{}, numbered{}, list{}; };

  const RandomProgram& program_;
  Frame frame_;
  int steps_ = 0;
};

double& Walker::variable(const Expression& expression) {
  const auto i = static_cast<std::size_t>(expression.variable);
  const auto index = [&](int mask) { return static_cast<std::size_t>(to_integer(value(*expression.operands[0])) & mask); };
  if (expression.kind == Expression::Kind::kLocal) return frame_.locals[i];
  if (expression.kind == Expression::Kind::kP) return outcome.p[i];
  if (expression.kind == Expression::Kind::kQ) return outcome.q[i];
  if (expression.kind == Expression::Kind::kM) return outcome.m[i];
  if (expression.kind == Expression::Kind::kL) return frame_.numbered[i];
  if (expression.kind == Expression::Kind::kRow) return outcome.row[index(kRow - 1)];
  if (expression.kind == Expression::Kind::kList) return frame_.list[index(kList - 1)];
  return outcome.p[4 + index(3)];
}

double Walker::value(const Expression& expression) {
  step();
  switch (expression.kind) {
    case Expression::Kind::kNumber: return expression.number;
    case Expression::Kind::kUnary: {
      const double operand = value(*expression.operands[0]);
      return expression.text == "-" ? -operand : static_cast<double>(~to_integer(operand));
    }
    case Expression::Kind::kBinary: {
      const double left = value(*expression.operands[0]);
      return binary(expression.text, left, value(*expression.operands[1]));
    }
    case Expression::Kind::kFunction: {
      std::vector<double> arguments;
      for (const ExpressionPtr& operand : expression.operands) arguments.push_back(value(*operand));
      return function(expression.text, arguments);
    }
    default: return variable(expression);
  }
}

bool Walker::holds(const Condition& condition) {
  switch (condition.kind) {
    case Condition::Kind::kValue: return value(*condition.values[0]) != 0;
    case Condition::Kind::kNot: return !holds(*condition.operands[0]);
    case Condition::Kind::kAnd: return holds(*condition.operands[0]) && holds(*condition.operands[1]);
    case Condition::Kind::kOr: return holds(*condition.operands[0]) || holds(*condition.operands[1]);
    case Condition::Kind::kCompare: break;
  }
  const double left = value(*condition.values[0]);
  return compare(condition.text, left, value(*condition.values[1]));
}

void Walker::assign(const Statement& statement) {
  if (statement.text == "++" || statement.text == "--") {
    variable(*statement.target) += statement.text == "++" ? 1 : -1;
    return;
  }
  const double right = value(*statement.value);
  double& target = variable(*statement.target);
  target = statement.text == "=" ? right : binary(statement.text.substr(0, statement.text.size() - 1), target, right);
}

void Walker::loop(const Statement& statement) {
  int count = 0;
  const auto goes_on = [&] { return count < 4 && holds(*statement.condition); };
  bool enters = statement.kind == Statement::Kind::kDo || goes_on();
  while (enters) {
    ++count;
    if (execute(statement.body) == Leave::kBreak) return;
    enters = goes_on();
  }
}

void Walker::follow_jumps() {
  int at = program_.jumps.empty() ? -1 : 0;
  for (int count = 1; at >= 0 && count <= kMostJumps; ++count) {
    const JumpBlock& jump = program_.jumps[static_cast<std::size_t>(at)];
    execute(jump.body);
    at = holds(*jump.condition) ? jump.if_true : jump.otherwise;
  }
}

/// break leaves the switch, continue what is around it.
Leave Walker::select(const Statement& statement) {
  const double selector = static_cast<double>(to_integer(value(*statement.value)));  // truncated as operands of & are
  const auto leaves = [](Leave leave) { return leave == Leave::kBreak ? Leave::kNo : leave; };
  bool is_in = false;
  for (std::size_t i = 0; i < statement.cases.size(); ++i) {
    is_in = is_in || selector == statement.cases[i].first;
    if (!is_in) continue;
    if (const Leave leave = execute(statement.cases[i].second); leave != Leave::kNo) return leaves(leave);
    if (!statement.falls[i]) return Leave::kNo;
  }
  return leaves(execute(statement.otherwise));
}

void Walker::call(const Statement& statement) {
  const Frame saved = frame_;
  Frame inside;
  inside.locals = {value(*statement.value), outcome.p[0], variable(*statement.target), 0};
  frame_ = inside;
  execute(program_.subprogram);
  const double result = frame_.locals[2];
  frame_ = saved;
  variable(*statement.target) = result;
}

void Walker::call_with_own_frame(const Statement& statement) {
  const Frame saved = frame_;
  Frame inside;
  inside.locals = {value(*statement.value), outcome.p[0], 0, 0};
  frame_ = inside;
  execute(program_.own_frame);
  frame_ = saved;
}

Leave Walker::execute(const Statement& statement) {
  step();
  switch (statement.kind) {
    case Statement::Kind::kAssign: assign(statement); return Leave::kNo;
    case Statement::Kind::kIf: return execute(holds(*statement.condition) ? statement.body : statement.otherwise);
    case Statement::Kind::kWhile:
    case Statement::Kind::kDo: loop(statement); return Leave::kNo;
    case Statement::Kind::kSwitch: return select(statement);
    case Statement::Kind::kGosub:
      execute(program_.routines[static_cast<std::size_t>(statement.routine)]);
      if (statement.routine == 1) execute(program_.routines[0]);
      return Leave::kNo;
    case Statement::Kind::kCallsub: call_with_own_frame(statement); return Leave::kNo;
    case Statement::Kind::kCall: call(statement); return Leave::kNo;
    case Statement::Kind::kBreakIf: return holds(*statement.condition) ? Leave::kBreak : Leave::kNo;
    case Statement::Kind::kContinueIf: return holds(*statement.condition) ? Leave::kContinue : Leave::kNo;
  }
  return Leave::kNo;
}

Leave Walker::execute(const Block& block) {
  for (const auto& statement : block) {
    if (const Leave leave = execute(*statement); leave != Leave::kNo) return leave;
  }
  return Leave::kNo;
}

}  // namespace

Outcome execute(const RandomProgram& program) {
  Walker walker(program);
  try {
    walker.run();
  } catch (const TooManySteps&) {
    walker.outcome.finished = false;
  }
  return walker.outcome;
}

}  // namespace pmac::reference
