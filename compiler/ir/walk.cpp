#include "compiler/ir/walk.h"

namespace pmac::compiler::ir {
namespace {

class Walk {
 public:
  explicit Walk(const Visitor& visitor) : visitor_(visitor) {}

  void body(const Body& statements) {
    for (const StmtPtr& statement : statements) stmt(statement);
  }

  void stmt(const StmtPtr& statement) {
    if (statement) stmt(*statement);
  }

  void stmt(const Stmt& statement) {
    if (visitor_.statement) visitor_.statement(statement);
    std::visit([&](const auto& node) { inside(node); }, statement.node);
  }

  void expr(const ExprPtr& expression, Use use = Use::kRead) {
    if (expression) expr(*expression, use);
  }

  void expr(const Expr& expression, Use use) {
    if (visitor_.expression) visitor_.expression(expression, use);
    if (const auto* variable = std::get_if<Variable>(&expression.node)) expr(variable->index);
    else if (const auto* name = std::get_if<NameUse>(&expression.node)) list(name->arguments);
    else if (const auto* element = std::get_if<Element>(&expression.node)) list(element->indices);
    else if (const auto* unary = std::get_if<Unary>(&expression.node)) expr(unary->operand);
    else if (const auto* binary = std::get_if<Binary>(&expression.node)) expr(binary->left), expr(binary->right);
    else if (const auto* call = std::get_if<FunctionCall>(&expression.node)) list(call->arguments);
    else if (const auto* address = std::get_if<AddressOf>(&expression.node)) expr(address->place, Use::kReference);
  }

 private:
  void list(const std::vector<ExprPtr>& expressions) {
    for (const ExprPtr& expression : expressions) expr(expression);
  }
  void arguments(const std::vector<ExprPtr>& values, const std::vector<bool>& by_reference) {
    for (std::size_t i = 0; i < values.size(); ++i) expr(values[i], i < by_reference.size() && by_reference[i] ? Use::kReference : Use::kRead);
  }

  void inside(const Block& node) { body(node.body); }
  void inside(const Assign& node) {
    list(node.values);
    expr(node.target, node.op == bytecode::AssignOp::kSet ? Use::kWrite : Use::kUpdate);
  }
  void inside(const AssignSeries& node) { expr(node.value), expr(node.target, Use::kWrite); }
  void inside(const Evaluate& node) { expr(node.value); }
  void inside(const If& node) {
    for (const IfBranch& branch : node.branches) expr(branch.condition), stmt(branch.body);
    stmt(node.otherwise);
  }
  void inside(const While& node) { expr(node.condition), stmt(node.body); }
  void inside(const DoWhile& node) { stmt(node.body), expr(node.condition); }
  void inside(const Switch& node) {
    expr(node.value);
    for (const Case& label : node.cases) expr(label.value);
    body(node.body);
  }
  void inside(const Locals& node) {
    for (const LocalDeclaration& name : node.names) expr(name.size), expr(name.value);
  }
  void inside(const Jump& node) { expr(node.label), arguments(node.arguments, node.by_reference); }
  void inside(const Call& node) { expr(node.number), arguments(node.arguments, node.by_reference); }
  void inside(const CodeLine& node) {
    stmt(node.call);
    for (const LineWord& word : node.words) expr(word.value), expr(word.velocity), expr(word.trigger);
  }
  void inside(const LineCondition& node) { expr(node.flag), body(node.rest); }
  void inside(const SetFlag& node) { expr(node.flag); }
  void inside(const Cycle& node) { expr(node.number); }
  void inside(const SetParameter& node) { expr(node.value); }
  void inside(const SetNormal& node) {
    for (const ExprPtr& component : node.vector) expr(component);
  }
  void inside(const Move& node) {
    for (const Word& word : node.words) expr(word.value);
  }
  void inside(const Dwell& node) { expr(node.time_ms); }
  void inside(const Delay& node) { expr(node.time_ms); }
  void inside(const Control& node) { list(node.arguments); }
  void inside(const CardAction& node) { list(node.arguments); }
  void inside(const RelayCondition& node) { expr(node.relay), body(node.rest); }
  void inside(const Command& node) { list(node.values); }
  void inside(const Send& node) { list(node.values); }
  void inside(const AddressCoord& node) { expr(node.number); }
  void inside(const AddressMotor& node) { expr(node.number); }
  void inside(const DefinePointer& node) { expr(node.element, Use::kReference); }
  void inside(const Globals& node) {
    for (const GlobalDeclaration& name : node.names) expr(name.size), expr(name.value);
  }
  void inside(const Report& node) { expr(node.value); }
  template <class Other> void inside(const Other&) {}  // nothing inside

  const Visitor& visitor_;
};

}  // namespace

void walk(const Stmt& statement, const Visitor& visitor) { Walk(visitor).stmt(statement); }

void walk(const Body& body, const Visitor& visitor) { Walk(visitor).body(body); }

void walk(const Expr& expr, Use use, const Visitor& visitor) { Walk(visitor).expr(expr, use); }

}  // namespace pmac::compiler::ir
