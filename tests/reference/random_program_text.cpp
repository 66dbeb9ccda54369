// A random program as script, with no more parentheses than the precedence of the reference asks for.
#include <charconv>

#include "tests/reference/random_program.h"

namespace pmac::reference {
namespace {

constexpr const char* kLocalNames[] = {"a", "b", "c", "d"};

std::string number_text(double value) {
  std::array<char, 40> buffer{};
  return {buffer.data(), std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr};
}

/// 4 tightest: operand; 3: * / % &; 2: shifts; 1: + - | ^.
int level_of(const Expression& expression) {
  if (expression.kind != Expression::Kind::kBinary) return 4;
  const std::string& op = expression.text;
  if (op == "*" || op == "/" || op == "%" || op == "&") return 3;
  return op == "<<" || op == ">>" ? 2 : 1;
}

std::string text_of(const Expression& expression);

std::string operand_text(const Expression& operand, bool needs_parentheses) {
  const std::string text = text_of(operand);
  return needs_parentheses ? "(" + text + ")" : text;
}

/// An index of any value, also nan and infinity, made one that is there.
std::string masked(const Expression& index, int mask) { return operand_text(index, level_of(index) < 3) + " & " + std::to_string(mask); }

std::string variable_text(const Expression& expression) {
  switch (expression.kind) {
    case Expression::Kind::kLocal: return kLocalNames[expression.variable];
    case Expression::Kind::kP: return "P" + std::to_string(kFirstP + expression.variable);
    case Expression::Kind::kQ: return "Q" + std::to_string(kFirstQ + expression.variable);
    case Expression::Kind::kM: return "M" + std::to_string(kFirstM + expression.variable);
    case Expression::Kind::kL: return "L" + std::to_string(kFirstL + expression.variable);
    case Expression::Kind::kRow: return "Row(" + masked(*expression.operands[0], kRow - 1) + ")";
    case Expression::Kind::kList: return "list(" + masked(*expression.operands[0], kList - 1) + ")";
    default: return "P(104 + (" + masked(*expression.operands[0], 3) + "))";
  }
}

std::string function_text(const Expression& expression) {
  std::string text = expression.text + "(";
  for (std::size_t i = 0; i < expression.operands.size(); ++i) text += (i == 0 ? "" : ", ") + text_of(*expression.operands[i]);
  return text + ")";
}

std::string text_of(const Expression& expression) {
  switch (expression.kind) {
    case Expression::Kind::kNumber: return number_text(expression.number);
    case Expression::Kind::kUnary: {
      const bool is_plain = expression.operands[0]->kind != Expression::Kind::kUnary && level_of(*expression.operands[0]) == 4;
      return expression.text + operand_text(*expression.operands[0], !is_plain);
    }
    case Expression::Kind::kFunction: return function_text(expression);
    case Expression::Kind::kBinary: {
      const int level = level_of(expression);
      const Expression& left = *expression.operands[0];
      const Expression& right = *expression.operands[1];
      return operand_text(left, level_of(left) < level) + " " + expression.text + " " +
             operand_text(right, level_of(right) <= level);
    }
    default: return variable_text(expression);
  }
}

std::string text_of(const Condition& condition) {
  switch (condition.kind) {
    case Condition::Kind::kCompare: return text_of(*condition.values[0]) + " " + condition.text + " " + text_of(*condition.values[1]);
    case Condition::Kind::kValue: return text_of(*condition.values[0]);
    case Condition::Kind::kNot: return "!(" + text_of(*condition.operands[0]) + ")";
    case Condition::Kind::kAnd:
    case Condition::Kind::kOr: break;
  }
  const char* op = condition.kind == Condition::Kind::kAnd ? " && " : " || ";
  return "(" + text_of(*condition.operands[0]) + ")" + op + "(" + text_of(*condition.operands[1]) + ")";
}

class Printer {
 public:
  std::string text;
  void block(const Block& statements, int depth) {
    for (const auto& statement : statements) add(*statement, depth);
  }
  void jump(const JumpBlock& jump, std::size_t index);

 private:
  void line(int depth, const std::string& content) { text += std::string(static_cast<std::size_t>(depth) * 2, ' ') + content + "\n"; }
  void add(const Statement& statement, int depth);
  void add_assignment(const Statement& statement, int depth);
  void add_if(const Statement& statement, int depth);
  void add_loop(const Statement& statement, int depth);
  void add_switch(const Statement& statement, int depth);
};

void Printer::add_loop(const Statement& statement, int depth) {
  const std::string counter = "P" + std::to_string(1000 + statement.counter);
  const std::string condition = "(" + counter + " < 4 && (" + text_of(*statement.condition) + "))";
  line(depth, counter + " = 0;");
  line(depth, statement.kind == Statement::Kind::kWhile ? "while " + condition + " {" : "do {");
  line(depth + 1, counter + "++;");
  block(statement.body, depth + 1);
  line(depth, statement.kind == Statement::Kind::kWhile ? "}" : "} while " + condition);
}

void Printer::add_switch(const Statement& statement, int depth) {
  line(depth, "switch (" + text_of(*statement.value) + ") {");
  for (std::size_t i = 0; i < statement.cases.size(); ++i) {
    line(depth, "case " + std::to_string(statement.cases[i].first) + ":");
    block(statement.cases[i].second, depth + 1);
    if (!statement.falls[i]) line(depth + 1, "break;");
  }
  line(depth, "default:");
  block(statement.otherwise, depth + 1);
  line(depth, "}");
}

void Printer::add_assignment(const Statement& statement, int depth) {
  const bool has_value = statement.text != "++" && statement.text != "--";
  line(depth, variable_text(*statement.target) + (has_value ? " " + statement.text + " " + text_of(*statement.value) : statement.text) + ";");
}

void Printer::add_if(const Statement& statement, int depth) {
  const char* brace = statement.bare ? "" : " {";
  line(depth, "if (" + text_of(*statement.condition) + ")" + brace);
  block(statement.body, depth + 1);
  if (!statement.otherwise.empty()) {
    line(depth, statement.bare ? "else" : "} else {");
    block(statement.otherwise, depth + 1);
  }
  if (!statement.bare) line(depth, "}");
}

void Printer::add(const Statement& statement, int depth) {
  switch (statement.kind) {
    case Statement::Kind::kAssign: add_assignment(statement, depth); break;
    case Statement::Kind::kIf: add_if(statement, depth); break;
    case Statement::Kind::kWhile:
    case Statement::Kind::kDo: add_loop(statement, depth); break;
    case Statement::Kind::kSwitch: add_switch(statement, depth); break;
    case Statement::Kind::kGosub: line(depth, "gosub " + std::to_string(1000 + statement.routine) + ";"); break;
    case Statement::Kind::kCallsub: line(depth, "callsub 1002(" + text_of(*statement.value) + ", P100);"); break;
    case Statement::Kind::kCall:
      line(depth, "call Work(" + text_of(*statement.value) + ", P100, " + variable_text(*statement.target) + ");");
      break;
    case Statement::Kind::kBreakIf: line(depth, "if (" + text_of(*statement.condition) + ") break;"); break;
    case Statement::Kind::kContinueIf: line(depth, "if (" + text_of(*statement.condition) + ") continue;"); break;
  }
}

/// N3900 is the last label.
std::string label_text(int jump, bool computed) {
  const int label = jump < 0 ? 3900 : 3000 + jump;
  return computed ? "(P" + std::to_string(kJumpCount) + " * 0 + " + std::to_string(label) + ")" : std::to_string(label);
}

void Printer::jump(const JumpBlock& jump, std::size_t index) {
  const std::string counter = "P" + std::to_string(kJumpCount);
  line(0, label_text(static_cast<int>(index), false).insert(0, "N") + ":");
  line(0, counter + "++;");
  line(0, "if (" + counter + " > " + std::to_string(kMostJumps) + ") goto 3900;");
  block(jump.body, 0);
  line(0, "if (" + text_of(*jump.condition) + ") goto " + label_text(jump.if_true, jump.computed) + ";");
  line(0, "goto " + label_text(jump.otherwise, false) + ";");
}

}  // namespace

std::string to_script(const RandomProgram& program) {
  Printer printer;
  printer.text += "global Row(8);\nopen subprog Work(a, b, &c)\nlocal d, list(4);\nd = 0; list(0) = 0; list(1) = 0; list(2) = 0; list(3) = 0;\n";
  printer.block(program.subprogram, 0);
  printer.text += "close\n&1 open prog 1\nlocal a, b, c, d, list(4);\n";
  printer.block(program.body, 0);
  printer.text += "P" + std::to_string(kJumpCount) + " = 0;\n";
  for (std::size_t i = 0; i < program.jumps.size(); ++i) printer.jump(program.jumps[i], i);
  printer.text += "N3900:\nP104 += a; P105 += b; P106 += c; P107 += d;\nM40 += L20; M41 += L21; M42 += L22; M43 += L23;\n"
                  "Row(0) += list(0); Row(1) += list(1); Row(2) += list(2); Row(3) += list(3);\nreturn;\n";
  for (std::size_t i = 0; i < program.routines.size(); ++i) {
    printer.text += "N" + std::to_string(1000 + i) + ":\n";
    printer.block(program.routines[i], 0);
    printer.text += i == 1 ? "gosub 1000;\nreturn;\n" : "return;\n";
  }
  printer.text += "N1002:\nc = 0; d = 0;\n";
  printer.block(program.own_frame, 0);
  return printer.text + "return;\nclose\n";
}

}  // namespace pmac::reference
