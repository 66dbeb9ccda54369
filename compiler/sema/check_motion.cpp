// What is wrong with moves before they run: circles without a centre, negative feed rates, axes that no motor serves.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "compiler/sema/sema.h"

namespace pmac::compiler::sema {
namespace {

using ir::MoveMode;
using ir::WordKind;

constexpr int kX = 6, kZ = 8, kXX = 29, kZZ = 31;

/// Follows the move mode through the statements, as far as it is certain: nullopt where it depends on the way taken.
class MotionCheck {
 public:
  explicit MotionCheck(source::Diagnostics& diagnostics) : diagnostics_(diagnostics) {}

  void run(const ir::Body& body) {
    for (const ir::StmtPtr& statement : body) run(*statement);
  }

 private:
  using Mode = std::optional<MoveMode>;

  void run(const ir::Stmt& statement) {
    if (const auto* mode = std::get_if<ir::SetMode>(&statement.node)) mode_ = mode->mode;
    else if (const auto* parameter = std::get_if<ir::SetParameter>(&statement.node)) check_parameter(*parameter);
    else if (const auto* move = std::get_if<ir::Move>(&statement.node)) check_move(*move, statement.span);
    else if (const auto* rows = std::get_if<ir::MoveRows>(&statement.node)) check_rows(*rows);
    else if (const auto* block = std::get_if<ir::Block>(&statement.node)) run(block->body);
    else if (const auto* branch = std::get_if<ir::If>(&statement.node)) run_if(*branch);
    else if (const auto* loop = std::get_if<ir::While>(&statement.node)) run_loop(*loop->body);
    else if (const auto* repeat = std::get_if<ir::DoWhile>(&statement.node)) run_loop(*repeat->body);
    else if (const auto* selection = std::get_if<ir::Switch>(&statement.node)) run_switch(*selection);
    else if (const auto* line = std::get_if<ir::LineCondition>(&statement.node)) run_condition(*line);
    else if (sets_mode(statement)) mode_.reset();
  }

  void run_condition(const ir::LineCondition& line) {
    const Mode before = mode_;
    run(line.rest);
    if (mode_ != before) mode_.reset();
  }

  void run_if(const ir::If& branch) {
    const Mode before = mode_;
    Mode after = before;
    bool first = true;
    const auto merge = [&] {
      if (first) after = mode_;
      else if (after != mode_) after.reset();
      first = false;
    };
    for (const ir::IfBranch& way : branch.branches) {
      mode_ = before;
      run(*way.body);
      merge();
    }
    mode_ = before;
    if (branch.otherwise) run(*branch.otherwise);
    merge();
    mode_ = after;
  }

  void run_loop(const ir::Stmt& body) {
    if (sets_mode(body)) mode_.reset();
    run(body);
    if (sets_mode(body)) mode_.reset();
  }

  void run_switch(const ir::Switch& selection) {
    mode_.reset();
    run(selection.body);
    mode_.reset();
  }

  static bool sets_mode(const ir::Stmt& statement) {
    const auto any = [](const ir::Body& body) { return std::any_of(body.begin(), body.end(), [](const ir::StmtPtr& inner) { return sets_mode(*inner); }); };
    if (const auto* block = std::get_if<ir::Block>(&statement.node)) return any(block->body);
    if (const auto* selection = std::get_if<ir::Switch>(&statement.node)) return any(selection->body);
    if (const auto* loop = std::get_if<ir::While>(&statement.node)) return sets_mode(*loop->body);
    if (const auto* repeat = std::get_if<ir::DoWhile>(&statement.node)) return sets_mode(*repeat->body);
    if (const auto* branch = std::get_if<ir::If>(&statement.node)) {
      const bool in_branch = std::any_of(branch->branches.begin(), branch->branches.end(), [](const ir::IfBranch& way) { return sets_mode(*way.body); });
      return in_branch || (branch->otherwise && sets_mode(*branch->otherwise));
    }
    if (const auto* line = std::get_if<ir::LineCondition>(&statement.node)) return any(line->rest);
    return std::holds_alternative<ir::SetMode>(statement.node) || std::holds_alternative<ir::Call>(statement.node) || std::holds_alternative<ir::Jump>(statement.node) ||
           std::holds_alternative<ir::Label>(statement.node) || std::holds_alternative<ir::CodeLine>(statement.node) || std::holds_alternative<ir::Cycle>(statement.node);
  }

  void check_parameter(const ir::SetParameter& parameter) {
    const auto value = ir::constant_value(*parameter.value);
    const bool is_feed = parameter.parameter == ir::MotionParameter::kFeed;
    if (is_feed && value && *value < 0) diagnostics_.error("PM4002", parameter.value->span, fmt::format("the feed rate {} is negative; a feed rate is a magnitude", *value));
  }

  void check_move(const ir::Move& move, const source::Span& span) {
    const bool first_set = mode_ == MoveMode::kCircle1 || mode_ == MoveMode::kCircle2;
    const bool second_set = mode_ == MoveMode::kCircle3 || mode_ == MoveMode::kCircle4;
    const auto has = [&](auto&& accepts) { return std::any_of(move.words.begin(), move.words.end(), accepts); };
    const bool moves_in_plane = has([&](const ir::Word& w) {
      return w.kind == WordKind::kTarget && ((first_set && w.index >= kX && w.index <= kZ) || (second_set && w.index >= kXX && w.index <= kZZ));
    });
    const bool has_centre = has([&](const ir::Word& w) { return w.kind == WordKind::kRadius || (w.kind == WordKind::kCenter && (w.index >= 3) == second_set); });
    if ((first_set || second_set) && moves_in_plane && !has_centre)
      report_missing_centre(span, second_set);
    const bool no_circle = mode_ && !first_set && !second_set;
    for (const ir::Word& word : move.words) {
      const bool circle_word = word.kind == WordKind::kCenter || word.kind == WordKind::kRadius;
      if (no_circle && circle_word) diagnostics_.warning("PM4003", word.span, fmt::format("this circle word does nothing in {} mode", bytecode::move_mode_name(*mode_)));
      if (mode_ && *mode_ != MoveMode::kPvt && word.kind == WordKind::kVelocity) diagnostics_.warning("PM4004", word.span, "an end velocity belongs to pvt mode");
      if (mode_ && *mode_ != MoveMode::kRapid && word.kind == WordKind::kTriggerDistance) diagnostics_.warning("PM4004", word.span, "a move until trigger belongs to rapid mode");
    }
  }

  void report_missing_centre(const source::Span& span, bool second_set) {
    diagnostics_.error("PM4001", span, second_set ? "circle move without a centre; add II and JJ" : "circle move without a centre; add I and J, or R");
  }

  /// As check_move, said once for all rows.
  void check_rows(const ir::MoveRows& rows) {
    const bool first_set = mode_ == MoveMode::kCircle1 || mode_ == MoveMode::kCircle2;
    const bool second_set = mode_ == MoveMode::kCircle3 || mode_ == MoveMode::kCircle4;
    const source::Span& missing = rows.without_centre[second_set ? 1 : 0];
    if ((first_set || second_set) && missing.valid()) report_missing_centre(missing, second_set);
    const bool no_circle = mode_ && !first_set && !second_set;
    if (no_circle && rows.first_centre.valid())
      diagnostics_.warning("PM4003", rows.first_centre, fmt::format("the circle words of this line and of lines behind it do nothing in {} mode", bytecode::move_mode_name(*mode_)));
  }

  source::Diagnostics& diagnostics_;
  Mode mode_;
};

class ServedAxes {
 public:
  ServedAxes(Project& project, source::Diagnostics& diagnostics) : project_(project), diagnostics_(diagnostics) {}

  void run(const ir::Body& body) {
    for (const ir::StmtPtr& statement : body) run(*statement);
  }

 private:
  void run(const ir::Stmt& statement) {
    if (const auto* block = std::get_if<ir::Block>(&statement.node)) run(block->body);
    if (const auto* selection = std::get_if<ir::Switch>(&statement.node)) run(selection->body);
    if (const auto* loop = std::get_if<ir::While>(&statement.node)) run(*loop->body);
    if (const auto* repeat = std::get_if<ir::DoWhile>(&statement.node)) run(*repeat->body);
    if (const auto* branch = std::get_if<ir::If>(&statement.node)) {
      for (const ir::IfBranch& way : branch->branches) run(*way.body);
      if (branch->otherwise) run(*branch->otherwise);
    }
    if (const auto* line = std::get_if<ir::LineCondition>(&statement.node)) run(line->rest);
    if (const auto* rows = std::get_if<ir::MoveRows>(&statement.node))
      for (const ir::MoveRows::AxisUse& use : rows->first_targets) check_axis(use.axis, use.span);
    const auto* move = std::get_if<ir::Move>(&statement.node);
    if (!move) return;
    for (const ir::Word& word : move->words)
      if (word.kind == WordKind::kTarget) check_axis(word.index, word.span);
  }

  void check_axis(int axis, const source::Span& span) {
    const bool unserved = !project_.defined_axes.contains(axis) && project_.reported_axes.insert(axis).second;
    if (unserved) diagnostics_.warning("PM6003", span, fmt::format("no motor is assigned to axis {}; the move will have no effect on it", bytecode::axis_name(axis)));
  }

  Project& project_;
  source::Diagnostics& diagnostics_;
};

}  // namespace

void check_motion(const ir::Body& body, source::Diagnostics& diagnostics) { MotionCheck(diagnostics).run(body); }

void check_served_axes(const std::vector<ir::Unit>& units, Project& project, source::Diagnostics& diagnostics) {
  if (!project.has_axis_definitions || project.uses_inverse_kinematics) return;
  ServedAxes check(project, diagnostics);
  for (const ir::Unit& unit : units)
    for (const ir::Buffer& buffer : unit.buffers) check.run(buffer.body);
}

}  // namespace pmac::compiler::sema
