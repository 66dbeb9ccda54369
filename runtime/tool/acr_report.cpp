#include "runtime/tool/acr_report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace pmac::tool {
namespace {

using acr1000::CardMoveRecord;
using acr1000::CardNotice;
using acr1000::Place;
using nlohmann::ordered_json;
using runtime::WorstValue;

/// The stored line's number where it has one, else the file's line.
void put_place(ordered_json& j, const std::vector<std::string>& files, const Place& place) {
  const bool known = place.source.file >= 0 && static_cast<std::size_t>(place.source.file) < files.size();
  j["file"] = known ? files[static_cast<std::size_t>(place.source.file)] : "";
  j["line"] = place.line_number >= 0 ? place.line_number : place.source.line;
  j["file_line"] = place.source.line;
}

ordered_json worst_json(const WorstValue& worst, double unit) {
  const bool limited = std::isfinite(worst.limit);
  return {{"value", worst.value * unit}, {"limit", limited ? ordered_json(worst.limit * unit) : ordered_json()},
          {"share", limited ? ordered_json(worst.share()) : ordered_json()}, {"time_s", worst.time_ms / 1e3}, {"file_line", worst.source.line}};
}

/// Moves in order of their start; the cards' own order at one instant.
std::vector<CardMoveRecord> in_order(std::vector<CardMoveRecord> moves) {
  std::stable_sort(moves.begin(), moves.end(), [](const auto& a, const auto& b) { return std::tie(a.start_s, a.card) < std::tie(b.start_s, b.card); });
  return moves;
}

const char* mode_of(const CardMoveRecord& move) { return move.is_circle ? "circle" : "linear"; }

std::string worst_line(const std::string& axis, const char* what, const WorstValue& worst, double unit, double room) {
  const bool limited = std::isfinite(worst.limit);
  std::string line = fmt::format("{:<5}  {:<6}{:>14.6g}", axis, what, worst.value * unit);
  line += limited ? fmt::format("{:>14.6g}{:>10.3f}", worst.limit * unit, worst.share() * 100) : fmt::format("{:>14}{:>10}", "-", "-");
  return line + fmt::format("{:>12.6f}{}\n", worst.time_ms / 1e3, limited && worst.share() > room ? "  EXCEEDED" : "");
}

constexpr double kPerSecond = 1e3, kPerSecond2 = 1e6;   // of values per ms and ms^2

}  // namespace

void CardReport::add(const CardMoveRecord& move) {
  ++move_count_;
  if (keep_moves_) moves_.push_back(move);
}

std::string CardReport::place_of(const Place& place) const {
  const bool known = place.source.file >= 0 && static_cast<std::size_t>(place.source.file) < files_.size();
  return known ? fmt::format("{}:{}", files_[static_cast<std::size_t>(place.source.file)], place.source.line) : "pmac-run";
}

void CardReport::add(const CardNotice& notice) {
  const auto key = std::tuple(notice.card, notice.id, notice.place.source.line, notice.place.line_number);
  const auto known = notice_index_.find(key);
  if (known != notice_index_.end()) {
    ++notices_[known->second].count;
    return;
  }
  if (notices_.size() == kMostNotices) {
    ++more_notices_;
    return;
  }
  notice_index_.emplace(key, notices_.size());
  notices_.push_back({notice});
  const std::string line = notice.place.line_number >= 0 ? fmt::format(", {}", acr1000::text_of(notice.place)) : "";
  std::fprintf(stderr, "%s\n", fmt::format("{}: {} at {:.6f} s, axis {}{}: {}: {}", place_of(notice.place), notice.is_error ? "fault" : "warning", notice.time_s,
                                          system_.card(notice.card).name(), line, notice.id, notice.text).c_str());
}

void CardReport::add_refusal(const std::string& command, const std::string& reason) {
  refusals_.emplace_back(command, reason);
  std::fprintf(stderr, "refused: %s: %s\n", command.c_str(), reason.c_str());
}

std::string CardReport::repeated() const {
  std::string out;
  for (const Counted& counted : notices_)
    if (counted.count > 1)
      out += fmt::format("{}: {} times in all: axis {}: {}\n", place_of(counted.notice.place), counted.count, system_.card(counted.notice.card).name(), counted.notice.id);
  if (more_notices_ > 0) out += fmt::format("{} more faults and warnings at other places\n", more_notices_);
  return out;
}

std::string CardReport::json(const CardRunResult& result, JsonDetail detail) const {
  ordered_json j;
  j["status"] = result.status;
  j["time_s"] = result.time_s;
  if (detail == JsonDetail::kMoves) {
    j["moves"] = ordered_json::array();
    for (const CardMoveRecord& move : in_order(moves_)) {
      ordered_json m{{"card", system_.card(move.card).name()}};
      put_place(m, files_, move.place);
      m["mode"] = mode_of(move);
      m["start_s"] = result.stretched_s(move.start_s);
      m["end_s"] = result.stretched_s(move.end_s);
      m["length"] = move.length_pulses;
      m["master_length"] = move.master_pulses;
      m["from"] = move.from_pulses;
      m["to"] = move.to_pulses;
      m["coordinated"] = move.coordinated > 0 ? ordered_json(move.coordinated) : ordered_json();
      m["entry_speed"] = move.entry_speed_pulses_s;
      m["exit_speed"] = move.exit_speed_pulses_s;
      m["counter"] = move.counter;
      j["moves"].push_back(m);
    }
  }
  j["cards"] = ordered_json::object();
  for (std::size_t k = 0; k < system_.size(); ++k) {
    const acr1000::Card& card = system_.card(k);
    ordered_json& c = j["cards"][card.name()];
    c["final"] = card.at(system_.time_s()).position_pulses;
    c["counter"] = card.memory().move_counter();
    for (const auto& row : result.statistics) {
      if (row.motor != static_cast<int>(k)) continue;
      c["min"] = row.min_mu;
      c["max"] = row.max_mu;
      c["max_speed"] = row.max_speed_mu_ms * kPerSecond;
      c["max_accel"] = row.max_accel_mu_ms2 * kPerSecond2;
    }
  }
  for (const auto& row : result.limits) {
    ordered_json& c = j["limits"][system_.card(static_cast<std::size_t>(row.motor)).name()];
    c["ok"] = row.keeps_limits();
    c["speed"] = worst_json(row.speed, kPerSecond);
    c["accel"] = worst_json(row.accel, kPerSecond2);
  }
  j["faults"] = ordered_json::array();
  j["warnings"] = ordered_json::array();
  for (const Counted& counted : notices_) {
    ordered_json n{{"id", counted.notice.id}, {"card", system_.card(counted.notice.card).name()}};
    put_place(n, files_, counted.notice.place);
    n["time_s"] = counted.notice.time_s;
    n["text"] = counted.notice.text;
    if (counted.count > 1) n["count"] = counted.count;
    j[counted.notice.is_error ? "faults" : "warnings"].push_back(n);
  }
  j["loops"] = ordered_json::array();
  for (const std::size_t k : system_.endless_loops()) {
    ordered_json l{{"card", system_.card(k).name()}};
    put_place(l, files_, system_.card(k).driver->place());
    j["loops"].push_back(l);
  }
  j["refused"] = ordered_json::array();
  for (const auto& [command, reason] : refusals_) j["refused"].push_back({{"command", command}, {"text", reason}});
  return j.dump(1, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

std::string CardReport::text(const CardRunResult& result, double wall_s) const {
  std::string out = fmt::format("{} after {:.6f} s simulated: {} moves, {} commands", result.status, result.time_s, move_count_, result.commands);
  if (wall_s > 0) out += fmt::format("; {:.0f} times real time", result.time_s / wall_s);
  out += "\naxis    final pulses             min             max    max pulses/s     at s max pulses/s^2     at s\n";
  for (const auto& r : result.statistics)
    out += fmt::format("{:<5} {:>14.10g} {:>15.10g} {:>15.10g} {:>15.6g} {:>8.4f} {:>14.6g} {:>8.4f}\n", system_.card(static_cast<std::size_t>(r.motor)).name(), r.final_mu, r.min_mu, r.max_mu,
                       r.max_speed_mu_ms * kPerSecond, r.max_speed_at_ms / 1e3, r.max_accel_mu_ms2 * kPerSecond2, r.max_accel_at_ms / 1e3);
  constexpr std::size_t kShown = 1000;
  const std::vector<CardMoveRecord> moves = in_order(moves_);
  if (!moves.empty()) out += "axis  move          from s        to s    from pulses      to pulses  entry pulses/s   exit pulses/s\n";
  for (std::size_t k = 0; k < std::min(moves.size(), kShown); ++k) {
    const CardMoveRecord& m = moves[k];
    out += fmt::format("{:<5} {:<8} {:>11.6f} {:>11.6f} {:>14.10g} {:>14.10g} {:>15.6g} {:>15.6g}  ({})\n", system_.card(m.card).name(), mode_of(m), result.stretched_s(m.start_s),
                       result.stretched_s(m.end_s), m.from_pulses, m.to_pulses, m.entry_speed_pulses_s, m.exit_speed_pulses_s, acr1000::text_of(m.place));
  }
  if (moves.size() > kShown) out += fmt::format("and {} more moves; --stats --json tells all of them\n", moves.size() - kShown);
  return out;
}

std::string CardReport::limit_text(const CardRunResult& result) const {
  std::string out = "axis   worst          value         limit         %        at s\n";
  bool kept = true;
  for (const auto& row : result.limits) {
    const std::string& axis = system_.card(static_cast<std::size_t>(row.motor)).name();
    out += worst_line(axis, "speed", row.speed, kPerSecond, runtime::kSpeedRoom);
    out += worst_line(axis, "accel", row.accel, kPerSecond2, runtime::kAccelRoom);
    kept = kept && row.keeps_limits();
  }
  return out + (kept ? "all limits are kept\n" : "limits are exceeded\n");
}

}  // namespace pmac::tool
