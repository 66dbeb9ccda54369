#include "runtime/motion/join.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "runtime/motion/axis_vector.h"

namespace pmac::motion {
namespace {

/// Directions that differ by less are the same: what rounding leaves of a tangent line and arc.
constexpr double kTangentTolerance = 1e-7;
constexpr double kSameSpeedTolerance = 1e-12;
/// Room that is short by rounding only is room.
constexpr double kRoomTolerance = 1e-9;

/// Velocities on both sides, of the axes that move and of the next one's circle axes; the others are not filled in.
struct Corner {
  AxisVector before, after;
  double speed_before, speed_after;
};

/// Velocity at an end of the move's curve (u 0 or 1), of the axes of the mask. Returns the speed.
double fill_velocity(const Move& move, double u, std::uint32_t axes, AxisVector& velocity) {
  const Curve& curve = *move.curve;
  const double scale = move.time_ms;
  if (curve.is_arc || curve.rates) {
    const AxisVector rate = derivative(curve, u);
    for_each_axis(axes, [&](std::size_t axis) { velocity[axis] = rate[axis] == 0 ? 0 : rate[axis] / scale; });
  } else {
    for_each_axis(axes, [&](std::size_t axis) { velocity[axis] = curve.delta[axis] == 0 ? 0 : curve.delta[axis] / scale; });
  }
  return norm(velocity, curve.moved);
}

void fill_corner(const Move& previous, const Move& next, Corner& corner) {
  const std::uint32_t axes = previous.curve->moved | next.curve->moved | 7u << (next.second_set ? kAxisXX : kAxisX);
  corner.speed_before = fill_velocity(previous, 1, axes, corner.before);
  corner.speed_after = fill_velocity(next, 0, axes, corner.after);
}

double speed_change(const Corner& corner, std::uint32_t axes) {
  double sum = 0;
  for_each_axis(axes, [&](std::size_t axis) { sum += (corner.after[axis] - corner.before[axis]) * (corner.after[axis] - corner.before[axis]); });
  return std::sqrt(sum);
}

bool directions_agree(const Corner& corner, std::uint32_t axes) {
  if (corner.speed_before == 0 || corner.speed_after == 0) return false;
  double difference = 0;
  for_each_axis(axes, [&](std::size_t axis) {
    const double d = corner.after[axis] / corner.speed_after - corner.before[axis] / corner.speed_before;
    difference += d * d;
  });
  return difference <= kTangentTolerance * kTangentTolerance;
}

JoinKind kind_of(const Corner& corner, std::uint32_t axes) {
  const double change = speed_change(corner, axes);
  if (change <= kSameSpeedTolerance * std::max(corner.speed_before, corner.speed_after)) return JoinKind::kSteady;
  return directions_agree(corner, axes) ? JoinKind::kAlongPath : JoinKind::kCorner;
}

/// Direction of a velocity in the plane of `normal`, over the circle axes; zero where it has none.
std::array<double, 3> in_plane(const AxisVector& velocity, const Move& move) {
  const std::size_t first = static_cast<std::size_t>(move.second_set ? kAxisXX : kAxisX);
  const auto& n = move.normal;
  const double nn = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
  const double along = nn > 0 ? (velocity[first] * n[0] + velocity[first + 1] * n[1] + velocity[first + 2] * n[2]) / nn : 0;
  std::array<double, 3> result{};
  for (std::size_t i = 0; i < 3; ++i) result[i] = velocity[first + i] - along * n[i];
  return result;
}

/// Cosine of the change in direction in the plane of `normal`; none where a move does not move there.
std::optional<double> cosine_of(const Corner& corner, const Move& next) {
  const auto a = in_plane(corner.before, next), b = in_plane(corner.after, next);
  const double product = std::hypot(a[0], a[1], a[2]) * std::hypot(b[0], b[1], b[2]);
  if (product == 0) return std::nullopt;
  return (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) / product;
}

/// The cosine of the change in direction is below the set one (CornerBlendBp, CornerDwellBp).
bool corner_is_too_sharp(const Corner& corner, const Move& next, double cosine) {
  return cosine != 0 && cosine_of(corner, next).value_or(1) < cosine;
}

/// Distance of a blend from its corner: change of velocity times the integral of r over half the ramp.
double deviation_uu(const Ramp& ramp, double change_uu_ms) {
  return ramp.ta_ms > 0 ? change_uu_ms * (ramp.ta_ms / 8 + ramp.ts_ms * ramp.ts_ms / (24 * ramp.ta_ms)) : 0;
}

/// Largest acceleration that CornerAccel and CornerRadius leave to a blend, 0: no limit. Half way through a blend of constant acceleration
/// the velocity is the mean of both and the acceleration at right angles to it (equal speeds): radius = speed^2 / acceleration.
double corner_accel_uu_ms2(const Corner& corner, std::uint32_t axes, const PipelineConfig& config) {
  double mean2 = 0;
  for_each_axis(axes, [&](std::size_t axis) { mean2 += (corner.before[axis] + corner.after[axis]) * (corner.before[axis] + corner.after[axis]) / 4; });
  const double by_radius = config.corner_radius_uu > 0 ? mean2 / config.corner_radius_uu : 0;
  if (config.corner_accel_uu_ms2 <= 0 || by_radius <= 0) return std::max(config.corner_accel_uu_ms2, by_radius);
  return std::min(config.corner_accel_uu_ms2, by_radius);
}

/// The blend's ramp under CornerAccel and CornerRadius, which make it longer, and CornerError, which makes it shorter and has the last word.
Ramp corner_ramp(const Ramp& ramp, const Corner& corner, const Move& next, std::uint32_t axes, const PipelineConfig& config) {
  if (config.no_corner_bp != 0 && cosine_of(corner, next).value_or(1) > config.no_corner_bp) return ramp;
  const double change = speed_change(corner, axes), accel = corner_accel_uu_ms2(corner, axes, config);
  const Ramp longer = accel > 0 && ramp.ta_ms * accel < change ? lengthened(ramp, change, 1 / accel, 0) : ramp;
  const double deviation = deviation_uu(longer, change);
  if (config.corner_error_uu <= 0 || deviation <= config.corner_error_uu) return longer;
  return scaled_to(longer, longer.total_ms() * config.corner_error_uu / deviation);
}

/// A ramp shorter than the motors' limits ask for.
bool is_too_short(const Ramp& ramp, const Ramp& within_limits) { return ramp.ta_ms < within_limits.ta_ms * (1 - kRoomTolerance); }

std::vector<double> motor_change(const Move& previous, const Move& next) {
  std::vector<double> change(next.curve->motor_delta_mu.size());
  for (std::size_t motor = 0; motor < change.size(); ++motor)
    change[motor] = next.curve->motor_delta_mu[motor] / next.time_ms - previous.curve->motor_delta_mu[motor] / previous.time_ms;
  return change;
}

/// Longest blend into a move that leaves time for the one out of it. Times for ta and td make a block long enough for both; rates do
/// not know the speeds of its neighbours, so that each blend gets half of the room there is.
double room_in(const Move& next) {
  const double room = 2 * next.time_ms - next.stop_ramp.total_ms();
  return next.entry.ta < 0 ? std::min(room, next.time_ms) : room;
}

}  // namespace

Join decide_join(const Move& previous, const Move& next, double entry_total_ms, const PipelineConfig& config) {
  if (previous.pvt && next.pvt) return {JoinKind::kSteady, {}, 0, 0, 0};  // given velocities, the same on both sides
  if (previous.pvt || next.pvt) return {};
  Corner corner;
  fill_corner(previous, next, corner);
  const std::uint32_t axes = previous.curve->moved | next.curve->moved;
  if (corner_is_too_sharp(corner, next, config.corner_dwell_bp)) {
    Join stop;
    stop.dwell_ms = config.added_dwell_ms;
    return stop;
  }
  if (previous.no_blend || corner_is_too_sharp(corner, next, config.corner_blend_bp)) return {};
  const JoinKind kind = kind_of(corner, axes);
  Ramp ramp = ramp_within_limits(next.entry, speed_change(corner, axes), motor_change(previous, next), false, config);
  if (kind == JoinKind::kCorner) {
    ramp = corner_ramp(ramp, corner, next, axes, config);
    if (is_too_short(ramp, ramp_within_limits({0, 0}, speed_change(corner, axes), motor_change(previous, next), false, config))) return {};
  }
  const double room = std::min(2 * previous.time_ms - entry_total_ms, room_in(next));
  Join join{kind, ramp, corner.speed_before, corner.speed_after, 0};
  if (config.segment_time_ms > 0) {
    if (ramp.total_ms() > room) join.ramp = scaled_to(ramp, std::max(0.0, room));
    return join;
  }
  const double allowed = std::min(room, previous.stop_ramp.total_ms());
  return ramp.total_ms() <= allowed * (1 + kRoomTolerance) ? join : Join{};
}

}  // namespace pmac::motion
