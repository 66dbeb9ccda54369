#include "runtime/motion/planner.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "runtime/motion/axis_vector.h"

namespace pmac::motion {
namespace {

/// Shorter pieces are left out; a path point is off by less than speed times this.
constexpr double kNoTime_ms = 1e-9;

/// Parameter of a curve that is left or entered with a ramp: base + factor * (integral of r), scaled to the move's time.
/// Rising: u = I/TM. Falling: u = 1 - (T/2 - tau + I)/TM.
PathPart entry_part(const Move& move, const RampPart& ramp) {
  const double scale = 1 / move.time_ms;
  return {move.curve, {ramp.integral_ms * scale, ramp.value * scale, ramp.slope * scale / 2, ramp.curvature * scale / 6}};
}

PathPart exit_part(const Move& move, const RampPart& ramp, double total_ms) {
  const double scale = 1 / move.time_ms;
  return {move.curve,
          {1 - (total_ms / 2 - ramp.start_ms + ramp.integral_ms) * scale, (1 - ramp.value) * scale, -ramp.slope * scale / 2,
           -ramp.curvature * scale / 6}};
}

/// Distance from the join during a blend along the path, as a cubic of the time since the start of the ramp part.
std::array<double, 4> distance_from_join(const Join& join, const RampPart& part) {
  const double change = join.speed_after - join.speed_before;
  return {join.speed_before * (part.start_ms - join.ramp.total_ms() / 2) + change * part.integral_ms,
          join.speed_before + change * part.value, change * part.slope / 2, change * part.curvature / 6};
}

double value_at(const std::array<double, 4>& c, double d) { return c[0] + d * (c[1] + d * (c[2] + d * c[3])); }

/// The same cubic with its origin moved to d.
std::array<double, 4> shifted(const std::array<double, 4>& c, double d) {
  return {value_at(c, d), c[1] + d * (2 * c[2] + d * 3 * c[3]), c[2] + 3 * c[3] * d, c[3]};
}

/// Zero of a rising cubic in [0, end]; 0 or end where it lies outside.
double zero_of_rising(const std::array<double, 4>& c, double end) {
  if (value_at(c, 0) >= 0) return 0;
  if (value_at(c, end) <= 0) return end;
  double low = 0, high = end;
  for (int i = 0; i < 100; ++i) {
    const double middle = low + (high - low) / 2;
    if (middle == low || middle == high) break;
    (value_at(c, middle) < 0 ? low : high) = middle;
  }
  return high;
}

/// Curve parameter of a distance along the path: u = at_join + distance / (speed * TM).
PathPart along(const Move& move, const std::array<double, 4>& distance, double at_join, double speed) {
  const double scale = 1 / (speed * move.time_ms);
  return {move.curve, {at_join + distance[0] * scale, distance[1] * scale, distance[2] * scale, distance[3] * scale}};
}

}  // namespace

void Planner::reset(const AxisVector& start_uu, std::vector<double> start_motor_mu) {
  *this = Planner{};
  position_ = start_uu;
  motor_position_ = std::move(start_motor_mu);
}

void Planner::add(Move& move, const PipelineConfig& config, PlannerOutput& out) {
  for_each_axis(move.curve->moved, [&](std::size_t axis) { position_[axis] = move.curve->end[axis]; });
  for (std::size_t motor = 0; motor < move.curve->motor_delta_mu.size(); ++motor) motor_position_[motor] += move.curve->motor_delta_mu[motor];
  if (!has_pending_) clock_ms_ = 0;
  if (move.time_ms == 0) return pass_over(move, out);
  if (!has_pending_) return begin(move, config, out);
  const Join join = decide_join(pending_, move, entry_total_ms_, config);
  if (join.kind == JoinKind::kStop) {
    stop(out);
    if (join.dwell_ms > 0) wait(move, join.dwell_ms, out);
    return begin(move, config, out);
  }
  const double boundary_ms = nominal_end_ms();
  out.ends.push_back({pending_.id, boundary_ms});
  out.begins.push_back({move.id, move.source, boundary_ms - join.ramp.total_ms() / 2, boundary_ms, move.length_uu, move.rule});
  blend(join, move, out);
  nominal_start_ms_ = boundary_ms;
  entry_total_ms_ = join.ramp.total_ms();
  hold_back(move);
}

void Planner::hold_back(Move& move) {
  std::swap(pending_, move);
  has_pending_ = true;
}

void Planner::end_sequence(PlannerOutput& out) {
  if (has_pending_) stop(out);
}

/// A move without length and time leaves no trace but its timing.
void Planner::pass_over(const Move& move, PlannerOutput& out) {
  const double time_ms = has_pending_ ? nominal_end_ms() : clock_ms_;
  out.begins.push_back({move.id, move.source, time_ms, time_ms, 0, move.rule});
  out.ends.push_back({move.id, time_ms});
}

void Planner::begin(Move& move, const PipelineConfig& config, PlannerOutput& out) {
  const Ramp ramp = start_ramp(move, config);
  const double start_ms = clock_ms_;
  out.begins.push_back({move.id, move.source, start_ms, start_ms, move.length_uu, move.rule});
  const RampParts parts = ramp_parts(ramp);
  rest_before_ = true;
  step_before_ = parts.count == 0 && !move.pvt;
  for (int i = 0; i < parts.count; ++i) {
    const RampPart& part = parts.part[static_cast<std::size_t>(i)];
    emit(move, start_ms + part.start_ms, part.duration_ms, {entry_part(move, part)}, out);
  }
  clock_ms_ = start_ms + ramp.total_ms();
  nominal_start_ms_ = start_ms + ramp.total_ms() / 2;
  entry_total_ms_ = ramp.total_ms();
  hold_back(move);
}

void Planner::stop(PlannerOutput& out) {
  const Ramp& ramp = pending_.stop_ramp;
  const double start_ms = nominal_end_ms() - ramp.total_ms() / 2;
  cruise_until(start_ms, out);
  const RampParts parts = ramp_parts(ramp);
  for (int i = 0; i < parts.count; ++i) {
    const RampPart& part = parts.part[static_cast<std::size_t>(i)];
    emit(pending_, start_ms + part.start_ms, part.duration_ms, {exit_part(pending_, part, ramp.total_ms())}, out);
  }
  clock_ms_ = nominal_end_ms() + ramp.total_ms() / 2;
  out.ends.push_back({pending_.id, clock_ms_});
  has_pending_ = false;
}

/// Rest at the start of the move to come.
void Planner::wait(const Move& next, double duration_ms, PlannerOutput& out) {
  rest_before_ = true;
  emit(next, clock_ms_, duration_ms, {PathPart{next.curve, {0, 0, 0, 0}}}, out);
  clock_ms_ += duration_ms;
}

void Planner::cruise_until(double time_ms, PlannerOutput& out) {
  const double scale = 1 / pending_.time_ms;
  emit(pending_, clock_ms_, time_ms - clock_ms_,
       {PathPart{pending_.curve, {(clock_ms_ - nominal_start_ms_) * scale, scale, 0, 0}}}, out);
  clock_ms_ = time_ms;
}

void Planner::blend(const Join& join, const Move& next, PlannerOutput& out) {
  const double half_ms = join.ramp.total_ms() / 2;
  if (join.kind == JoinKind::kSteady || half_ms == 0) {
    cruise_until(nominal_end_ms(), out);
    step_before_ = join.kind != JoinKind::kSteady;
    return;
  }
  const double boundary_ms = nominal_end_ms();
  cruise_until(boundary_ms - half_ms, out);
  if (join.kind == JoinKind::kAlongPath) blend_along_path(join, next, out);
  if (join.kind == JoinKind::kCorner) blend_corner(join, next, out);
  clock_ms_ = boundary_ms + half_ms;
}

void Planner::blend_along_path(const Join& join, const Move& next, PlannerOutput& out) {
  const RampParts parts = ramp_parts(join.ramp);
  for (int i = 0; i < parts.count; ++i) {
    const RampPart& part = parts.part[static_cast<std::size_t>(i)];
    const std::array<double, 4> distance = distance_from_join(join, part);
    const double crossing_ms = zero_of_rising(distance, part.duration_ms);
    const double start_ms = clock_ms_ + part.start_ms;
    emit(pending_, start_ms, crossing_ms, {along(pending_, distance, 1, join.speed_before)}, out);
    emit(next, start_ms + crossing_ms, part.duration_ms - crossing_ms,
         {along(next, shifted(distance, crossing_ms), 0, join.speed_after)}, out);
  }
}

void Planner::blend_corner(const Join& join, const Move& next, PlannerOutput& out) {
  const RampParts parts = ramp_parts(join.ramp);
  for (int i = 0; i < parts.count; ++i) {
    const RampPart& part = parts.part[static_cast<std::size_t>(i)];
    emit(next, clock_ms_ + part.start_ms, part.duration_ms,
         {exit_part(pending_, part, join.ramp.total_ms()), entry_part(next, part)}, out);
  }
}

void Planner::emit(const Move& owner, double start_ms, double duration_ms, std::initializer_list<PathPart> parts,
                   PlannerOutput& out) {
  if (duration_ms <= kNoTime_ms) return;
  PathPiece& piece = out.pieces.emplace_back();
  piece.command = owner.id;
  piece.source = owner.source;
  piece.start_ms = start_ms;
  piece.duration_ms = duration_ms;
  piece.part_count = static_cast<int>(parts.size());
  std::copy(parts.begin(), parts.end(), piece.part.begin());
  piece.starts_at_rest = std::exchange(rest_before_, false);
  piece.step_at_start = std::exchange(step_before_, false);
}

}  // namespace pmac::motion
