// What a coordinate system tells of its moves when they end, and the synchronous assignments that wait for the times of moves.
#include <fmt/format.h>

#include "compiler/bytecode/element.h"
#include "runtime/motion/governing.h"
#include "runtime/state.h"

namespace pmac::runtime {

using bytecode::ElementId;

void CoordSystem::record(const MoveRecord& move) {
  if (machine_.options.observers.move) machine_.options.observers.move(move);
}

void CoordSystem::collect_timings() {
  timings_.clear();
  pipeline_.take_timings(timings_);
  sync_times_.clear();
  pipeline_.take_sync_times(sync_times_);
  if (sync_.empty()) due_.clear();
  else due_.insert(due_.end(), sync_times_.begin(), sync_times_.end());
  for (const motion::MoveTiming& timing : timings_) {
    while (!pending_moves_.empty() && pending_moves_.front().id <= timing.id) {
      const PendingMove& move = pending_moves_.front();
      if (move.id == timing.id) executed_.push_back({timing, move.mode, move.source});
      pending_moves_.pop_front();
    }
  }
}

void CoordSystem::record_executed(double time_ms) {
  for (; !executed_.empty(); executed_.pop_front()) {
    const auto& [timing, mode, source] = executed_.front();
    const double end_ms = time_base_.time_at(timing.end_ms);
    if (end_ms > time_ms) return;
    record({mode, source, number_, -1, time_base_.time_at(timing.start_ms), end_ms, timing.length_uu, motion::time_rule_name(timing.rule),
            timing.governed});
  }
}

void CoordSystem::report_unfinished(double time_ms, bool go_on) {
  record_executed(time_ms);
  const auto report = [&](MoveRecord move) {
    const bool known = go_on && move.end_ms < kNever;
    if (!known) move.end_ms = time_ms;
    if (move.start_ms < time_ms || known) record(move);
  };
  for (; !executed_.empty(); executed_.pop_front()) {
    const auto& [timing, mode, source] = executed_.front();
    report({mode, source, number_, -1, time_base_.time_at(timing.start_ms), time_base_.time_at(timing.end_ms), timing.length_uu,
            motion::time_rule_name(timing.rule), timing.governed});
  }
  if (rapid_open_) report({"rapid", rapid_.source, number_, -1, rapid_start_ms_, motors_end_ms(), rapid_length_uu_});
  rapid_open_ = false;
}

void CoordSystem::perform_due(double time_ms) {
  while (!due_.empty() && time_base_.time_at(due_.front().time_ms) <= time_ms) {
    perform_up_to(due_.front().id);
    if (!due_.empty()) due_.pop_front();
  }
}

void CoordSystem::perform_up_to(std::uint64_t move_id) {
  while (!sync_.empty() && sync_.front().move_id <= move_id) {
    const SyncEntry entry = sync_.front();
    sync_.pop_front();
    machine_.perform(entry, *this);
  }
}

Flow CoordSystem::queue_assignment(Thread& thread, const bytecode::SyncTarget& target, const ElementAddress& element, double value) {
  const double capacity = machine_.elements.get(ElementId::kCoordSyncOps, static_cast<unsigned>(number_));
  if (static_cast<double>(sync_.size()) >= capacity)
    return give_up(thread, {FaultKind::kSyncBuffer, thread.source(),
                            fmt::format("more than Coord[{}].SyncOps = {} synchronous assignments wait", number_, capacity)});
  sync_.push_back({target, element, value, next_id_, thread.source()});
  return Flow::kContinue;
}

}  // namespace pmac::runtime
