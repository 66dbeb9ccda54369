// What has no effect, or another one than it seems, on motion.
#include <fmt/format.h>

#include <algorithm>

#include "compiler/bytecode/element.h"
#include "compiler/ir/walk.h"
#include "compiler/sema/lint/lint.h"

namespace pmac::compiler::sema {
namespace {

using bytecode::ProgramKind;

template <class... Nodes>
bool is_one_of(const ir::Stmt& statement) { return (std::holds_alternative<Nodes>(statement.node) || ...); }

/// Something that starts a motion, or leads to statements that may.
bool may_move(const ir::Stmt& statement) {
  return is_one_of<ir::Move, ir::MoveRows, ir::Dwell, ir::Delay, ir::Call, ir::Jump, ir::CodeLine, ir::LineCondition, ir::Cycle, ir::Control, ir::Label>(statement);
}

bool is_synchronous(const ir::Stmt& statement) {
  const auto* assign = std::get_if<ir::Assign>(&statement.node);
  return assign && assign->synchronous;
}

bool is_circle(const ir::SetMode& mode) { return mode.mode >= ir::MoveMode::kCircle1 && mode.mode <= ir::MoveMode::kCircle4; }

/// Neither waits nor synchronous assignments do in a PLC what they do in a motion program.
void lint_plc(const ir::Buffer& buffer, source::Diagnostics& diagnostics) {
  ir::walk(buffer.body, {[&](const ir::Stmt& statement) {
                           if (is_one_of<ir::Dwell, ir::Delay>(statement))
                             diagnostics.warning("PM7004", statement.span, fmt::format("{} does not wait in a PLC program; wait with a loop: while (...) {{}}", std::holds_alternative<ir::Dwell>(statement.node) ? "dwell" : "delay"));
                           if (is_synchronous(statement)) diagnostics.warning("PM7005", statement.span, "== waits for the next move of a motion program; in a PLC program it is a plain assignment, written =");
                         },
                         {}});
}

/// A synchronous assignment at the end of a program, with nothing behind it that it could wait for. Behind a label it may belong to
/// a routine that returns to moves.
void lint_last_assignments(const ir::Buffer& buffer, source::Diagnostics& diagnostics) {
  const auto last = std::find_if(buffer.body.rbegin(), buffer.body.rend(), [](const ir::StmtPtr& statement) {
    bool found = may_move(*statement);
    ir::walk(*statement, {[&](const ir::Stmt& inner) { found = found || may_move(inner); }, {}});
    return found;
  });
  if (last != buffer.body.rend() && std::holds_alternative<ir::Label>((*last)->node)) return;
  for (auto at = last.base(); at != buffer.body.end(); ++at) {
    if (!is_synchronous(**at)) continue;
    diagnostics.warning("PM7019", (*at)->span, "no move, dwell or delay follows, so this assignment is never done; write = or put dwell 0 behind it");
  }
}

/// An output that is set by = behind a move: it changes when the line is calculated, before the move is done.
void lint_early_output(const ir::Body& body, source::Diagnostics& diagnostics) {
  bool moving = false;
  for (const ir::StmtPtr& statement : body) {
    if (is_one_of<ir::Move, ir::MoveRows>(*statement)) moving = true;
    if (std::holds_alternative<ir::Dwell>(statement->node)) moving = false;
    const auto* assign = std::get_if<ir::Assign>(&statement->node);
    const auto* target = assign ? std::get_if<ir::Variable>(&assign->target->node) : nullptr;
    if (!moving || !target || assign->synchronous || target->variable_class != ir::VariableClass::kM) continue;
    diagnostics.warning("PM7006", statement->span, "this is assigned when the line is calculated, which is before the moves above are done; == assigns at the beginning of the next move");
  }
}

void lint_first_move(const ir::Buffer& buffer, source::Diagnostics& diagnostics) {
  for (const ir::StmtPtr& statement : buffer.body) {
    if (is_one_of<ir::Move, ir::MoveRows>(*statement))
      diagnostics.warning("PM7016", statement->span, "no move mode is set before this move; it is the one that the last program left");
    const bool decides = !is_one_of<ir::Assign, ir::SetParameter, ir::SetAbsInc, ir::SetFrax, ir::SetNormal, ir::Locals, ir::Globals, ir::Dwell, ir::Delay>(*statement);
    if (decides) return;
  }
}

bool names_element(const ir::Expr& expr, std::string_view name) {
  const auto* element = std::get_if<ir::Element>(&expr.node);
  return element && element->element != bytecode::kNoElement && bytecode::element_info(element->element).name == name;
}

}  // namespace

void lint_motion(const ir::Buffer& buffer, source::Diagnostics& diagnostics) {
  if (buffer.kind == ProgramKind::kPlc) return lint_plc(buffer, diagnostics);
  if (buffer.kind != ProgramKind::kProg) return;
  lint_last_assignments(buffer, diagnostics);
  lint_early_output(buffer.body, diagnostics);
  lint_first_move(buffer, diagnostics);
}

void lint_circles(const std::vector<ir::Unit>& units, const Project& project, source::Diagnostics& diagnostics) {
  if (!project.has_axis_definitions) return;
  const ir::Stmt* circle = nullptr;
  bool segmented = false;
  const auto see_mode = [&](const ir::Stmt& statement) {
    const auto* mode = std::get_if<ir::SetMode>(&statement.node);
    if (!circle && mode && is_circle(*mode)) circle = &statement;
  };
  const auto see_element = [&](const ir::Expr& expr, ir::Use use) { segmented = segmented || (use == ir::Use::kWrite && names_element(expr, "Coord[].SegMoveTime")); };
  for (const ir::Unit& unit : units) {
    ir::walk(unit.load, {{}, see_element});
    for (const ir::Buffer& buffer : unit.buffers) ir::walk(buffer.body, {see_mode, see_element});
  }
  if (circle && !segmented) diagnostics.warning("PM7015", circle->span, "without segmentation circles are run as straight lines; assign Coord[x].SegMoveTime in the set-up");
}

}  // namespace pmac::compiler::sema
