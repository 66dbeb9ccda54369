#include "runtime/motion/jerk_lookahead.h"

#include <algorithm>
#include <cmath>

#include "runtime/interruption.h"

namespace pmac::motion {
namespace {

constexpr double kLongestPart_ms = 1, kServoPerPart = 4;   // cubics of motor positions on curves over at most this
constexpr double kShortestPart_ms = 1e-7;  // what is shorter is added to its neighbour
constexpr double kJump = 0.05;             // of the jerk limit: steps of acceleration that are worth a note

}  // namespace

JerkLookahead::JerkLookahead(std::vector<MotorLimits> limits, double window_ms, double servo_period_ms)
    : window_ms_(window_ms), chunk_ms_(window_ms / 4), servo_period_ms_(servo_period_ms), steps_(limits, servo_period_ms),
      path_(std::move(limits), servo_period_ms), plan_(path_, servo_period_ms) {}

void JerkLookahead::add(Segment segment, std::vector<TimedSegment>& out) {
  steps_.add(std::move(segment), prepared_);
  for (PreparedSegment& prepared : prepared_) take(std::move(prepared), out);
  prepared_.clear();
  if (planned_ms() < window_ms_ + chunk_ms_) return;
  grew_ = true;
  while (planned_ms() >= std::min(window_ms_, plan_.felt_ms()) && go_on(out)) {}
}

void JerkLookahead::finish(std::vector<TimedSegment>& out) {
  steps_.finish(prepared_);
  for (PreparedSegment& prepared : prepared_) take(std::move(prepared), out);
  prepared_.clear();
  path_.stop_here();
  grew_ = true;
  while (go_on(out)) {}
  path_.clear();
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

/// One more cell, or over a stop to what follows. False where more of the path has to be known, or it has ended.
bool JerkLookahead::go_on(std::vector<TimedSegment>& out) {
  runtime::poll_interruption();
  if (path_.empty()) return false;
  if (!entered_ || (plan_.is_done() && plan_.ends_at_stop())) return enter_next_stretch(out);
  if ((grew_ || plan_.is_done()) && !plan_.ends_at_stop()) plan_.renew();
  grew_ = false;
  if (plan_.is_done()) return false;
  const PlannedCell planned = plan_.next_cell();
  emit(planned, plan_.advance(), out);
  const PathCell& cell = path_.cell(planned.cell);
  reached_ms_ = path_.segment(cell.segment).start_ms + cell.from_ms;
  path_.forget_before(planned.cell);
  return true;
}

/// The stop at the end of the plan is over: what stands there, then the next cell from rest.
bool JerkLookahead::enter_next_stretch(std::vector<TimedSegment>& out) {
  const std::size_t next = entered_ ? plan_.state().cell + 1 : path_.first_cell();
  for (; !rests_.empty() && rests_.front().cell <= next; rests_.pop_front()) {
    const Segment& rest = rests_.front().segment;
    reached_ms_ = rest.start_ms + rest.duration_ms;
    out.push_back({rest, 0, rest.duration_ms, 1, 0});
  }
  if (next >= path_.cell_end()) return false;
  plan_.start_at(next);
  plan_.renew();
  entered_ = true;
  return true;
}

/// Through a cell of the plan as motor positions over time: cubics with the positions and velocities of the path at both ends.
void JerkLookahead::emit(const PlannedCell& planned, const CellMotion& motion, std::vector<TimedSegment>& out) {
  const double longest_ms = std::min(kLongestPart_ms, kServoPerPart * servo_period_ms_);
  const int parts = path_.cell(planned.cell).is_straight ? 1 : std::max(1, static_cast<int>(std::ceil(motion.duration_ms / longest_ms)));
  double at_mu = planned.from_mu, speed = motion.speed;
  for (int i = 1; i <= parts; ++i) {
    const double t = motion.duration_ms * i / parts, speed_then = std::max(0.0, motion.speed_at(t));
    const double then_mu = i == parts ? planned.to_mu : std::clamp(planned.from_mu + motion.place(t), at_mu, planned.to_mu);
    emit_part({planned.cell, at_mu, then_mu}, speed, speed_then, motion.duration_ms / parts, out);
    at_mu = then_mu;
    speed = speed_then;
  }
}

void JerkLookahead::emit_part(const PlannedCell& part, double speed_from, double speed_to, double duration_ms, std::vector<TimedSegment>& out) {
  carry_ms_ += duration_ms;
  const PathCell& cell = path_.cell(part.cell);
  const Segment& owner = path_.segment(cell.segment);
  const double d0 = path_.programmed_ms(part.cell, part.from_mu), d1 = path_.programmed_ms(part.cell, part.to_mu);
  if (carry_ms_ < kShortestPart_ms || !(d1 > d0)) return;
  const double time_ms = carry_ms_, rate = (d1 - d0) / time_ms;
  carry_ms_ = 0;
  TimedSegment timed;
  timed.duration_ms = time_ms;
  timed.rate = rate;
  timed.segment = {owner.command, owner.source, owner.start_ms + d0, d1 - d0, 0, {}};
  const auto velocity = [&](const MotorCubic& q, double at_ms, double path_speed) {
    double norm2 = 0;
    for (const MotorCubic& each : owner.motor) norm2 += each.velocity(at_ms) * each.velocity(at_ms);
    return norm2 > 0 ? path_speed * q.velocity(at_ms) / std::sqrt(norm2) : 0.0;
  };
  for (const MotorCubic& q : owner.motor)
    timed.segment.motor.push_back(
        hermite_cubic(q.position(d0), velocity(q, d0, speed_from) / rate, q.position(d1), velocity(q, d1, speed_to) / rate, d1 - d0));
  if (has_emitted_ && step_cell_ != part.cell) note_step(step_cell_, part.cell, speed_from, timed);
  step_cell_ = part.cell;
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
  const bool is_planned_for = b.start_step_mu2 > 0 && worst <= kMostReservedStep;
  if (worst > kJump && !is_planned_for) timed.jerk_step = worst;
}

}  // namespace pmac::motion
