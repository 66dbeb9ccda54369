#include "runtime/tool/report.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "runtime/tool/limit_report.h"

namespace pmac::tool {
namespace {

using nlohmann::ordered_json;

void put_source(ordered_json& j, const runtime::Machine& machine, bytecode::SourceLine source) {
  const bool known = source.file >= 0 && static_cast<std::size_t>(source.file) < machine.files().size();
  j["file"] = known ? machine.files()[static_cast<std::size_t>(source.file)] : "";
  j["line"] = source.line;
}

ordered_json move_json(const runtime::Machine& machine, const runtime::MoveRecord& move) {
  ordered_json j;
  put_source(j, machine, move.source);
  if (move.coord >= 0) j["coord"] = move.coord;
  else j["motor"] = move.motor;
  j["mode"] = move.mode;
  j["start_s"] = move.start_ms / 1000.0;
  j["end_s"] = move.end_ms / 1000.0;
  j["length"] = move.length;
  if (!move.governed.empty()) j["governed"] = governed_json(move);
  return j;
}

ordered_json fault_json(const runtime::Machine& machine, const runtime::FaultRecord& record) {
  ordered_json j;
  put_source(j, machine, record.fault.source);
  if (record.coord >= 0) j["coord"] = record.coord;
  if (record.plc >= 0) j["plc"] = record.plc;
  if (record.motor >= 0) j["motor"] = record.motor;
  j["time_s"] = record.time_ms / 1000.0;
  j["error_status"] = runtime::error_status(record.fault.kind);
  j["text"] = record.fault.detail;
  return j;
}

ordered_json refusal_json(const std::string& command, const std::string& reason, std::size_t count) {
  ordered_json j{{"command", command}, {"text", reason}};
  if (count > 1) j["count"] = count;
  return j;
}

/// The object "drive": figures by name, and what happened.
ordered_json drive_json(const DriveRun& drive) {
  if (!drive.execution()) return {{"refused", drive.refusal()}};
  const drives::Execution& execution = *drive.execution();
  ordered_json j{{"time_s", execution.time_s}, {"axes", execution.axes}};
  for (const drives::Figure& figure : execution.figures) {
    const bool is_whole = figure.value == std::floor(figure.value) && std::abs(figure.value) < 1e15;
    j[figure.name] = is_whole ? ordered_json(static_cast<std::int64_t>(figure.value)) : ordered_json(figure.value);
  }
  j["events"] = ordered_json::array();
  for (const drives::DriveEvent& event : execution.events)
    j["events"].push_back({{"time_s", event.time_s}, {"error", event.is_error}, {"text", event.text}});
  return j;
}

}  // namespace

bool Report::add_refusal(const std::string& command, const std::string& reason) {
  const auto known = refusal_index_.find({command, reason});
  if (known != refusal_index_.end()) {
    ++refusals_[known->second].count;
    return false;
  }
  if (refusals_.size() == kMostRefusals) {
    ++more_refusals_;
    return false;
  }
  refusal_index_.emplace(std::pair(command, reason), refusals_.size());
  refusals_.push_back({command, reason});
  return true;
}

std::string Report::repeated_refusals() const {
  std::string out;
  for (const Refusal& refusal : refusals_)
    if (refusal.count > 1) out += fmt::format("refused {} times in all: {}: {}\n", refusal.count, refusal.command, refusal.reason);
  if (more_refusals_ > 0) out += fmt::format("refused {} more times, for other commands or reasons\n", more_refusals_);
  return out;
}

void Report::add(const runtime::MoveRecord& move) {
  ++move_count_;
  if (keep_moves_) moves_.push_back(move);
}

void Report::add(const runtime::JerkJoin& join) {
  if (++join_count_ <= kMostJoins) joins_.push_back(join);
}

std::string status_name(const runtime::Machine& machine, const runtime::RunOutcome& outcome) {
  switch (outcome.end) {
    case runtime::RunEnd::kTimeLimit: return "time-limit";
    case runtime::RunEnd::kBudget: return "budget";
    case runtime::RunEnd::kInterrupted: return "interrupted";
    case runtime::RunEnd::kIdle:
    case runtime::RunEnd::kUntil: break;
  }
  if (machine.any_fault()) return "fault";
  return outcome.end == runtime::RunEnd::kUntil ? "until" : "idle";
}

std::string Report::json(const runtime::Machine& machine, const runtime::RunOutcome& outcome,
                         const runtime::MotionStatistics& statistics, JsonDetail detail) const {
  ordered_json j;
  j["status"] = status_name(machine, outcome);
  j["time_s"] = outcome.time_ms / 1000.0;
  if (detail == JsonDetail::kMoves) {
    std::vector<runtime::MoveRecord> ordered = moves_;
    std::stable_sort(ordered.begin(), ordered.end(), [](const auto& a, const auto& b) { return a.start_ms < b.start_ms; });
    j["moves"] = ordered_json::array();
    for (const auto& move : ordered) j["moves"].push_back(move_json(machine, move));
  }
  j["motors"] = ordered_json::object();
  for (const auto& row : statistics.rows())
    j["motors"][std::to_string(row.motor)] = {{"final", row.final_mu}, {"max_speed", row.max_speed_mu_ms}, {"max_accel", row.max_accel_mu_ms2}};
  if (drive_ != nullptr && drive_->active()) j["drive"] = drive_json(*drive_);
  if (!limits_.empty()) j["limits"] = limit_json(machine, limits_);
  if (detail == JsonDetail::kMoves) {
    j["outputs"] = ordered_json::array();
    for (const auto& change : outputs_) {
      ordered_json o{{"time_s", change.time_ms / 1000.0}, {"name", change.name}, {"value", change.value}};
      put_source(o, machine, change.source);
      j["outputs"].push_back(o);
    }
  }
  j["faults"] = ordered_json::array();
  for (const auto& fault : faults_) j["faults"].push_back(fault_json(machine, fault));
  if (join_count_ > 0) {
    j["jerk_joins"] = ordered_json::array();
    for (const auto& join : joins_) {
      ordered_json o{{"time_s", join.time_ms / 1000.0}, {"coord", join.coord}, {"ratio", join.ratio}};
      put_source(o, machine, join.source);
      j["jerk_joins"].push_back(o);
    }
    j["jerk_join_count"] = join_count_;
  }
  j["refused"] = ordered_json::array();
  for (const Refusal& refusal : refusals_) j["refused"].push_back(refusal_json(refusal.command, refusal.reason, refusal.count));
  if (more_refusals_ > 0) j["refused"].push_back(refusal_json("", "others", more_refusals_));
  return j.dump(1, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

std::string Report::text(const runtime::Machine& machine, const runtime::RunOutcome& outcome,
                         const runtime::MotionStatistics& statistics, double wall_s) const {
  std::string out = fmt::format("{} after {:.6f} s simulated: {} moves, {} servo cycles, {} instructions", status_name(machine, outcome),
                                outcome.time_ms / 1000.0, move_count_, outcome.ticks, outcome.instructions);
  if (wall_s > 0) out += fmt::format("; {:.0f} times real time", outcome.time_ms / 1000.0 / wall_s);
  out += "\nmotor        final mu          min mu          max mu   max mu/ms     at s  max mu/ms^2     at s\n";
  for (const auto& r : statistics.rows())
    out += fmt::format("{:>5} {:>15.6g} {:>15.6g} {:>15.6g} {:>11.6g} {:>8.4f} {:>12.6g} {:>8.4f}\n", r.motor, r.final_mu, r.min_mu, r.max_mu,
                       r.max_speed_mu_ms, r.max_speed_at_ms / 1000.0, r.max_accel_mu_ms2, r.max_accel_at_ms / 1000.0);
  if (join_count_ > 0) out += fmt::format("{} joins at which the acceleration of the path itself steps, and the jerk is not limited:\n", join_count_);
  for (const auto& join : joins_)
    out += fmt::format("{:>12.6f} s  {}: {:.3g} times the limit of the jerk\n", join.time_ms / 1000.0, machine.place(join.source), join.ratio);
  return out;
}

std::string Report::move_log(const runtime::Machine& machine) const {
  constexpr std::size_t kShown = 1000;
  std::vector<runtime::MoveRecord> ordered = moves_;
  std::stable_sort(ordered.begin(), ordered.end(), [](const auto& a, const auto& b) { return a.start_ms < b.start_ms; });
  std::string out = ordered.empty() ? "" : "move               from s        to s  governed by\n";
  for (std::size_t i = 0; i < std::min(ordered.size(), kShown); ++i)
    out += fmt::format("{:<12} {:>12.6f} {:>11.6f}  {}  ({})\n", ordered[i].mode, ordered[i].start_ms / 1000, ordered[i].end_ms / 1000,
                       governed_text(ordered[i]), machine.place(ordered[i].source));
  if (ordered.size() > kShown) out += fmt::format("and {} more moves; --stats --json tells all of them\n", ordered.size() - kShown);
  return out;
}

std::string Report::output_log(const runtime::Machine& machine) const {
  std::string out;
  for (const auto& change : outputs_)
    out += fmt::format("{:>12.6f} s  {} = {:g}  ({})\n", change.time_ms / 1000.0, change.name, change.value, machine.place(change.source));
  return out;
}

}  // namespace pmac::tool
