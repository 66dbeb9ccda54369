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
/// x from here on is full rate.
constexpr double kFullRate2 = 1 - 1e-9;
/// x that differs by less is the same where motion turns from speeding up to slowing down.
constexpr double kSamePeak = 1e-4;

bool stands_still(const Segment& segment) {
  return std::all_of(segment.motor.begin(), segment.motor.end(), [](const MotorCubic& q) { return q.c1 == 0 && q.c2 == 0 && q.c3 == 0; });
}

}  // namespace

Lookahead::Lookahead(std::vector<MotorLimits> limits, double window_ms, double servo_period_ms, double shortest_part_ms)
    : limits_(limits), window_ms_(window_ms), chunk_ms_(window_ms / 4), shortest_part_ms_(shortest_part_ms), steps_(std::move(limits), servo_period_ms) {}

void Lookahead::add(Segment segment, std::vector<TimedSegment>& out) {
  steps_.add(std::move(segment), prepared_);
  for (PreparedSegment& prepared : prepared_) {
    if (stands_still(prepared.segment)) {
      rest(std::move(prepared.segment), out);
      continue;
    }
    append(std::move(prepared));
    if (known_ms_ < window_ms_ + chunk_ms_) continue;
    plan(0);
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
    const double end_beta = stops ? 0 : intervals_.back().limits.max_rate2;
    plan(end_beta);
    while (known() > 0) commit_first(end_beta, out);
  }
  known_ms_ = 0;
  planned_ = 0;
  at_start_ = true;
}

/// In parts, where the program is certainly too fast: x is linear over each, and may reach its highest value between them. Elsewhere the
/// limits may turn out not to matter; plan() and divide_first() do it where they do.
void Lookahead::append(PreparedSegment prepared) {
  Whole& whole = wholes_.extend();
  whole.segment = std::move(prepared.segment);
  whole.accel_share = prepared.accel_share;
  whole.parts = 0;
  const Segment& segment = whole.segment;
  const Stretch all{0, segment.duration_ms};
  const Start start{prepared.speed_ratio, prepared.max_start_rate, prepared.stops_at_start}, inside{1, std::numeric_limits<double>::infinity(), false};
  find_rate_limits(segment, all, limits_, whole.accel_share, first_limits_);
  const bool may_matter = !first_limits_.is_even && may_be_limited(segment, limits_, whole.accel_share);
  const bool too_fast = may_matter && (first_limits_.max_rate2 < 1 || !first_limits_.allows(1, 1));
  if (!too_fast) return append_interval(all, &first_limits_, start, may_matter);
  find_parts(segment, all, first_limits_, {limits_, whole.accel_share, shortest_part_ms_}, part_ends_ms_);
  if (part_ends_ms_.size() == 1) return append_interval(all, &first_limits_, start, false);
  double from_ms = 0;
  for (const double to_ms : part_ends_ms_) {
    append_interval({from_ms, to_ms - from_ms}, nullptr, from_ms == 0 ? start : inside, false);
    from_ms = to_ms;
  }
}

/// Of the newest segment. limits: where they are known.
void Lookahead::append_interval(const Stretch& stretch, const RateLimits* limits, const Start& start, bool may_be_divided) {
  runtime::poll_interruption();
  const Interval* const before = intervals_.empty() ? nullptr : &intervals_.back();
  const double max_before = before ? before->limits.max_rate2 : 0, ratio2 = start.speed_ratio * start.speed_ratio;
  if (before && before->start_bound == 0 && start.stops) split_last();
  const bool follows = before != nullptr;
  Interval& next = intervals_.extend();
  next.whole = first_whole_ + wholes_.size() - 1;
  next.stretch = stretch;
  next.speed_ratio2 = ratio2;
  next.beta = 0;
  next.may_be_divided = may_be_divided;
  if (limits) next.limits = *limits;
  else find_limits(next);
  next.start_bound = start.stops ? 0 : std::min(next.limits.max_rate2, start.max_rate * start.max_rate);
  if (follows) next.start_bound = std::min(next.start_bound, max_before / ratio2);
  ++wholes_.back().parts;
  known_ms_ += stretch.duration_ms;
}

void Lookahead::find_limits(Interval& interval) const {
  const Whole& whole = whole_of(interval);
  find_rate_limits(whole.segment, interval.stretch, limits_, whole.accel_share, interval.limits);
}

void Lookahead::find_parts_of(const Interval& interval) {
  const Whole& whole = whole_of(interval);
  find_parts(whole.segment, interval.stretch, interval.limits, {limits_, whole.accel_share, shortest_part_ms_}, part_ends_ms_);
}

/// Appends the interval in parts, each with its limits; what holds at its start holds at the start of the first.
void Lookahead::divide_interval(const Interval& interval, std::vector<Interval>& parts) {
  find_parts_of(interval);
  whole_of(interval).parts += static_cast<int>(part_ends_ms_.size()) - 1;
  double from_ms = interval.stretch.from_ms;
  for (const double to_ms : part_ends_ms_) {
    const bool is_first = from_ms == interval.stretch.from_ms;
    Interval& part = parts.emplace_back();
    part.whole = interval.whole;
    part.stretch = {from_ms, to_ms - from_ms};
    part.speed_ratio2 = is_first ? interval.speed_ratio2 : 1;
    find_limits(part);
    part.start_bound = is_first ? interval.start_bound : part.limits.max_rate2;
    from_ms = to_ms;
  }
}

/// Motion is not at full rate at both ends of interval i, as far as stops ahead tell.
bool Lookahead::is_slowed(int i, double end_beta) const {
  const auto at = static_cast<std::size_t>(i);
  const double end = i + 1 < known() ? intervals_[at + 1].beta * intervals_[at + 1].speed_ratio2 : end_beta;
  return intervals_[at].beta < kFullRate2 || end < kFullRate2;
}

/// beta of all intervals, of which the slowed ones are divided.
void Lookahead::plan(double end_beta) {
  int first = planned_;
  backward(end_beta);
  const auto needs_parts = [&](int i) { return intervals_[static_cast<std::size_t>(i)].may_be_divided && is_slowed(i, end_beta); };
  while (first < known() && !needs_parts(first)) ++first;
  if (first == known()) return;
  taken_out_.clear();
  for (int i = first; i < known(); ++i) {
    Interval& interval = intervals_[static_cast<std::size_t>(i)];
    if (needs_parts(i)) divide_interval(interval, taken_out_);
    else taken_out_.push_back(std::move(interval));
  }
  intervals_.shrink(static_cast<std::size_t>(first));
  for (Interval& interval : taken_out_) intervals_.extend() = std::move(interval);
  planned_ = first;
  backward(end_beta);
}

/// Motion comes to it slowly: it speeds up on parts.
void Lookahead::divide_first(double end_beta) {
  taken_out_.clear();
  divide_interval(intervals_.front(), taken_out_);
  intervals_.pop_front();
  double beta = intervals_.empty() ? end_beta : intervals_.front().beta * intervals_.front().speed_ratio2;
  while (!taken_out_.empty()) {
    Interval& part = taken_out_.back();
    part.beta = part.limits.largest_start(part.start_bound, std::min(beta, part.limits.max_rate2));
    beta = part.beta * part.speed_ratio2;
    intervals_.push_front(std::move(part));
    taken_out_.pop_back();
    ++planned_;
  }
  --planned_;
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
  second.start_bound = second.limits.max_rate2;
  ++whole_of(second).parts;
  intervals_.extend() = std::move(second);
}

/// beta of every interval from the last one back, until a value comes out as it was: all before it stand as they are.
void Lookahead::backward(double end_beta) {
  double beta = end_beta;  // of x at the end of interval i
  for (int i = known() - 1; i >= 0; --i) {
    Interval& interval = intervals_[static_cast<std::size_t>(i)];
    const double start = interval.limits.largest_start(interval.start_bound, std::min(beta, interval.limits.max_rate2));
    if (i < planned_ && start == interval.beta) break;
    interval.beta = start;
    beta = start * interval.speed_ratio2;
  }
  planned_ = known();
}

void Lookahead::commit_first(double end_beta, std::vector<TimedSegment>& out) {
  runtime::poll_interruption();
  if (intervals_.front().may_be_divided && (is_slowed(0, end_beta) || (!at_start_ && rate2_ < kFullRate2))) divide_first(end_beta);
  const Interval& interval = intervals_.front();
  if (at_start_) rate2_ = interval.beta;
  at_start_ = false;
  const double ratio2 = known() > 1 ? intervals_[1].speed_ratio2 : 1;
  const double next_beta = known() > 1 ? intervals_[1].beta * ratio2 : end_beta;
  const double next = interval.limits.largest_end(rate2_, std::min(next_beta, interval.limits.max_rate2));
  const bool meets_beta = next == next_beta && (rate2_ < interval.beta || interval.beta == interval.start_bound);
  emit(interval, rate2_, next, meets_beta, out);
  rate2_ = next / ratio2;
  known_ms_ -= interval.stretch.duration_ms;
  --planned_;
  if (--whole_of(interval).parts == 0) {
    wholes_.pop_front();
    ++first_whole_;
  }
  intervals_.pop_front();
}

/// may_switch: x may rise above both ends on the way.
void Lookahead::emit(const Interval& interval, double x0, double x1, bool may_switch, std::vector<TimedSegment>& out) {
  if (interval.limits.is_even) return emit_even(interval, x0, x1, out);
  const bool worthwhile = may_switch && interval.limits.largest_end(x0, interval.limits.max_rate2) > kWorthwhileRise * x1;
  if (!worthwhile || !emit_with_switch(interval, x0, x1, out)) emit_part(interval, interval.stretch, x0, x1, out);
}

/// A stretch of the interval's segment that is run through with x from x0 to x1; one of them is not zero.
void Lookahead::emit_part(const Interval& interval, const Stretch& stretch, double x0, double x1, std::vector<TimedSegment>& out) const {
  const double rate0 = std::sqrt(x0), rate1 = std::sqrt(x1);
  TimedSegment& timed = out.emplace_back();
  take_part(whole_of(interval).segment, stretch.from_ms, stretch.duration_ms, timed.segment);
  timed.duration_ms = 2 * stretch.duration_ms / (rate0 + rate1);
  timed.rate = rate0;
  timed.rate_slope = (x1 - x0) / (2 * stretch.duration_ms);
}

/// Straight at constant programmed speed: x rises as the limits allow to the highest value or until it has to fall.
///
///      x        ________
///     x0  ___/          \___ x1
void Lookahead::emit_even(const Interval& interval, double x0, double x1, std::vector<TimedSegment>& out) const {
  const Stretch& all = interval.stretch;
  const double width = interval.limits.bands.empty() ? std::numeric_limits<double>::infinity() : interval.limits.bands[0].width;
  const double meeting = (x0 + x1 + width) / 2, peak = std::min(interval.limits.max_rate2, meeting), ms_per_x = all.duration_ms / width;
  double rise_ms = (peak - x0) * ms_per_x, fall_ms = (peak - x1) * ms_per_x, flat_ms = 0;
  const bool stays = meeting > peak;   // at its highest value for some time
  if (stays) {
    if (rise_ms < kMinPart_ms) rise_ms = peak - x0 > kSamePeak * peak ? kMinPart_ms : 0;
    if (fall_ms < kMinPart_ms) fall_ms = peak - x1 > kSamePeak * peak ? kMinPart_ms : 0;
    flat_ms = all.duration_ms - rise_ms - fall_ms;
    if (flat_ms > 0 && flat_ms < kMinPart_ms) (rise_ms > fall_ms ? rise_ms : fall_ms) += std::exchange(flat_ms, 0.0);
  }
  const bool is_one = stays ? flat_ms < 0 : std::min(rise_ms, fall_ms) < kMinPart_ms;
  if (is_one || flat_ms == all.duration_ms) return emit_part(interval, all, x0, x1, out);
  const double fall_from_ms = rise_ms + flat_ms;
  if (rise_ms > 0) emit_part(interval, {all.from_ms, rise_ms}, x0, fall_from_ms < all.duration_ms || flat_ms > 0 ? peak : x1, out);
  if (flat_ms > 0) emit_part(interval, {all.from_ms + rise_ms, flat_ms}, rise_ms > 0 ? peak : x0, fall_ms > 0 ? peak : x1, out);
  if (fall_ms > 0) emit_part(interval, {all.from_ms + fall_from_ms, all.duration_ms - fall_from_ms}, fall_from_ms > 0 ? peak : x0, x1, out);
}

/// Within this interval motion changes from speeding up to slowing down. One more node where the two meet makes both complete:
///
///      x       /\              rising as the first part allows, falling as the second part asks
///     x0  ___/    \___ x1
///
/// False where that is no faster; nothing is appended then.
bool Lookahead::emit_with_switch(const Interval& interval, double x0, double x1, std::vector<TimedSegment>& out) {
  constexpr int kSteps = 20;
  const Whole& whole = whole_of(interval);
  const double from_ms = interval.stretch.from_ms, whole_ms = interval.stretch.duration_ms, highest = interval.limits.max_rate2;
  double low_ms = 0, low_over = x0 - interval.limits.largest_start(highest, x1);         // what can be reached over what may be: below 0 at the start,
  double high_ms = whole_ms, high_over = interval.limits.largest_end(x0, highest) - x1;  // above 0 at the end
  if (low_over >= 0 || high_over <= 0) return false;
  double at_ms = 0, peak = 0;
  bool was_low = false;
  for (int i = 0; i < kSteps; ++i) {  // false position; an end that stays counts half (Illinois)
    at_ms = std::clamp(low_ms - low_over * (high_ms - low_ms) / (high_over - low_over), 0.001 * whole_ms, 0.999 * whole_ms);
    find_rate_limits(whole.segment, {from_ms, at_ms}, limits_, whole.accel_share, first_limits_);
    find_rate_limits(whole.segment, {from_ms + at_ms, whole_ms - at_ms}, limits_, whole.accel_share, second_limits_);
    const double reached = first_limits_.largest_end(x0, highest), allowed = second_limits_.largest_start(highest, x1), over = reached - allowed;
    peak = std::min(reached, allowed);
    if (std::abs(over) <= kSamePeak * peak) break;
    if (i > 0 && (over < 0) == was_low) (was_low ? high_over : low_over) /= 2;
    was_low = over < 0;
    (was_low ? low_ms : high_ms) = at_ms;
    (was_low ? low_over : high_over) = over;
  }
  if (std::min(at_ms, whole_ms - at_ms) < kMinPart_ms) return false;
  const bool faster = peak > x0 + (x1 - x0) * at_ms / whole_ms;
  if (!faster || !first_limits_.allows(x0, peak) || !second_limits_.allows(peak, x1)) return false;
  emit_part(interval, {from_ms, at_ms}, x0, peak, out);
  emit_part(interval, {from_ms + at_ms, whole_ms - at_ms}, peak, x1, out);
  return true;
}

}  // namespace pmac::motion
