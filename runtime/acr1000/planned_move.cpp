#include "runtime/acr1000/planned_move.h"

#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace pmac::acr1000 {
namespace {

/// A distance between whole pulses that only rounding makes.
constexpr double kRoundingPulses = 1e-3;

bool fits_position(std::int64_t pulses) {
  return pulses >= std::numeric_limits<std::int32_t>::min() && pulses <= std::numeric_limits<std::int32_t>::max();
}

bool has_way_to_go(const MoveRequest& request, std::int64_t start) {
  if (request.is_coordinated()) return true;
  return request.kind == MoveKind::kCircle ? request.circle.distance != 0 : end_of(request, start) != start;
}

std::optional<Finding> circle_refusal(const CircleArguments& circle) {
  if (circle.rot != 1 && circle.rot != -1)
    return Finding{DiagnosticId::kCircleArguments, fmt::format("CIRCLE turns by {}; rot is +1 (clockwise) or -1", circle.rot)};
  if (circle.radius <= 0) return Finding{DiagnosticId::kCircleArguments, fmt::format("the radius of CIRCLE is {}; it must be above 0", circle.radius)};
  if (circle.distance < 0)
    return Finding{DiagnosticId::kCircleArguments, fmt::format("the distance of CIRCLE is {}; rot gives the direction, the distance is 0 or above", circle.distance)};
  return std::nullopt;
}

void check_circle(const PlannedMove& move, std::vector<Finding>& found) {
  const double end = computed_end_pulses(move.law), p29 = move.law.end_pulses;
  if (std::abs(p29 - end) > kEndTolerancePulses + kRoundingPulses)
    found.push_back({DiagnosticId::kEndPoint, fmt::format("P29 is {:.0f}, but the CIRCLE ends at {:.1f}; the axis steps there", p29, end)});
  const double amplitude = amplitude_pulses(move.law.circle), radius = static_cast<double>(move.law.circle.radius);
  if (std::abs(amplitude - radius) > kRadiusTolerancePulses)
    found.push_back({DiagnosticId::kRadius, fmt::format("I and J are {:.1f} from the centre, the radius is {:.0f}", amplitude, radius)});
}

/// A line behind a line whose axis turns back while the speed goes on.
bool turns_back(const PlannedMove& move, const MoveEntry& entry) {
  if (!entry.after_line || move.law.is_circle) return false;
  return entry.axis_speed_pulses_s * (move.law.end_pulses - move.law.start_pulses) < 0;
}

MotionPoint point_of(const AxisPoint& axis, const MasterPoint& master, double length) {
  const double rate = master.speed_pulses_s / length;
  return {axis.position_pulses, axis.d1 * rate, axis.d2 * rate * rate + axis.d1 * master.accel_pulses_s2 / length, master.distance_pulses};
}

}  // namespace

std::int64_t end_of(const MoveRequest& request, std::int64_t start_pulses) {
  switch (request.kind) {
    case MoveKind::kMoveTo: return request.distance;
    case MoveKind::kMoveBy: return start_pulses + request.distance;
    case MoveKind::kCircle: return request.end_point_is_relative ? start_pulses + request.end_point : request.end_point;
  }
  return start_pulses;
}

std::optional<Finding> refusal_of(const MoveRequest& request, std::int64_t start_pulses) {
  if (request.kind == MoveKind::kCircle)
    if (auto refusal = circle_refusal(request.circle)) return refusal;
  if (request.master_length < 0)
    return Finding{DiagnosticId::kNumberRange, fmt::format("P28 is {}; it is the length of the longest move, or 0", request.master_length)};
  if (!fits_position(end_of(request, start_pulses)))
    return Finding{DiagnosticId::kNumberRange, fmt::format("the move ends at {}, beyond positions of 32 bits", end_of(request, start_pulses))};
  if (request.rates.vel == 0 && has_way_to_go(request, start_pulses))
    return Finding{DiagnosticId::kNoVelocity, "the move would never end: VEL is 0; set VEL before it"};
  return std::nullopt;
}

PlannedMove plan_move(const MoveRequest& request, const RateUnits& units, const MoveEntry& entry, double start_s) {
  PlannedMove move;
  move.request = request;
  move.law.is_circle = request.kind == MoveKind::kCircle;
  move.law.start_pulses = entry.position_pulses;
  move.law.end_pulses = static_cast<double>(end_of(request, static_cast<std::int64_t>(std::llround(entry.position_pulses))));
  move.law.circle = request.circle;
  move.own_length_pulses = own_length_pulses(move.law);
  const double master = request.is_coordinated() ? static_cast<double>(request.master_length) : move.own_length_pulses;
  move.profile = master_profile(master, rates_from_settings(request.rates, units), entry.master_speed_pulses_s);
  move.start_s = start_s;
  return move;
}

std::vector<Finding> oddities_of(const PlannedMove& move, const MoveEntry& entry) {
  std::vector<Finding> found;
  if (move.law.is_circle) check_circle(move, found);
  const double p28 = static_cast<double>(move.request.master_length);
  if (p28 > 0 && move.own_length_pulses > p28)
    found.push_back({DiagnosticId::kLongerThanP28, fmt::format("the move is {:.0f} long, P28 is {:.0f}; the axis runs at {:.4g} times VEL", move.own_length_pulses, p28, move.own_length_pulses / p28)});
  if (move.profile.stop_is_forced)
    found.push_back({DiagnosticId::kForcedStop, fmt::format("STP {} cannot stop from {:.6g} pulses/s within {:.0f} pulses; the stop takes {:.6g} pulses/s^2", move.request.rates.stp, entry.master_speed_pulses_s, move.profile.length_pulses, -move.profile.phase[2].accel_pulses_s2)});
  if (turns_back(move, entry))
    found.push_back({DiagnosticId::kReversal, fmt::format("the axis turns back at {:.6g} pulses/s; end the move before with STP above 0", std::abs(entry.axis_speed_pulses_s))});
  return found;
}

MotionPoint at(const PlannedMove& move, double time_s) {
  const MasterPoint master = at(move.profile, time_s - move.start_s);
  const double length = move.profile.length_pulses;
  if (length <= 0 || time_s - move.start_s >= move.profile.duration_s) return {move.law.end_pulses, 0, 0, length};
  return point_of(at(move.law, master.distance_pulses / length), master, length);
}

MotionPoint path_at(const PlannedMove& move, double time_s) {
  const double length = move.profile.length_pulses;
  if (length <= 0) return {move.law.end_pulses, 0, 0, 0};
  const MasterPoint master = at(move.profile, time_s - move.start_s);
  const double u = master.distance_pulses / length, beside = move.law.end_pulses - computed_end_pulses(move.law);
  AxisPoint axis = at(move.law, u);
  axis.position_pulses = u >= 1 ? move.law.end_pulses : axis.position_pulses + beside * u;
  axis.d1 += beside;
  return point_of(axis, master, length);
}

}  // namespace pmac::acr1000
