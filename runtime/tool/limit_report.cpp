#include "runtime/tool/limit_report.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace pmac::tool {
namespace {

using motion::GoverningLimit;
using nlohmann::ordered_json;
using runtime::LimitCheck;
using runtime::WorstValue;

/// Parts of a move's time that are not worth saying.
constexpr double kSmallPart = 0.01;

std::string place_of(const runtime::Machine& machine, bytecode::SourceLine source) { return source.line > 0 ? machine.place(source) : "-"; }

std::string value_line(const runtime::Machine& machine, int motor, const char* what, const char* unit, const WorstValue& worst, double room) {
  const bool limited = std::isfinite(worst.limit);
  std::string line = fmt::format("{:>5}  {:<9}{:>14.6g}", motor, what, worst.value);
  line += limited ? fmt::format("{:>14.6g}{:>10.3f}", worst.limit, worst.share() * 100) : fmt::format("{:>14}{:>10}", "-", "-");
  line += fmt::format("{:>12.6f}  {:<7} {}", worst.time_ms / 1000, unit, place_of(machine, worst.source));
  return line + (limited && worst.share() > room ? "  EXCEEDED\n" : "\n");
}

std::string position_line(const runtime::Machine& machine, const LimitCheck::Row& row) {
  const auto& p = row.position;
  if (!std::isfinite(p.room_mu)) return {};
  const LimitCheck::Row alone{row.motor, {}, {}, {}, p};
  return fmt::format("{:>5}  {:<9}{:>14.6g}{:>14.6g}{:>10}{:>12.6f}  {:<7} {}{}\n", row.motor, "position", p.value_mu, p.limit_mu, "", p.time_ms / 1000,
                     "mu", place_of(machine, p.source), alone.keeps_limits() ? "" : "  EXCEEDED");
}

void put_place(ordered_json& j, const runtime::Machine& machine, double time_ms, bytecode::SourceLine source) {
  j["time_s"] = time_ms / 1000;
  const bool known = source.file >= 0 && static_cast<std::size_t>(source.file) < machine.files().size();
  j["file"] = known ? machine.files()[static_cast<std::size_t>(source.file)] : "";
  j["line"] = source.line;
}

ordered_json value_json(const runtime::Machine& machine, const WorstValue& worst) {
  ordered_json j;
  j["value"] = worst.value;
  j["limit"] = std::isfinite(worst.limit) ? ordered_json(worst.limit) : ordered_json();
  j["share"] = std::isfinite(worst.limit) ? ordered_json(worst.share()) : ordered_json();
  put_place(j, machine, worst.time_ms, worst.source);
  return j;
}

ordered_json position_json(const runtime::Machine& machine, const runtime::WorstPosition& p) {
  ordered_json j;
  j["value"] = p.value_mu;
  j["limit"] = p.limit_mu;
  put_place(j, machine, p.time_ms, p.source);
  return j;
}

std::string share_name(const runtime::MoveRecord& move, const motion::GoverningShare& share) {
  const char* own = move.mode == "rapid" ? "rapid" : move.mode == "home" ? "home" : "jog";
  switch (share.limit) {
    case GoverningLimit::kProgram: return std::string(move.time_rule);
    case GoverningLimit::kMaxSpeed: return fmt::format("MaxSpeed of motor {}", share.motor);
    case GoverningLimit::kInvAmax: return fmt::format("InvAmax of motor {}", share.motor);
    case GoverningLimit::kLookahead: return "a stop or step ahead";
    case GoverningLimit::kJogSpeed: return fmt::format("{} speed of motor {}", own, share.motor);
    case GoverningLimit::kJogRamp: return fmt::format("JogTa of motor {}", share.motor);
  }
  return {};
}

double total_ms(const runtime::MoveRecord& move) {
  double sum_ms = 0;
  for (const auto& share : move.governed) sum_ms += share.time_ms;
  return sum_ms;
}

}  // namespace

std::string limit_text(const runtime::Machine& machine, const std::vector<LimitCheck::Row>& rows) {
  std::string out = "motor  worst             value         limit       %          at s  unit    line\n";
  for (const auto& row : rows) {
    out += value_line(machine, row.motor, "speed", "mu/ms", row.speed, runtime::kSpeedRoom);
    out += value_line(machine, row.motor, "accel", "mu/ms^2", row.accel, runtime::kAccelRoom);
    out += value_line(machine, row.motor, "jerk", "mu/ms^3", row.jerk, runtime::kJerkRoom);
    out += position_line(machine, row);
  }
  return out + (all_keep_limits(rows) ? "all limits are kept\n" : "limits are exceeded\n");
}

ordered_json limit_json(const runtime::Machine& machine, const std::vector<LimitCheck::Row>& rows) {
  ordered_json j = ordered_json::object();
  for (const auto& row : rows) {
    ordered_json& motor = j[std::to_string(row.motor)];
    motor["ok"] = row.keeps_limits();
    motor["speed"] = value_json(machine, row.speed);
    motor["accel"] = value_json(machine, row.accel);
    motor["jerk"] = value_json(machine, row.jerk);
    if (std::isfinite(row.position.room_mu)) motor["position"] = position_json(machine, row.position);
  }
  return j;
}

bool all_keep_limits(const std::vector<LimitCheck::Row>& rows) {
  return std::all_of(rows.begin(), rows.end(), [](const auto& row) { return row.keeps_limits(); });
}

std::string governed_text(const runtime::MoveRecord& move) {
  const double sum_ms = total_ms(move);
  if (sum_ms <= 0) return std::string(move.mode == "dwell" ? "its own time" : move.time_rule);
  std::string text;
  for (const auto& share : move.governed) {
    if (share.time_ms < kSmallPart * sum_ms) continue;
    text += fmt::format("{}{} {:.0f} %", text.empty() ? "" : ", ", share_name(move, share), 100 * share.time_ms / sum_ms);
  }
  return text;
}

ordered_json governed_json(const runtime::MoveRecord& move) {
  ordered_json j = ordered_json::array();
  const double sum_ms = total_ms(move);
  for (const auto& share : move.governed) {
    ordered_json part;
    part["by"] = share_name(move, share);
    if (share.motor >= 0) part["motor"] = share.motor;
    part["share"] = share.time_ms / sum_ms;
    j.push_back(part);
  }
  return j;
}

}  // namespace pmac::tool
