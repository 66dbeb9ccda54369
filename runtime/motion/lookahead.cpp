#include "runtime/motion/lookahead.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "runtime/interruption.h"

namespace pmac::motion {
namespace {

/// Shorter parts of a segment are not worth a node.
constexpr double kMinPart_ms = 0.01;
/// x that could be reached at the end of a segment to x that may: where they are nearer there is nothing to gain within it.
constexpr double kWorthwhileRise = 1.02;
/// x that differs by less is the same where motion turns from speeding up to slowing down.
constexpr double kSamePeak = 1e-4;

bool stands_still(const Segment& segment) {
  return std::all_of(segment.motor.begin(), segment.motor.end(), [](const MotorCubic& q) { return q.c1 == 0 && q.c2 == 0 && q.c3 == 0; });
}

}  // namespace

Lookahead::Lookahead(std::vector<MotorLimits> limits, double window_ms, double servo_period_ms)
    : limits_(limits), window_ms_(window_ms), chunk_ms_(window_ms / 4), steps_(limits, servo_period_ms), division_(std::move(limits)) {}

void Lookahead::add(Segment segment, std::vector<TimedSegment>& out) {
  steps_.add(std::move(segment), prepared_);
  for (PreparedSegment& prepared : prepared_) {
    if (stands_still(prepared.segment)) {
      rest(std::move(prepared.segment), out);
      continue;
    }
    append(std::move(prepared));
    const bool is_first = planned_ == 0;   // of a path: nothing can be settled yet
    if (known_ms_ < (is_first ? window_ms_ : window_ms_ + chunk_ms_)) continue;
    backward(0);
    if (is_first) continue;
    while (known() > 1 && known_ms_ - intervals_.front().stretch.duration_ms >= window_ms_) commit_first(0, out);
  }
  prepared_.clear();
}

void Lookahead::finish(std::vector<TimedSegment>& out) {
  steps_.finish(prepared_);
  for (PreparedSegment& prepared : prepared_) {
    if (stands_still(prepared.segment)) rest(std::move(prepared.segment), out);
    else append(std::move(prepared));
  }
  prepared_.clear();
  end_path(out);
}

/// Nothing moves: the path before ends in a stop, and programmed time runs at full rate.
void Lookahead::rest(Segment segment, std::vector<TimedSegment>& out) {
  end_path(out);
  const double duration_ms = segment.duration_ms;
  out.push_back({std::move(segment), 0, duration_ms, 1, 0});
}

void Lookahead::end_path(std::vector<TimedSegment>& out) {
  if (!intervals_.empty()) {
    const bool stops = is_moving(wholes_.back().segment, true);
    if (stops && intervals_.back().start_bound == 0) split_last();
    const double end_beta = stops ? 0 : intervals_.back().limits.max_end_rate2;
    backward(end_beta);
    while (known() > 0) commit_first(end_beta, out);
  }
  known_ms_ = 0;
  planned_ = 0;
  at_start_ = true;
}

/// In parts, where the program is too fast for the limits.
void Lookahead::append(PreparedSegment prepared) {
  Whole& whole = wholes_.extend();
  whole.segment = std::move(prepared.segment);
  whole.accel_share = prepared.accel_share;
  whole.parts = 0;
  const Segment& segment = whole.segment;
  const Stretch all{0, segment.duration_ms};
  const Start start{prepared.speed_ratio, prepared.max_start_rate, prepared.stops_at_start}, inside{1, std::numeric_limits<double>::infinity(), false};
  find_rate_limits(segment, all, limits_, whole.accel_share, first_limits_);
  if (first_limits_.is_even || first_limits_.allows_full_rate) {
    Interval& next = append_interval(all, start);
    next.limits = first_limits_;
    return bound_start(next, start);
  }
  division_.start(segment, first_limits_, whole.accel_share);
  for (Stretch part; division_.next(part);) {
    const Start& at = part.from_ms == 0 ? start : inside;
    Interval& next = append_interval(part, at);
    division_.find_limits(next.limits);
    bound_start(next, at);
  }
}

/// Of the newest segment; its limits are still to be found.
Lookahead::Interval& Lookahead::append_interval(const Stretch& stretch, const Start& start) {
  runtime::poll_interruption();
  if (start.stops && !intervals_.empty() && intervals_.back().start_bound == 0) split_last();
  Interval& next = intervals_.extend();
  next.whole = first_whole_ + wholes_.size() - 1;
  next.stretch = stretch;
  next.speed_ratio2 = start.speed_ratio * start.speed_ratio;
  next.last = {};
  ++wholes_.back().parts;
  known_ms_ += stretch.duration_ms;
  return next;
}

/// The newest interval's limits are known.
void Lookahead::bound_start(Interval& interval, const Start& start) {
  interval.start_bound = start.stops ? 0 : std::min(interval.limits.max_start_rate2, start.max_rate * start.max_rate);
  if (known() > 1) interval.start_bound = std::min(interval.start_bound, intervals_[intervals_.size() - 2].limits.max_end_rate2 / interval.speed_ratio2);
}

void Lookahead::find_limits(Interval& interval) const {
  const Whole& whole = whole_of(interval);
  find_rate_limits(whole.segment, interval.stretch, limits_, whole.accel_share, interval.limits);
}

/// x at the end of interval i, as far as stops ahead tell.
double Lookahead::end_beta_of(int i, double end_beta) const {
  const auto next = static_cast<std::size_t>(i) + 1;
  return i + 1 < known() ? intervals_[next].last.x0 * intervals_[next].speed_ratio2 : end_beta;
}

/// Motion has to stop at both ends of the last interval: in two halves it can move in between.
void Lookahead::split_last() {
  planned_ = std::min(planned_, known() - 1);
  Interval second = intervals_.back();
  Interval& first = intervals_.back();
  first.stretch.duration_ms = second.stretch.duration_ms /= 2;
  second.stretch.from_ms += first.stretch.duration_ms;
  find_limits(first);
  find_limits(second);
  first.start_bound = 0;
  second.speed_ratio2 = 1;
  second.start_bound = second.limits.max_start_rate2;
  ++whole_of(second).parts;
  intervals_.extend() = std::move(second);
}

/// beta of every interval from the last one back, until a value comes out as it was: all before it stand as they are.
void Lookahead::backward(double end_beta) {
  double beta = end_beta;  // of x at the end of interval i
  RateCourse like;
  for (int i = known() - 1; i >= 0; --i) {
    Interval& interval = intervals_[static_cast<std::size_t>(i)];
    const RateCourse last = interval.limits.largest_start(interval.start_bound, std::min(beta, interval.limits.max_end_rate2), like);
    like = last;
    const bool is_same = i < planned_ && last.x0 == interval.last.x0;
    interval.last = last;
    if (is_same) break;
    beta = last.x0 * interval.speed_ratio2;
  }
  planned_ = known();
}

void Lookahead::commit_first(double end_beta, std::vector<TimedSegment>& out) {
  runtime::poll_interruption();
  const Interval& interval = intervals_.front();
  if (at_start_) rate2_ = interval.last.x0;
  at_start_ = false;
  const double allowed = std::min(end_beta_of(0, end_beta), interval.limits.max_end_rate2);
  const bool slows_down = rate2_ == interval.last.x0 && rate2_ > 0 && !interval.limits.is_even;
  const RateCourse course = slows_down ? interval.last : interval.limits.largest_end(rate2_, allowed, last_course_);
  last_course_ = course;
  const double ratio2 = known() > 1 ? intervals_[1].speed_ratio2 : 1;
  const bool meets_beta = course.x1 == end_beta_of(0, end_beta) && (rate2_ < interval.last.x0 || interval.last.x0 == interval.start_bound);
  emit(interval, course, meets_beta, out);
  rate2_ = course.x1 / ratio2;
  known_ms_ -= interval.stretch.duration_ms;
  --planned_;
  if (--whole_of(interval).parts == 0) {
    wholes_.pop_front();
    ++first_whole_;
  }
  intervals_.pop_front();
}

/// may_switch: x may rise above both ends on the way.
void Lookahead::emit(const Interval& interval, const RateCourse& course, bool may_switch, std::vector<TimedSegment>& out) {
  if (interval.limits.is_even) return emit_even(interval, course.x0, course.x1, out);
  const bool worthwhile = may_switch && course.x1 < interval.limits.max_end_rate2 &&
                          interval.limits.largest_end(course.x0, interval.limits.max_end_rate2).x1 > kWorthwhileRise * course.x1;
  if (!worthwhile || !emit_with_switch(interval, course.x0, course.x1, out)) emit_part(interval, interval.stretch, course, out);
}

/// A stretch of the interval's segment that is run through; one of x0 and x1 is not zero.
void Lookahead::emit_part(const Interval& interval, const Stretch& stretch, const RateCourse& course, std::vector<TimedSegment>& out) const {
  const double rate0 = std::sqrt(course.x0), rate1 = std::sqrt(course.x1);
  TimedSegment& timed = out.emplace_back();
  take_part(whole_of(interval).segment, stretch.from_ms, stretch.duration_ms, timed.segment);
  timed.rate = rate0;
  timed.rate_slope = (course.x1 - course.x0 - course.bend) / (2 * stretch.duration_ms);
  timed.slope_growth = course.bend / (stretch.duration_ms * stretch.duration_ms);
  timed.duration_ms = time_between(rate0, rate1, stretch.duration_ms, timed.slope_growth);
}

/// Straight at constant programmed speed: x rises as the limits allow to the highest value or until it has to fall.
///
///      x        ________
///     x0  ___/          \___ x1
void Lookahead::emit_even(const Interval& interval, double x0, double x1, std::vector<TimedSegment>& out) const {
  const Stretch& all = interval.stretch;
  const double width = interval.limits.even_change;
  const double meeting = (x0 + x1 + width) / 2, peak = std::min(interval.limits.max_rate2(), meeting), ms_per_x = all.duration_ms / width;
  double rise_ms = (peak - x0) * ms_per_x, fall_ms = (peak - x1) * ms_per_x, flat_ms = 0;
  const bool stays = meeting > peak;   // at its highest value for some time
  if (stays) {
    if (rise_ms < kMinPart_ms) rise_ms = peak - x0 > kSamePeak * peak ? kMinPart_ms : 0;
    if (fall_ms < kMinPart_ms) fall_ms = peak - x1 > kSamePeak * peak ? kMinPart_ms : 0;
    flat_ms = all.duration_ms - rise_ms - fall_ms;
    if (flat_ms > 0 && flat_ms < kMinPart_ms) (rise_ms > fall_ms ? rise_ms : fall_ms) += std::exchange(flat_ms, 0.0);
  }
  const bool is_one = stays ? flat_ms < 0 : std::min(rise_ms, fall_ms) < kMinPart_ms;
  if (is_one || flat_ms == all.duration_ms) return emit_part(interval, all, {x0, x1, 0}, out);
  const double fall_from_ms = rise_ms + flat_ms;
  if (rise_ms > 0) emit_part(interval, {all.from_ms, rise_ms}, {x0, fall_from_ms < all.duration_ms || flat_ms > 0 ? peak : x1, 0}, out);
  if (flat_ms > 0) emit_part(interval, {all.from_ms + rise_ms, flat_ms}, {rise_ms > 0 ? peak : x0, fall_ms > 0 ? peak : x1, 0}, out);
  if (fall_ms > 0) emit_part(interval, {all.from_ms + fall_from_ms, all.duration_ms - fall_from_ms}, {fall_from_ms > 0 ? peak : x0, x1, 0}, out);
}

/// Within this interval motion changes from speeding up to slowing down. One more node where the two meet makes both complete:
///
///      x       /\              rising as the first part allows, falling as the second part asks
///     x0  ___/    \___ x1
///
/// False where that is no faster; nothing is appended then.
bool Lookahead::emit_with_switch(const Interval& interval, double x0, double x1, std::vector<TimedSegment>& out) {
  constexpr int kSteps = 20;
  constexpr double kLittle = 1e-3;
  const Whole& whole = whole_of(interval);
  const double from_ms = interval.stretch.from_ms, whole_ms = interval.stretch.duration_ms;
  const RateLimits& limits = interval.limits;
  double low_ms = 0, low_over = x0 - limits.largest_start(limits.max_start_rate2, x1).x0;         // what can be reached over what may be: below 0 at the start,
  double high_ms = whole_ms, high_over = limits.largest_end(x0, limits.max_end_rate2).x1 - x1;  // above 0 at the end
  if (low_over >= -kLittle * x0 || high_over <= kLittle * x1) return false;
  double at_ms = 0;
  RateCourse rise, fall;
  bool was_low = false;
  for (int i = 0; i < kSteps; ++i) {  // false position; an end that stays counts half (Illinois)
    at_ms = std::clamp(low_ms - low_over * (high_ms - low_ms) / (high_over - low_over), 0.001 * whole_ms, 0.999 * whole_ms);
    find_rate_limits(whole.segment, {from_ms, at_ms}, limits_, whole.accel_share, first_limits_);
    find_rate_limits(whole.segment, {from_ms + at_ms, whole_ms - at_ms}, limits_, whole.accel_share, second_limits_);
    rise = first_limits_.largest_end(x0, first_limits_.max_end_rate2);
    fall = second_limits_.largest_start(second_limits_.max_start_rate2, x1);
    const double over = rise.x1 - fall.x0;
    if (std::abs(over) <= kSamePeak * std::min(rise.x1, fall.x0)) break;
    if (i > 0 && (over < 0) == was_low) (was_low ? high_over : low_over) /= 2;
    was_low = over < 0;
    (was_low ? low_ms : high_ms) = at_ms;
    (was_low ? low_over : high_over) = over;
  }
  if (std::min(at_ms, whole_ms - at_ms) < kMinPart_ms) return false;
  const double peak = std::min(rise.x1, fall.x0);
  const bool faster = peak > x0 + (x1 - x0) * at_ms / whole_ms;
  if (!faster) return false;
  rise = first_limits_.largest_end(x0, peak);
  fall = second_limits_.largest_end(peak, x1);
  if (rise.x1 != peak || fall.x1 != x1) return false;
  emit_part(interval, {from_ms, at_ms}, rise, out);
  emit_part(interval, {from_ms + at_ms, whole_ms - at_ms}, fall, out);
  return true;
}

}  // namespace pmac::motion
