#include "compiler/sema/lint/loops.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "compiler/bytecode/control.h"
#include "compiler/ir/walk.h"

namespace pmac::compiler::sema {
namespace {

using bytecode::ControlVerb;

template <class... Nodes>
bool is_one_of(const ir::Stmt& statement) { return (std::holds_alternative<Nodes>(statement.node) || ...); }

/// The label that the statement goes to in any case, where that is constant.
std::optional<std::int64_t> goto_label(const ir::Stmt& statement) {
  if (const auto* block = std::get_if<ir::Block>(&statement.node)) return block->body.empty() ? std::nullopt : goto_label(*block->body.back());
  const auto* jump = std::get_if<ir::Jump>(&statement.node);
  if (!jump || jump->kind != ir::JumpKind::kGoto || !jump->label) return std::nullopt;
  const auto label = ir::constant_value(*jump->label);
  return label ? std::optional(static_cast<std::int64_t>(*label)) : std::nullopt;
}

/// Jogs and homes touch motors alone; the other verbs may end the program that the loop stands in.
bool only_moves_motors(const ir::Stmt& statement) {
  const auto* control = std::get_if<ir::Control>(&statement.node);
  return control && control->verb >= ControlVerb::kJogPlus && control->verb <= ControlVerb::kOpenLoop;
}

class Loops {
 public:
  explicit Loops(const std::function<void(const Loop&)>& visit) : visit_(visit) {}

  void body(const ir::Body& statements) {
    std::map<std::int64_t, std::size_t> labels;
    for (std::size_t i = 0; i < statements.size(); ++i) {
      const ir::Stmt& statement = *statements[i];
      if (const auto* label = std::get_if<ir::Label>(&statement.node)) labels[label->number] = i;
      look_for_goto(statements, i, labels);
      inside(statement);
    }
  }

 private:
  void look_for_goto(const ir::Body& statements, std::size_t at, const std::map<std::int64_t, std::size_t>& labels) {
    const auto* branch = std::get_if<ir::If>(&statements[at]->node);
    const bool simple = branch && branch->branches.size() == 1 && !branch->otherwise;
    const ir::Stmt& jump = simple ? *branch->branches[0].body : *statements[at];
    const auto number = goto_label(jump);
    if (!number) return;
    const auto label = labels.find(*number);
    if (label == labels.end()) return;
    Loop loop{simple ? branch->branches[0].condition.get() : nullptr, {}, simple ? branch->branches[0].condition->span : jump.span, {*number}};
    for (std::size_t i = label->second + 1; i < at; ++i) loop.body.push_back(statements[i].get());
    loop.body.push_back(&jump);
    visit_(loop);
  }

  void inside(const ir::Stmt& statement) {
    if (const auto* block = std::get_if<ir::Block>(&statement.node)) body(block->body);
    else if (const auto* selection = std::get_if<ir::Switch>(&statement.node)) body(selection->body);
    else if (const auto* line = std::get_if<ir::LineCondition>(&statement.node)) body(line->rest);
    else if (const auto* loop = std::get_if<ir::While>(&statement.node)) loop_of(*loop->condition, *loop->body);
    else if (const auto* repeat = std::get_if<ir::DoWhile>(&statement.node)) loop_of(*repeat->condition, *repeat->body);
    else if (const auto* branch = std::get_if<ir::If>(&statement.node)) {
      for (const ir::IfBranch& way : branch->branches) inside(*way.body);
      if (branch->otherwise) inside(*branch->otherwise);
    }
  }

  void loop_of(const ir::Expr& condition, const ir::Stmt& statement) {
    visit_({&condition, {&statement}, condition.span, {}});
    inside(statement);
  }

  const std::function<void(const Loop&)>& visit_;
};

/// own_break: a break that is found here belongs to the loop.
class WayOut {
 public:
  explicit WayOut(const Loop& loop) : loop_(loop) {}

  bool in(const ir::Stmt& statement, bool own_break) const {
    if (is_one_of<ir::Break>(statement)) return own_break;
    if (is_one_of<ir::Return, ir::Stop, ir::Call, ir::CodeLine, ir::Cycle, ir::Command>(statement)) return true;
    if (const auto* control = std::get_if<ir::Control>(&statement.node)) return control->verb != ControlVerb::kSendAllCommands && !only_moves_motors(statement);
    if (std::holds_alternative<ir::Jump>(statement.node)) return !goes_on(statement);
    if (const auto* block = std::get_if<ir::Block>(&statement.node)) return in(block->body, own_break);
    if (const auto* line = std::get_if<ir::LineCondition>(&statement.node)) return in(line->rest, own_break);
    if (const auto* selection = std::get_if<ir::Switch>(&statement.node)) return in(selection->body, false);
    if (const auto* loop = std::get_if<ir::While>(&statement.node)) return in(*loop->body, false);
    if (const auto* repeat = std::get_if<ir::DoWhile>(&statement.node)) return in(*repeat->body, false);
    const auto* branch = std::get_if<ir::If>(&statement.node);
    if (!branch) return false;
    const bool in_branch = std::any_of(branch->branches.begin(), branch->branches.end(), [&](const ir::IfBranch& way) { return in(*way.body, own_break); });
    return in_branch || (branch->otherwise && in(*branch->otherwise, own_break));
  }

 private:
  bool in(const ir::Body& body, bool own_break) const {
    return std::any_of(body.begin(), body.end(), [&](const ir::StmtPtr& statement) { return in(*statement, own_break); });
  }

  bool goes_on(const ir::Stmt& statement) const {
    const auto label = goto_label(statement);
    return label && std::find(loop_.labels.begin(), loop_.labels.end(), *label) != loop_.labels.end();
  }

  const Loop& loop_;
};

}  // namespace

void for_each_loop(const ir::Body& body, const std::function<void(const Loop&)>& visit) { Loops(visit).body(body); }

bool has_way_out(const Loop& loop) {
  const bool own_break = loop.labels.empty();  // a break between label and goto leaves the while or switch around them
  return std::any_of(loop.body.begin(), loop.body.end(), [&](const ir::Stmt* statement) { return WayOut(loop).in(*statement, own_break) || (!own_break && WayOut(loop).in(*statement, true)); });
}

bool may_take_time(const Loop& loop) {
  bool takes_time = false;
  const auto look = [&](const ir::Stmt& statement) { takes_time = takes_time || is_one_of<ir::Move, ir::MoveRows, ir::Dwell, ir::Delay, ir::Call, ir::Jump, ir::CodeLine, ir::Cycle, ir::Control, ir::Command>(statement); };
  for (const ir::Stmt* statement : loop.body) {
    if (goto_label(*statement) && statement == loop.body.back() && !loop.labels.empty()) continue;
    ir::walk(*statement, {look, {}});
  }
  return takes_time;
}

}  // namespace pmac::compiler::sema
