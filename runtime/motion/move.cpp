#include "runtime/motion/move.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "runtime/motion/axis_vector.h"
#include "runtime/motion/circle.h"

namespace pmac::motion {
namespace {

constexpr int kMaxSegmentsOfMove = 1'000'000;  // a move is segmented as a whole

using runtime::Fault;
using runtime::FaultKind;

bool is_finite(const AxisVector& vector, std::uint32_t axes) {
  bool finite = true;
  for_each_axis(axes, [&](std::size_t axis) { finite = finite && std::isfinite(vector[axis]); });
  return finite;
}

std::optional<Fault> check(const MotionCommand& command) {
  const auto refuse = [&](const char* why) { return Fault{FaultKind::kBadTarget, command.source, why}; };
  if (!is_finite(command.target_uu, command.axes)) return refuse("the target is not a finite number");
  if (!std::isfinite(command.feed_uu) || command.feed_uu < 0) return refuse("the feed rate must be a positive number");
  if (!std::isfinite(command.move_time_ms) || command.move_time_ms < 0) return refuse("the move time must not be negative");
  if (!(command.feed_time_ms > 0)) return refuse("Coord[].FeedTime must be positive");
  if (!is_valid({command.ta_ms, command.ts_ms}) || !is_valid({command.td_ms, command.tsd_ms}))
    return refuse("ts must be a rate (negative) or 0 where ta is a rate");
  if (command.kind == CommandKind::kPvt && !is_finite(command.end_velocity_uu_ms, ~0u)) return refuse("the velocity is not a finite number");
  for (const double value : command.center_uu)
    if (!std::isfinite(value)) return refuse("the centre vector is not a finite number");
  if (!std::isfinite(command.radius_uu)) return refuse("the radius is not a finite number");
  return std::nullopt;
}

/// What feed rate and times are made from.
struct Way {
  const Curve& curve;
  double arc_length_uu, min_radius_uu;   // of an arc
};

AxisVector end_point(const MotionCommand& command, const AxisVector& start) {
  AxisVector end = start;
  for_each_axis(command.axes, [&](std::size_t axis) { end[axis] = command.target_uu[axis]; });
  return end;
}

/// Longest displacement among axes, absolute.
double longest(const Curve& curve, std::uint32_t axes) {
  double result = 0;
  for_each_axis(axes & curve.moved, [&](std::size_t axis) { result = std::max(result, std::abs(curve.end[axis] - curve.start[axis])); });
  return result;
}

std::uint32_t circle_axes_of(const Curve& curve) { return curve.is_arc ? 7u << curve.first_axis : 0; }

/// Length over the feed-rate axes; the three axes of an arc always count, with the arc in place of its chord.
double feed_length(const Way& way, const MotionCommand& command) {
  const double straight = norm(way.curve.delta, (command.feed_axes | circle_axes_of(way.curve)) & way.curve.moved);
  return way.arc_length_uu == 0 ? straight : std::hypot(way.arc_length_uu, straight);
}

/// Feed rate in effect, uu per feed time: clipped by MaxFeedRate, and on an arc by MaxCirAccel (v^2/R).
double feed_in_effect(const MotionCommand& command, const Way& way, double length_uu, const PipelineConfig& config) {
  double feed = command.feed_uu;
  if (config.max_feed_uu > 0) feed = std::min(feed, config.max_feed_uu);
  if (config.max_circle_accel > 0 && way.curve.is_arc)
    feed = std::min(feed, std::sqrt(config.max_circle_accel * way.min_radius_uu) * length_uu / way.arc_length_uu);
  return feed;
}

/// TM before the short-move rule.
double programmed_time_ms(const MotionCommand& command, const Way& way, double length_uu, const PipelineConfig& config) {
  if (command.kind == CommandKind::kDelay) return std::max(command.move_time_ms, config.segment_time_ms);
  if (command.feed_uu == 0) return command.move_time_ms;
  if (command.inverse_time) return command.feed_time_ms / command.feed_uu;
  const std::uint32_t circle_axes = circle_axes_of(way.curve);
  const double other = longest(way.curve, ~(command.feed_axes | command.feed_axes2 | circle_axes));
  const double second_uu = norm(way.curve.delta, command.feed_axes2 & ~circle_axes & way.curve.moved);
  const double feed = feed_in_effect(command, way, length_uu, config);
  double time_ms = std::max(length_uu, second_uu) / feed * command.feed_time_ms;
  if (command.alt_feed_uu > 0) time_ms = std::max(time_ms, other / command.alt_feed_uu * command.feed_time_ms);
  if (command.alt_feed_uu <= 0 && time_ms == 0) time_ms = other / feed * command.feed_time_ms;
  return time_ms;
}

/// What made programmed_time_ms() what it is.
TimeRule rule_of(const MotionCommand& command, const Way& way, double length_uu, double time_ms, const PipelineConfig& config) {
  if (command.kind == CommandKind::kDelay) return time_ms > command.move_time_ms ? TimeRule::kSegment : TimeRule::kOwnTime;
  if (command.feed_uu == 0) return TimeRule::kMoveTime;
  if (command.inverse_time) return TimeRule::kInverseTime;
  const double feed = feed_in_effect(command, way, length_uu, config);
  const double second_uu = norm(way.curve.delta, command.feed_axes2 & ~circle_axes_of(way.curve) & way.curve.moved);
  const bool by_feed = time_ms <= std::max(length_uu, second_uu) / feed * command.feed_time_ms;
  if (!by_feed) return command.alt_feed_uu > 0 ? TimeRule::kAltFeedRate : TimeRule::kFeed;
  if (second_uu > length_uu) return TimeRule::kSecondFeedAxes;
  if (feed >= command.feed_uu) return TimeRule::kFeed;
  return config.max_feed_uu > 0 && feed == config.max_feed_uu ? TimeRule::kMaxFeedRate : TimeRule::kMaxCirAccel;
}

/// Shortest time at which no motor is above its MaxSpeed, unsegmented.
double time_for_max_speed_ms(const Move& move, const PipelineConfig& config) {
  double time_ms = 0;
  for (std::size_t motor = 0; motor < std::min(move.curve->motor_delta_mu.size(), config.limits.size()); ++motor)
    if (config.limits[motor].max_speed_mu_ms > 0)
      time_ms = std::max(time_ms, std::abs(move.curve->motor_delta_mu[motor]) / config.limits[motor].max_speed_mu_ms);
  return time_ms;
}

std::vector<double> motor_velocity(const Move& move, double time_ms) {
  std::vector<double> velocity = move.curve->motor_delta_mu;
  for (double& v : velocity) v = v == 0 ? 0 : v / time_ms;
  return velocity;
}

double vector_speed(const Move& move, double time_ms) { return move.length_uu == 0 ? 0 : move.length_uu / time_ms; }

Ramp own_ramp(const Move& move, double time_ms, bool stops, const PipelineConfig& config) {
  if (move.curve->motor_delta_mu.empty()) return make_ramp(stops ? move.exit : move.entry, vector_speed(move, time_ms), config.ramp_rule);
  return ramp_within_limits(stops ? move.exit : move.entry, vector_speed(move, time_ms), motor_velocity(move, time_ms), stops, config);
}

/// Short-move rule: TM >= (T_acc + T_dec)/2. The ramps get shorter with the speed, so the condition is monotone in TM.
double time_with_room_for_ramps(const Move& move, double time_ms, const PipelineConfig& config) {
  const auto ramps = [&](double time) {
    return (own_ramp(move, time, false, config).total_ms() + own_ramp(move, time, true, config).total_ms()) / 2;
  };
  const double shortest = std::max(time_ms, 1e-9), room = ramps(shortest);
  if (room <= shortest) return room == 0 ? time_ms : shortest;
  double low = shortest, high = room;
  if (ramps(high) == high) return high;  // ramps given as times
  for (int i = 0; i < 100 && high - low > 1e-14 * high; ++i) {
    const double middle = (low + high) / 2;
    (ramps(middle) > middle ? low : high) = middle;
  }
  return high;
}

/// Unsegmented moves take the motors straight to the image of the end point.
std::optional<Fault> map_ends(Curve& curve, const std::vector<double>& start_motor_mu, SourceLine source, const MoveContext& context) {
  if (context.config.segment_time_ms > 0) return std::nullopt;
  curve.motor_start_mu = start_motor_mu;
  curve.motor_delta_mu.resize(context.kinematics.count());
  if (auto fault = context.kinematics.position(curve.end, curve.motor_delta_mu.data(), source)) return fault;
  for (std::size_t motor = 0; motor < start_motor_mu.size(); ++motor) curve.motor_delta_mu[motor] -= start_motor_mu[motor];
  return std::nullopt;
}

std::optional<Fault> too_long(const Move& move, SourceLine source, const PipelineConfig& config) {
  if (!std::isfinite(move.time_ms)) return Fault{FaultKind::kBadTarget, source, "the move would take for ever"};
  if (config.segment_time_ms > 0 && move.time_ms / config.segment_time_ms > kMaxSegmentsOfMove)
    return Fault{FaultKind::kBadTarget, source,
                 fmt::format("the move takes {:.0f} s, more than {} segments of {} ms; divide it or raise SegMoveTime", move.time_ms / 1000,
                             kMaxSegmentsOfMove, config.segment_time_ms)};
  return std::nullopt;
}

struct ArcSize { double length_uu = 0, min_radius_uu = 0; };

/// Fills in the curve and, of an arc, its length and radius.
std::optional<Fault> make_geometry(const MotionCommand& command, const AxisVector& start, const PipelineConfig& config, Curve& curve, ArcSize& size) {
  const bool as_line = command.kind != CommandKind::kCircle || config.segment_time_ms <= 0;
  if (command.kind == CommandKind::kDelay) set_line(curve, start, start, 0);
  else if (as_line) set_line(curve, start, end_point(command, start), command.axes);
  if (as_line) return std::nullopt;
  auto made = make_arc(command, start, end_point(command, start), config);
  if (Fault* fault = std::get_if<Fault>(&made)) return std::move(*fault);
  const Arc& arc = std::get<Arc>(made);
  curve = arc.curve;
  size = {arc.length_uu, arc.min_radius_uu};
  return std::nullopt;
}

void take_words(Move& move, const MotionCommand& command) {
  move.id = command.id;
  move.source = command.source;
  move.entry = {command.ta_ms, command.ts_ms};
  move.exit = {command.td_ms, command.tsd_ms};
  move.stop_ramp = {};
  move.no_blend = command.no_blend;
  move.pvt = false;
  move.normal = command.normal;
  move.second_set = command.second_set;
}

/// Unsegmented: the motors' own cubics, with the velocities that the linear map or the kinematic routine makes of those of the axes.
std::optional<Fault> map_rates(Curve& curve, const MotionCommand& command, const MoveContext& context) {
  if (context.config.segment_time_ms > 0) return std::nullopt;
  const auto map = [&](const AxisVector& at, const AxisVector& velocity_uu_ms, std::vector<double>& rate_mu) {
    rate_mu.resize(context.kinematics.count());
    auto fault = context.kinematics.rate_at(at, velocity_uu_ms, rate_mu.data(), command.source);
    for (double& rate : rate_mu) rate *= command.move_time_ms;
    return fault;
  };
  if (auto fault = map(curve.start, command.start_velocity_uu_ms, curve.motor_start_rate_mu)) return fault;
  return map(curve.end, command.end_velocity_uu_ms, curve.motor_end_rate_mu);
}

std::optional<Fault> make_pvt_move(const MotionCommand& command, const AxisVector& start, const std::vector<double>& start_motor_mu,
                                   const MoveContext& context, Move& move) {
  const double time_ms = command.move_time_ms;
  if (!(time_ms > 0)) return Fault{FaultKind::kPvt, command.source, "the time of a pvt or spline move must be above 0"};
  EndRates rates;
  for (std::size_t axis = 0; axis < rates.start.size(); ++axis) {
    rates.start[axis] = command.start_velocity_uu_ms[axis] * time_ms;
    rates.end[axis] = command.end_velocity_uu_ms[axis] * time_ms;
  }
  Curve curve = pvt_curve(start, end_point(command, start), rates);
  if (auto fault = map_ends(curve, start_motor_mu, command.source, context)) return fault;
  if (auto fault = map_rates(curve, command, context)) return fault;
  take_words(move, command);
  move.entry = move.exit = {0, 0};
  move.no_blend = false;
  move.pvt = true;
  move.rule = TimeRule::kOwnTime;
  move.time_ms = time_ms;
  move.length_uu = norm(curve.delta, command.feed_axes & curve.moved);
  move.curve = CurveRef::make();
  move.curve.fill() = std::move(curve);
  return too_long(move, command.source, context.config);
}

}  // namespace

Ramp ramp_within_limits(const RampSetting& setting, double speed_change_uu_ms, const std::vector<double>& motor_change_mu_ms,
                        bool stops, const PipelineConfig& config) {
  Ramp ramp = make_ramp(setting, speed_change_uu_ms, config.ramp_rule);
  for (std::size_t motor = 0; motor < std::min(motor_change_mu_ms.size(), config.limits.size()); ++motor) {
    const MotorLimits& limits = config.limits[motor];
    const double inv_accel = stops && limits.inv_dmax_ms2_mu > 0 ? limits.inv_dmax_ms2_mu : limits.inv_amax_ms2_mu;
    ramp = lengthened(ramp, motor_change_mu_ms[motor], inv_accel, config.jerk_limit_unsegmented ? limits.inv_jmax_ms3_mu : 0);
  }
  return ramp;
}

Ramp start_ramp(const Move& move, const PipelineConfig& config) {
  return move.pvt ? Ramp{} : own_ramp(move, move.time_ms, false, config);
}

std::optional<Fault> make_move(const MotionCommand& command, const AxisVector& start, const std::vector<double>& start_motor_mu,
                               const MoveContext& context, Move& move) {
  if (auto fault = check(command)) return fault;
  if (command.kind == CommandKind::kPvt) return make_pvt_move(command, start, start_motor_mu, context, move);
  move.curve = CurveRef::make();
  Curve& curve = move.curve.fill();
  ArcSize arc;
  if (auto fault = make_geometry(command, start, context.config, curve, arc)) return fault;
  if (auto fault = map_ends(curve, start_motor_mu, command.source, context)) return fault;
  take_words(move, command);
  const Way way{curve, arc.length_uu, arc.min_radius_uu};
  move.length_uu = command.kind == CommandKind::kDelay ? 0 : feed_length(way, command);
  const double programmed_ms = programmed_time_ms(command, way, move.length_uu, context.config);
  move.rule = rule_of(command, way, move.length_uu, programmed_ms, context.config);
  if (move.length_uu == 0) move.length_uu = longest(curve, ~0u);
  move.time_ms = std::max(programmed_ms, time_for_max_speed_ms(move, context.config));
  if (move.time_ms > programmed_ms) move.rule = TimeRule::kMotorSpeed;
  const double without_ramps_ms = move.time_ms;
  move.time_ms = time_with_room_for_ramps(move, move.time_ms, context.config);
  if (move.time_ms > without_ramps_ms) move.rule = TimeRule::kRamps;
  if (auto fault = too_long(move, command.source, context.config)) return fault;
  if (move.time_ms == 0 && curve.moved != 0)
    return Fault{FaultKind::kBadTarget, command.source, "the move takes no time; set tm, ta or a feed rate"};
  move.stop_ramp = own_ramp(move, move.time_ms, true, context.config);
  return std::nullopt;
}

}  // namespace pmac::motion
