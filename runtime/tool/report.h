// What a run tells at its end: the JSON object and the statistics for people.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "runtime/machine.h"
#include "runtime/servo/limit_check.h"
#include "runtime/servo/servo.h"
#include "runtime/tool/drive_run.h"
#include "runtime/tool/options.h"

namespace pmac::tool {

/// Collects what the machine reports while it runs.
class Report {
 public:
  /// keep_moves: false where nobody will read them, so that memory stays flat.
  explicit Report(bool keep_moves) : keep_moves_(keep_moves) {}

  void add(const runtime::MoveRecord& move);
  void add(const runtime::OutputChange& change) { if (keep_moves_) outputs_.push_back(change); }
  void add(const runtime::FaultRecord& fault) { faults_.push_back(fault); }
  void add(const runtime::JerkJoin& join);
  /// Of --check-limits, when the run is over.
  void add_limits(std::vector<runtime::LimitCheck::Row> rows) { limits_ = std::move(rows); }
  /// Of --drive, when the run is over. Kept by reference.
  void add_drive(const DriveRun& drive) { drive_ = &drive; }
  /// True for the first one of its kind; the others are counted. Beyond kMostRefusals kinds they are counted together.
  bool add_refusal(const std::string& command, const std::string& reason);

  /// Moves in order of their start. The object of --json; see docs/pmac-run.md for its keys.
  std::string json(const runtime::Machine& machine, const runtime::RunOutcome& outcome, const runtime::MotionStatistics& statistics,
                   JsonDetail detail) const;
  /// The lines of --stats.
  std::string text(const runtime::Machine& machine, const runtime::RunOutcome& outcome, const runtime::MotionStatistics& statistics,
                   double wall_s) const;
  /// A line for every refusal that came again, with its count.
  std::string repeated_refusals() const;
  /// Every move with what governed it, a line each; the first ones where there are many.
  std::string move_log(const runtime::Machine& machine) const;
  /// The log of output changes, a line each.
  std::string output_log(const runtime::Machine& machine) const;
  /// Commands that were refused, other than those of the console, which are answered there.
  bool any_refused() const { return !refusals_.empty(); }
  std::size_t move_count() const { return move_count_; }

 private:
  bool keep_moves_;
  std::size_t move_count_ = 0;
  std::vector<runtime::MoveRecord> moves_;
  std::vector<runtime::OutputChange> outputs_;
  std::vector<runtime::FaultRecord> faults_;
  static constexpr std::size_t kMostJoins = 1000;   // kept; the others are counted
  std::size_t join_count_ = 0;
  std::vector<runtime::JerkJoin> joins_;
  static constexpr std::size_t kMostRefusals = 1000;
  struct Refusal { std::string command, reason; std::size_t count = 1; };
  std::vector<Refusal> refusals_;                                              // in order of their first time
  std::map<std::pair<std::string, std::string>, std::size_t> refusal_index_;   // by command and reason, into refusals_
  std::size_t more_refusals_ = 0;                                              // beyond kMostRefusals
  std::vector<runtime::LimitCheck::Row> limits_;
  const DriveRun* drive_ = nullptr;
};

/// "idle", "until", "fault", "time-limit" or "budget".
std::string status_name(const runtime::Machine& machine, const runtime::RunOutcome& outcome);

}  // namespace pmac::tool
