#include "runtime/acr1000/path_lookahead.h"

#include <algorithm>
#include <cmath>

namespace pmac::acr1000 {
namespace {

/// Longest cubic that a stretch of the path is cut into: an arc of 1 rad in 100 ms is met to 1e-9 of its radius.
constexpr double kSegmentS = 2e-3;
/// Stretches that only rounding makes.
constexpr double kShortestS = 1e-9;
/// Programmed time that is planned ahead at least.
constexpr double kWindowMs = 2000;

std::vector<motion::MotorLimits> motor_limits(const std::vector<AxisLimits>& limits) {
  std::vector<motion::MotorLimits> result;
  for (const AxisLimits& axis : limits) {
    motion::MotorLimits motor;
    motor.max_speed_mu_ms = axis.speed_pulses_s / 1e3;
    motor.inv_amax_ms2_mu = axis.accel_pulses_s2 > 0 ? 1e6 / axis.accel_pulses_s2 : 0;
    result.push_back(motor);
  }
  return result;
}

/// Twice the time of the longest stop from the highest allowed speed.
double window_ms(const std::vector<AxisLimits>& limits) {
  double window = kWindowMs;
  for (const AxisLimits& axis : limits)
    if (axis.accel_pulses_s2 > 0) window = std::max(window, 2e3 * axis.speed_pulses_s / axis.accel_pulses_s2);
  return window;
}

}  // namespace

PathLookahead::PathLookahead(const CardSystem& system, const std::vector<AxisLimits>& limits, double period_s, SampleTaker taker,
                             std::function<void(const motion::TimedSegment&)> segment)
    : system_(system), clock_(period_s), taker_(std::move(taker)), segment_(std::move(segment)),
      lookahead_(motor_limits(limits), window_ms(limits), period_s * 1e3) {}

void PathLookahead::stretch(double from_s, double to_s) {
  if (to_s - from_s < kShortestS) return;
  const int count = static_cast<int>(std::ceil((to_s - from_s) / kSegmentS));
  const auto boundary_s = [&](int k) { return k == count ? to_s : from_s + (to_s - from_s) * k / count; };
  stretch_ends_ms_.push_back(to_s * 1e3);
  for (int k = 0; k < count; ++k) add_segment(boundary_s(k), boundary_s(k + 1));
}

void PathLookahead::add_segment(double from_s, double to_s) {
  motion::Segment segment;
  segment.start_ms = from_s * 1e3;
  segment.duration_ms = (to_s - from_s) * 1e3;
  for (std::size_t k = 0; k < system_.size(); ++k) {
    const Card& card = system_.card(k);
    const MotionPoint from = card.path_at(from_s), to = card.path_at(to_s);
    segment.motor.push_back(motion::hermite_cubic(from.position_pulses, from.speed_pulses_s / 1e3, to.position_pulses, to.speed_pulses_s / 1e3, segment.duration_ms));
    if (card.moves() && segment.source.line == 0) segment.source = card.active().request.place.source;
  }
  lookahead_.add(std::move(segment), timed_);
  take_timed();
}

void PathLookahead::take_timed() {
  for (motion::TimedSegment& timed : timed_) {
    timed.start_ms = end_ms_;
    if (segment_) segment_(timed);
    sample(timed);
    end_ms_ += timed.duration_ms;
    note(timed.segment.start_ms + timed.segment.duration_ms, end_ms_);
  }
  timed_.clear();
}

/// The stretches that end with this segment.
void PathLookahead::note(double programmed_ms, double time_ms) {
  while (!stretch_ends_ms_.empty() && stretch_ends_ms_.front() <= programmed_ms + kShortestS) {
    marks_.push_back({stretch_ends_ms_.front(), time_ms});
    stretch_ends_ms_.pop_front();
  }
}

void PathLookahead::sample(const motion::TimedSegment& timed) {
  points_.resize(system_.size());
  for (; clock_.next_s() * 1e3 < timed.start_ms + timed.duration_ms; clock_.advance()) {
    const double t = std::max(0.0, clock_.next_s() * 1e3 - timed.start_ms), rate = timed.rate_at(t);
    const double d = timed.programmed_ms(t);
    for (std::size_t k = 0; k < points_.size(); ++k) {
      const motion::MotorCubic& q = timed.segment.motor[k];
      points_[k] = {q.position(d), q.velocity(d) * rate * 1e3, (q.acceleration(d) * rate * rate + q.velocity(d) * timed.slope_after(d)) * 1e6, 0};
    }
    taker_(clock_.next_s(), points_);
  }
}

void PathLookahead::finish() {
  lookahead_.finish(timed_);
  take_timed();
  take_rest();
}

void PathLookahead::take_rest() {
  points_.resize(system_.size());
  for (std::size_t k = 0; k < points_.size(); ++k) points_[k] = {system_.card(k).at(system_.time_s()).position_pulses, 0, 0, 0};
  for (; clock_.is_due_until(end_s()); clock_.advance()) taker_(clock_.next_s(), points_);
}

double PathLookahead::stretched_s(double programmed_s) const {
  const double programmed_ms = programmed_s * 1e3;
  const auto at = std::lower_bound(marks_.begin(), marks_.end(), programmed_ms - kShortestS, [](const Mark& mark, double ms) { return mark.programmed_ms < ms; });
  if (programmed_ms <= 0 || marks_.empty()) return 0;
  return at == marks_.end() ? end_s() : at->time_ms / 1e3;
}

}  // namespace pmac::acr1000
