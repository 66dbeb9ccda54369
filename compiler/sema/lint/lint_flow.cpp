// Statements without effect, and ways through a program that lead nowhere.
#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "compiler/ir/walk.h"
#include "compiler/sema/lint/lint.h"

namespace pmac::compiler::sema {
namespace {

using ir::Operator;

bool leaves(const ir::Stmt& statement);

bool ends_by_leaving(const ir::Body& body) { return !body.empty() && leaves(*body.back()); }

/// What follows the statement in its body is not reached from it. stop does not leave: a program goes on behind it when it is run again.
bool leaves(const ir::Stmt& statement) {
  if (const auto* jump = std::get_if<ir::Jump>(&statement.node)) return jump->kind == ir::JumpKind::kGoto;
  if (const auto* block = std::get_if<ir::Block>(&statement.node)) return ends_by_leaving(block->body);
  if (const auto* branch = std::get_if<ir::If>(&statement.node))
    return branch->otherwise && leaves(*branch->otherwise) && std::all_of(branch->branches.begin(), branch->branches.end(), [](const ir::IfBranch& way) { return leaves(*way.body); });
  return std::holds_alternative<ir::Return>(statement.node) || std::holds_alternative<ir::Break>(statement.node) || std::holds_alternative<ir::Continue>(statement.node);
}

bool same_variable(const ir::Expr& a, const ir::Expr& b) {
  const auto* left = std::get_if<ir::Variable>(&a.node);
  const auto* right = std::get_if<ir::Variable>(&b.node);
  return left && right && left->variable_class == right->variable_class && left->number == right->number && !left->index && !right->index;
}

/// Some part of it comes out of a macro: a switch of the build, not of the program.
bool has_macro(const ir::Expr& expr) {
  bool found = false;
  ir::walk(expr, ir::Use::kRead, {{}, [&](const ir::Expr& part, ir::Use) { found = found || part.span.expansion >= 0; }});
  return found;
}

class FlowLint {
 public:
  FlowLint(const ir::Buffer& buffer, source::Diagnostics& diagnostics) : buffer_(buffer), diagnostics_(diagnostics) {}

  void run() {
    check_reach(buffer_.body, routine_begins());
    ir::walk(buffer_.body, {[&](const ir::Stmt& statement) { look(statement); }, {}});
    check_labels();
  }

 private:
  std::set<std::size_t> routine_begins() const {
    std::set<std::size_t> begins;
    for (const ir::Routine& routine : buffer_.routines) begins.insert(routine.first);
    return begins;
  }

  void look(const ir::Stmt& statement) {
    if (const auto* block = std::get_if<ir::Block>(&statement.node)) check_reach(block->body, {});
    else if (const auto* selection = std::get_if<ir::Switch>(&statement.node)) check_switch(*selection);
    else if (const auto* branch = std::get_if<ir::If>(&statement.node)) check_if(*branch);
    else if (const auto* assign = std::get_if<ir::Assign>(&statement.node)) check_assignment(*assign, statement.span);
  }

  /// begins: indices of statements that are reached from elsewhere.
  void check_reach(const ir::Body& body, const std::set<std::size_t>& begins) {
    bool left = false;
    for (std::size_t i = 0; i < body.size(); ++i) {
      const bool entered = begins.contains(i) || std::holds_alternative<ir::Label>(body[i]->node);
      const bool declares = std::holds_alternative<ir::Locals>(body[i]->node) || std::holds_alternative<ir::Globals>(body[i]->node);
      if (entered) left = false;
      if (left && !declares && !has_label_inside(*body[i])) {
        diagnostics_.warning("PM7011", body[i]->span, "this is never reached");
        return;
      }
      left = left || leaves(*body[i]);
    }
  }

  static bool has_label_inside(const ir::Stmt& statement) {
    bool found = false;
    ir::walk(statement, {[&](const ir::Stmt& inner) { found = found || std::holds_alternative<ir::Label>(inner.node); }, {}});
    return found;
  }

  void check_switch(const ir::Switch& selection) {
    std::set<std::size_t> begins;
    for (const ir::Case& label : selection.cases) begins.insert(label.first);
    check_reach(selection.body, begins);
    for (std::size_t n = 1; n < selection.cases.size(); ++n) {
      const ir::Case& label = selection.cases[n];
      const bool empty_before = label.first == selection.cases[n - 1].first;
      if (empty_before || label.first == 0 || leaves(*selection.body[label.first - 1]) || std::holds_alternative<ir::Stop>(selection.body[label.first - 1]->node)) continue;
      diagnostics_.warning("PM7012", label.span, "the case above goes on into this one; end it with break");
    }
  }

  void check_if(const ir::If& branch) {
    for (const ir::IfBranch& way : branch.branches) {
      check_condition(*way.condition);
      const auto* block = std::get_if<ir::Block>(&way.body->node);
      if (block && block->body.empty() && way.body->span.end <= way.body->span.begin + 1) diagnostics_.warning("PM7022", way.body->span.valid() ? way.body->span : way.condition->span, "a ; is all that this condition decides about");
    }
  }

  void check_condition(const ir::Expr& condition) {
    const auto* binary = std::get_if<ir::Binary>(&condition.node);
    const bool logical = binary && (binary->op == Operator::kAnd || binary->op == Operator::kOr);
    if (logical) {
      check_condition(*binary->left);
      return check_condition(*binary->right);
    }
    if (has_macro(condition)) return;
    const bool compares_constants = binary && ir::is_comparison(binary->op) && ir::constant_value(*binary->left) && ir::constant_value(*binary->right);
    const bool compares_itself = binary && ir::is_comparison(binary->op) && same_variable(*binary->left, *binary->right);
    if (compares_itself) diagnostics_.warning("PM7013", condition.span, "this compares a variable with itself");
    else if (compares_constants || ir::constant_value(condition)) diagnostics_.warning("PM7013", condition.span, "this condition is always the same");
  }

  void check_assignment(const ir::Assign& assign, const source::Span& span) {
    const bool itself = assign.op == bytecode::AssignOp::kSet && assign.values.size() == 1 && same_variable(*assign.target, *assign.values[0]);
    if (itself && !has_macro(*assign.target) && !has_macro(*assign.values[0])) diagnostics_.warning("PM7014", span, "this assigns a variable to itself");
  }

  /// Labels of programs and PLCs; those of subprograms are entries for call 100.05.
  void check_labels() {
    if (buffer_.kind != bytecode::ProgramKind::kPlc && buffer_.kind != bytecode::ProgramKind::kProg) return;
    std::set<std::int64_t> wanted;
    bool computed = false;
    std::vector<std::pair<std::int64_t, source::Span>> labels;
    ir::walk(buffer_.body, {[&](const ir::Stmt& statement) {
                              if (const auto* label = std::get_if<ir::Label>(&statement.node)) labels.emplace_back(label->number, statement.span);
                              const auto* jump = std::get_if<ir::Jump>(&statement.node);
                              if (!jump || !jump->label) return;
                              if (const auto value = ir::constant_value(*jump->label)) wanted.insert(static_cast<std::int64_t>(*value));
                              else computed = true;
                            },
                            {}});
    for (const auto& [number, span] : labels)
      if (!computed && !wanted.contains(number)) diagnostics_.warning("PM7010", span, fmt::format("nothing jumps to label N{}", number));
  }

  const ir::Buffer& buffer_;
  source::Diagnostics& diagnostics_;
};

}  // namespace

void lint_flow(const ir::Buffer& buffer, source::Diagnostics& diagnostics) { FlowLint(buffer, diagnostics).run(); }

}  // namespace pmac::compiler::sema
