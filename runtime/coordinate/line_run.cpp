// A run of plain move lines (rows of bytecode::MoveRun) while nothing else happens: what the interpreter, the move block and the stages of a
// motion command do for each of them comes down to the target, which goes straight to the path (motion/line_path.h). Part of a free run
// (free_run.h); what comes out of a run is the same with and without.
#include <algorithm>
#include <cmath>

#include "compiler/bytecode/element.h"
#include "runtime/motion/governing.h"
#include "runtime/motion/line_path.h"
#include "runtime/state.h"

namespace pmac::runtime {
namespace {

using bytecode::ElementId;

/// Instructions of a row after which the program waits, and of one after which it goes on: row.words, block.end, row.loop.
constexpr std::uint64_t kOfLastRow = 2, kOfRow = 3;
/// Runs that end after fewer rows are not worth it; then so many events go by before the next one is tried.
constexpr std::size_t kFewRows = 8;
constexpr int kEventsBetween = 16;
/// Rows of one event: far from what a pass may take.
constexpr double kMostRowsAtOnce = 1000;

bool rolls_over(const ElementStore& elements, unsigned cs) {
  for (unsigned i = 0; i < 6; ++i)
    if (elements.get(ElementId::kCoordPosRollOver, cs, i) != 0) return true;
  return false;
}

}  // namespace

/// All that a plain line can meet in this coordinate system is its way to the path.
bool CoordSystem::lines_are_plain() const {
  const ElementStore& e = machine_.elements;
  const auto cs = static_cast<unsigned>(number_);
  const bool nobody_acts = sync_.empty() && due_.empty() && !held_back_ && !stop_requested_ && !pause_requested_ && !pause_at_rest_ && !stepping_ && block_.empty();
  const bool no_stage_between = frame_.is_plain() && modal.compensation_side == 0 && !compensation_.active() && spline_.empty() && !pvt_goes_on_;
  const bool element_rules = e.get(ElementId::kCoordNoBlend, cs) == 0 && e.get(ElementId::kCoordOnceNoBlend, cs) == 0 && !waits_in_position() && !rolls_over(e, cs);
  return nobody_acts && no_stage_between && element_rules && modal.mode == bytecode::MoveMode::kLinear && !machine_.options.observers.motion_command &&
         !has_position_limits();
}

/// The program stands before a row, and its lines can go the short way from here on.
bool CoordSystem::begin_lines() {
  if (lines_wait_ > 0) return --lines_wait_, false;
  const auto place = runner_.thread.at_row();
  if (!place || !runs_along() || !lines_are_plain()) return false;
  motion::LinePath* path = pipeline_.open_lines(block_command(modal, {}, program_uu_, machine_.elements, number_, runner_.thread.source()));
  const bool stands_there = path && calculated_uu_ == program_uu_ && path->shortest_ms() * kMostRowsAtOnce > 2 * machine_.rti_period_ms() + 1;
  if (path && !stands_there) pipeline_.close_lines();
  if (!stands_there) lines_wait_ = kEventsBetween;
  if (stands_there) {
    lines_.path = path;
    lines_.run = place->run;
    lines_.row = lines_.first_row = place->row;
    lines_.mode = move_mode_name(modal.mode);
  }
  return stands_there;
}

/// What the lines have changed of what the program and the coordinate system remember.
void CoordSystem::end_lines() {
  pipeline_.close_lines();
  calculated_uu_ = pipeline_.calculated_position();
  program_uu_ = placed_uu_ = calculated_uu_;
  runner_.thread.stand_at_row(lines_.row);
  for (; !lines_.ended.empty(); lines_.ended.pop_front()) {
    const LineRun::Ended& e = lines_.ended.front();
    executed_.push_back({{e.id, e.start_ms, e.start_ms, e.end_ms, e.length_uu, e.rule}, lines_.mode, e.source});
  }
}

/// As service() and calculate() while the program comes to rows. False: the event has not come to its end, and the rest is service()'s.
bool CoordSystem::service_lines(double time_ms) {
  record_lines(time_ms);
  calculated_at_ms_ = time_ms;
  pipeline_.prune();
  const double next_ms = machine_.next_rti_ms(time_ms);
  for (bool enough = false; !enough;) {
    if (!add_row()) {
      lines_wait_ = lines_.row < lines_.first_row + kFewRows ? kEventsBetween : 1;
      return false;
    }
    enough = lines_.path->horizon_ms() >= next_ms && lines_.path->known_until_ms() > time_ms;   // as enough_ahead()
    machine_.instructions += enough ? kOfLastRow : kOfRow;
  }
  moves_without_time_ = 0;
  const double in_time_ms = machine_.next_rti_ms(lines_.path->horizon_ms()) - 1.5 * machine_.rti_period_ms();   // as next_calculation_ms()
  const double until_ms = std::min(lines_.path->known_until_ms(), in_time_ms);
  resume_ms_ = until_ms <= next_ms ? next_ms : machine_.rti_at_or_after_ms(until_ms);
  return true;
}

/// As record_executed(): those that have ended before the lines began come first.
void CoordSystem::record_lines(double time_ms) {
  record_executed(time_ms);
  for (; executed_.empty() && !lines_.ended.empty() && lines_.ended.front().end_ms <= time_ms; lines_.ended.pop_front()) {
    const LineRun::Ended& e = lines_.ended.front();
    record({lines_.mode, e.source, number_, -1, e.start_ms, e.end_ms, e.length_uu, motion::time_rule_name(e.rule)});
  }
}

/// As collect_timings().
void CoordSystem::collect_lines() {
  for (const motion::LinePath::Ended& e : lines_.path->ended()) {
    while (!pending_moves_.empty() && pending_moves_.front().id <= e.id) {
      const PendingMove& move = pending_moves_.front();
      if (move.id == e.id) lines_.ended.push_back({e.id, e.start_ms, e.end_ms, e.length_uu, e.rule, move.source});
      pending_moves_.pop_front();
    }
  }
  lines_.path->ended().clear();
}

/// The next row but the last, which the interpreter has to leave.
bool CoordSystem::add_row() {
  const bytecode::MoveRun& run = *lines_.run;
  motion::LinePath& path = *lines_.path;
  const std::size_t row = lines_.row;
  if (row + 1 >= run.row_count()) return false;
  const motion::LinePath::Point start = path.end();
  motion::LinePath::Point target = start;
  for (std::size_t i = run.first_word[row]; i < run.first_word[row + 1]; ++i) {
    const int axis = bytecode::move_word_index(run.words[i]), entry = path.entry_of(axis);
    if (bytecode::move_word_kind(run.words[i]) != bytecode::WordKind::kTarget || entry < 0) return false;
    const auto at = static_cast<std::size_t>(entry);
    target[at] = modal.absolute_axes >> axis & 1u ? run.values[i] : start[at] + run.values[i];
  }
  const bytecode::SourceLine source = run.source(row);
  if (!path.add(target, next_id_, source)) return false;
  PendingMove& move = pending_moves_.extend();
  move = {next_id_++, lines_.mode, source};
  ++lines_.row;
  collect_lines();
  return true;
}

}  // namespace pmac::runtime
