#include "runtime/motion/jerk_lookahead.h"

#include <algorithm>
#include <cmath>

#include "runtime/interruption.h"

namespace pmac::motion {
namespace {

constexpr double kLongestStep_ms = 5, kStepsPerRamp = 8, kStepsPerMove = 32, kShortestStep_ms = 0.005;
constexpr double kLongestPart_ms = 1;      // cubics of motor positions over at most this
constexpr double kShortestPart_ms = 1e-7;  // what is shorter is added to its neighbour
constexpr int kMostStepsInCell = 100'000;
constexpr double kArrived_mu = 1e-7;       // relative to 1 + the length of the path's unit; nearer than this is there
constexpr double kJump = 0.05;             // of the jerk limit: steps of acceleration that are worth a note

/// The shortest time in which any motor can build up its acceleration.
double ramp_ms(const std::vector<MotorLimits>& limits) {
  double ramp = 1e9;
  for (const MotorLimits& limit : limits) {
    if (limit.inv_jmax_ms3_mu <= 0) continue;
    if (limit.inv_amax_ms2_mu > 0) ramp = std::min(ramp, limit.inv_jmax_ms3_mu / limit.inv_amax_ms2_mu);
    else if (limit.max_speed_mu_ms > 0) ramp = std::min(ramp, std::sqrt(limit.max_speed_mu_ms * limit.inv_jmax_ms3_mu));
  }
  return ramp;
}

}  // namespace

JerkLookahead::JerkLookahead(std::vector<MotorLimits> limits, double window_ms, double servo_period_ms)
    : window_ms_(window_ms), chunk_ms_(window_ms / 4), servo_period_ms_(servo_period_ms),
      longest_step_ms_(std::clamp(ramp_ms(limits) / kStepsPerRamp, servo_period_ms / 2, kLongestStep_ms)),
      steps_(limits, servo_period_ms), path_(std::move(limits), servo_period_ms), plan_(path_, longest_step_ms_) {}

void JerkLookahead::add(Segment segment, std::vector<TimedSegment>& out) {
  steps_.add(std::move(segment), prepared_);
  for (PreparedSegment& prepared : prepared_) take(std::move(prepared), out);
  prepared_.clear();
  if (planned_ms() < window_ms_ + chunk_ms_) return;
  plan_.path_grew();
  while (planned_ms() >= window_ms_ && go_on(out)) {}
}

void JerkLookahead::finish(std::vector<TimedSegment>& out) {
  steps_.finish(prepared_);
  for (PreparedSegment& prepared : prepared_) take(std::move(prepared), out);
  prepared_.clear();
  path_.stop_here();
  plan_.path_grew();
  while (go_on(out)) {}
  path_.clear();
  plan_.restart();
  rests_.clear();
  entered_ = has_emitted_ = false;
  known_ms_ = reached_ms_ = 0;
}

void JerkLookahead::take(PreparedSegment prepared, std::vector<TimedSegment>& out) {
  runtime::poll_interruption();
  if (path_.empty() && known_ms_ == 0) reached_ms_ = known_ms_ = prepared.segment.start_ms;
  known_ms_ = prepared.segment.start_ms + prepared.segment.duration_ms;
  const Segment rest = prepared.segment;
  if (path_.add(std::move(prepared))) return;
  if (entered_ || !path_.empty()) {
    rests_.push_back({path_.cell_end(), rest});
    return;
  }
  reached_ms_ = known_ms_;
  out.push_back({rest, 0, rest.duration_ms, 1, 0});
}

bool JerkLookahead::at_stop() const {
  const PathCell& cell = path_.cell(state_.at.cell);
  const double tolerance_mu = kArrived_mu * (1 + cell.length_mu);
  return cell.stops && state_.speed_mu_ms == 0 && cell.end_mu() - state_.at.at_mu <= tolerance_mu;
}

/// One more step, or over a stop to what follows. False where more of the path has to be known, or it has ended.
bool JerkLookahead::go_on(std::vector<TimedSegment>& out) {
  runtime::poll_interruption();
  if (path_.empty()) return false;
  if (!entered_ || at_stop()) return enter_next_cell(out);
  if (++steps_in_cell_ > kMostStepsInCell) return pass_by_rest(out);
  const PathState from = state_;
  for (double step_ms = longest_step_ms_; ; step_ms /= 4) {
    const JerkStep step = plan_.next(state_);
    if (step.duration_ms > 0) {
      if (at_stop()) state_.at.at_mu = path_.cell(state_.at.cell).end_mu();
      emit(from, step, state_, out);
      const PathCell& cell = path_.cell(state_.at.cell);
      reached_ms_ = path_.segment(cell.segment).start_ms + cell.from_ms;
      if (state_.at.cell != from.at.cell) steps_in_cell_ = 0;
      path_.forget_before(state_.at.cell);
      return true;
    }
    if (step_ms < kShortestStep_ms || !path_.cell(path_.cell_end() - 1).stops) return false;
    plan_.set_step(step_ms);
  }
}

/// A place that no plan gets past in bounded time, as where the path turns on the spot: from rest to rest up to the end of the cell within
/// the acceleration limits, and noted as a join.
bool JerkLookahead::pass_by_rest(std::vector<TimedSegment>& out) {
  const PathCell& cell = path_.cell(state_.at.cell);
  double inv_accel = 0;
  for (std::size_t m = 0; m < std::min(path_.limits().size(), cell.start.tangent.size()); ++m)
    inv_accel = std::max(inv_accel, path_.limits()[m].inv_amax_ms2_mu * std::max(std::abs(cell.start.tangent[m]), std::abs(cell.end.tangent[m])));
  const double left_mu = cell.end_mu() - state_.at.at_mu;
  const double slow_ms = state_.speed_mu_ms > 0 ? 2 * left_mu / state_.speed_mu_ms : 0;
  const double duration_ms = std::max({std::sqrt(12 * left_mu * inv_accel), slow_ms, servo_period_ms_});   // a cubic: 6 left / time^2, twice
  emit_part(state_.at.cell, state_.at.at_mu, cell.end_mu(), state_.speed_mu_ms, 0, duration_ms, out);
  if (!out.empty()) out.back().jerk_step = 1;
  state_.at.at_mu = cell.end_mu();
  state_.speed_mu_ms = state_.accel_mu_ms2 = 0;
  steps_in_cell_ = 0;
  plan_.restart();
  return true;
}

/// The stop at the end of this cell is over: what stands there, then the next cell from rest.
bool JerkLookahead::enter_next_cell(std::vector<TimedSegment>& out) {
  const std::size_t next = entered_ ? state_.at.cell + 1 : path_.first_cell();
  for (; !rests_.empty() && rests_.front().cell <= next; rests_.pop_front()) {
    const Segment& rest = rests_.front().segment;
    reached_ms_ = rest.start_ms + rest.duration_ms;
    out.push_back({rest, 0, rest.duration_ms, 1, 0});
  }
  if (next >= path_.cell_end()) return false;
  state_ = {{next, path_.cell(next).from_mu}, 0, 0};
  entered_ = true;
  steps_in_cell_ = 0;
  plan_.restart();
  adapt_step();
  return true;
}

/// Short moves from stop to stop take finer steps.
void JerkLookahead::adapt_step() {
  double length_mu = 0, jerk_mu_ms3 = 1e300;
  for (std::size_t i = state_.at.cell; i < path_.cell_end(); ++i) {
    const PathCell& cell = path_.cell(i);
    length_mu += cell.length_mu;
    for (std::size_t m = 0; m < std::min(path_.limits().size(), cell.start.tangent.size()); ++m) {
      const double share = std::abs(cell.start.tangent[m]) * path_.limits()[m].inv_jmax_ms3_mu;
      if (share > 0) jerk_mu_ms3 = std::min(jerk_mu_ms3, 1 / share);
    }
    if (cell.stops || jerk_mu_ms3 * std::pow(longest_step_ms_ * kStepsPerMove, 3) < 32 * length_mu) break;
  }
  const double shortest_move_ms = 4 * std::cbrt(length_mu / (2 * jerk_mu_ms3));
  plan_.set_step(std::clamp(shortest_move_ms / kStepsPerMove, kShortestStep_ms, longest_step_ms_));
}

/// The step as motor positions over time: cubics with the positions and velocities of the path at both ends, cut where segments meet.
void JerkLookahead::emit(const PathState& from, const JerkStep& step, const PathState& to, std::vector<TimedSegment>& out) {
  const auto place = [&](double t) {
    return from.at.at_mu + t * (from.speed_mu_ms + t * (from.accel_mu_ms2 / 2 + t * step.jerk_mu_ms3 / 6));
  };
  const auto speed = [&](double t) { return std::max(0.0, from.speed_mu_ms + t * (from.accel_mu_ms2 + t * step.jerk_mu_ms3 / 2)); };
  const int parts = std::max(1, static_cast<int>(std::ceil(step.duration_ms / kLongestPart_ms)));
  std::size_t cell = from.at.cell;
  double t0 = 0, at0 = from.at.at_mu, v0 = from.speed_mu_ms;
  const auto part_to = [&](double t1, double at1, double v1) {
    emit_part(cell, at0, at1, v0, v1, t1 - t0, out);
    t0 = t1;
    at0 = at1;
    v0 = v1;
  };
  for (int i = 1; i <= parts; ++i) {
    const bool last = i == parts;
    const double t1 = last ? step.duration_ms : step.duration_ms * i / parts, at1 = last ? to.at.at_mu : place(t1);
    while (cell < to.at.cell && path_.cell(cell).end_mu() < at1) {
      double low = t0, high = t1;
      for (int k = 0; k < 60; ++k) (place((low + high) / 2) < path_.cell(cell).end_mu() ? low : high) = (low + high) / 2;
      part_to(high, path_.cell(cell).end_mu(), speed(high));
      ++cell;
    }
    part_to(t1, at1, last ? to.speed_mu_ms : speed(t1));
  }
}

void JerkLookahead::emit_part(std::size_t index, double from_mu, double to_mu, double speed_from, double speed_to, double duration_ms,
                              std::vector<TimedSegment>& out) {
  carry_ms_ += duration_ms;
  const PathCell& cell = path_.cell(index);
  const Segment& owner = path_.segment(cell.segment);
  const double d0 = path_.programmed_ms(index, from_mu), d1 = path_.programmed_ms(index, to_mu);
  if (carry_ms_ < kShortestPart_ms || !(d1 > d0)) return;
  const double time_ms = carry_ms_, rate = (d1 - d0) / time_ms;
  carry_ms_ = 0;
  TimedSegment timed;
  timed.duration_ms = time_ms;
  timed.rate = rate;
  timed.segment = {owner.command, owner.source, owner.start_ms + d0, d1 - d0, {}};
  const auto velocity = [&](const MotorCubic& q, double at_ms, double path_speed) {
    double norm2 = 0;
    for (const MotorCubic& each : owner.motor) norm2 += each.velocity(at_ms) * each.velocity(at_ms);
    return norm2 > 0 ? path_speed * q.velocity(at_ms) / std::sqrt(norm2) : 0.0;
  };
  for (const MotorCubic& q : owner.motor)
    timed.segment.motor.push_back(
        hermite_cubic(q.position(d0), velocity(q, d0, speed_from) / rate, q.position(d1), velocity(q, d1, speed_to) / rate, d1 - d0));
  if (has_emitted_ && step_cell_ != index) note_step(step_cell_, index, speed_from, timed);
  step_cell_ = index;
  has_emitted_ = true;
  out.push_back(std::move(timed));
}

/// The acceleration steps where curvature does.
void JerkLookahead::note_step(std::size_t before, std::size_t after, double speed, TimedSegment& timed) const {
  if (before < path_.first_cell()) return;
  const PathCell &a = path_.cell(before), &b = path_.cell(after);
  double worst = 0;
  for (std::size_t m = 0; m < std::min(path_.limits().size(), a.end.curvature_mu.size()); ++m) {
    const double change = std::abs(b.start.curvature_mu[m] - a.end.curvature_mu[m]) * speed * speed;
    worst = std::max(worst, change * path_.limits()[m].inv_jmax_ms3_mu / servo_period_ms_);
    worst = std::max(worst, std::abs(b.start.tangent[m] - a.end.tangent[m]) * speed * path_.limits()[m].inv_jmax_ms3_mu / (servo_period_ms_ * servo_period_ms_));
  }
  if (worst > kJump) timed.jerk_step = worst;
}

}  // namespace pmac::motion
