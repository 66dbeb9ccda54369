#include "runtime/motion/lookahead.h"

#include <algorithm>
#include <cmath>

#include "runtime/interruption.h"

namespace pmac::motion {
namespace {

/// Shorter parts of a segment are not worth a node.
constexpr double kMinPart_ms = 0.01;
/// x that could be reached at the end of a segment to x that may: where they are nearer there is nothing to gain within it.
constexpr double kWorthwhileRise = 1.02;
/// x from here on is full rate.
constexpr double kFullRate2 = 1 - 1e-9;

/// The limits may act in the segment: its own acceleration at full rate is not far from them, or a speed beyond. Elsewhere x is 1, or changes
/// as on a straight line.
bool may_be_limited(const Segment& segment, const std::vector<MotorLimits>& limits, double accel_share) {
  constexpr double kFar = 0.1;
  const double h = segment.duration_ms;
  for (std::size_t m = 0; m < std::min(segment.motor.size(), limits.size()); ++m) {
    const MotorCubic& q = segment.motor[m];
    const double accel = std::max(std::abs(q.acceleration(0)), std::abs(q.acceleration(h))), speed = limits[m].max_speed_mu_ms;
    if (accel * limits[m].inv_amax_ms2_mu > kFar * accel_share) return true;
    if (speed > 0 && std::max({std::abs(q.c1), std::abs(q.velocity(h / 2)), std::abs(q.velocity(h))}) > speed) return true;
  }
  return false;
}

/// How much velocities change over the part, in speeds of the fastest motor.
double change_of_velocity(const Segment& segment, double from_ms, double to_ms) {
  double change = 0, speed = 0;
  for (const MotorCubic& q : segment.motor) {
    const double begin = q.velocity(from_ms), middle = q.velocity((from_ms + to_ms) / 2), end = q.velocity(to_ms);
    change = std::max(change, std::max({begin, middle, end}) - std::min({begin, middle, end}));
    speed = std::max({speed, std::abs(begin), std::abs(middle), std::abs(end)});
  }
  return speed > 0 ? change / speed : 0;
}

/// Ends of the parts that a stretch of the segment is halved into until velocities change little over each, and none is longer than longest_ms.
void halve(const Segment& segment, double from_ms, double to_ms, double longest_ms, int halvings, std::vector<double>& ends_ms) {
  constexpr double kChange = 0.03;
  const bool even = to_ms - from_ms <= longest_ms && change_of_velocity(segment, from_ms, to_ms) <= kChange;
  if (halvings == 0 || even) return ends_ms.push_back(to_ms);
  const double middle_ms = (from_ms + to_ms) / 2;
  halve(segment, from_ms, middle_ms, longest_ms, halvings - 1, ends_ms);
  halve(segment, middle_ms, to_ms, longest_ms, halvings - 1, ends_ms);
}

/// Where a segment is divided: ends of the parts, the last is its own.
void find_parts(const Segment& segment, const RateLimits& limits, std::vector<double>& ends_ms) {
  constexpr int kHalvings = 6;
  const double whole_ms = segment.duration_ms, slowest_rate = std::sqrt(limits.max_rate2);
  ends_ms.clear();
  halve(segment, 0, whole_ms, whole_ms * std::max(slowest_rate, 1e-6) * (1 + 1e-9), kHalvings, ends_ms);   // each takes no longer than the segment at full rate
}

/// take(part, is it the first)
template <class Take>
void for_each_part(const Segment& segment, const std::vector<double>& ends_ms, const Take& take) {
  if (ends_ms.size() == 1) return take(segment, true);
  double from_ms = 0;
  for (const double to_ms : ends_ms) {
    take(part_of(segment, from_ms, to_ms - from_ms), from_ms == 0);
    from_ms = to_ms;
  }
}

bool stands_still(const Segment& segment) {
  return std::all_of(segment.motor.begin(), segment.motor.end(), [](const MotorCubic& q) { return q.c1 == 0 && q.c2 == 0 && q.c3 == 0; });
}

/// The segment run through with x from x0 to x1; one of them is not zero.
TimedSegment timed(Segment segment, double x0, double x1) {
  const double rate0 = std::sqrt(x0), rate1 = std::sqrt(x1);
  TimedSegment result;
  result.duration_ms = 2 * segment.duration_ms / (rate0 + rate1);
  result.rate = rate0;
  result.rate_slope = (x1 - x0) / (2 * segment.duration_ms);
  result.segment = std::move(segment);
  return result;
}

}  // namespace

Lookahead::Lookahead(std::vector<MotorLimits> limits, double window_ms, double servo_period_ms)
    : limits_(limits), window_ms_(window_ms), chunk_ms_(window_ms / 4), steps_(std::move(limits), servo_period_ms) {}

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
    while (known() > 1 && known_ms_ - intervals_.front().segment.duration_ms >= window_ms_) commit_first(0, out);
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
    const bool stops = is_moving(intervals_.back().segment, true);
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
  RateLimits limits = rate_limits(prepared.segment, limits_, prepared.accel_share);
  const bool may_matter = may_be_limited(prepared.segment, limits_, prepared.accel_share);
  const bool too_fast = may_matter && (limits.max_rate2 < 1 || !limits.allows(1, 1));
  if (too_fast) find_parts(prepared.segment, limits, part_ends_ms_);
  if (!too_fast || part_ends_ms_.size() == 1) return append_part(std::move(prepared), std::move(limits), may_matter && !too_fast);
  for_each_part(prepared.segment, part_ends_ms_, [&](Segment segment, bool is_first) {
    PreparedSegment part{std::move(segment)};
    part.accel_share = prepared.accel_share;
    if (is_first) {
      part.stops_at_start = prepared.stops_at_start;
      part.speed_ratio = prepared.speed_ratio;
      part.max_start_rate = prepared.max_start_rate;
    }
    RateLimits part_limits = rate_limits(part.segment, limits_, part.accel_share);
    append_part(std::move(part), std::move(part_limits), false);
  });
}

void Lookahead::append_part(PreparedSegment prepared, RateLimits limits, bool may_be_divided) {
  runtime::poll_interruption();
  Interval next{std::move(prepared.segment), prepared.accel_share, std::move(limits), prepared.speed_ratio * prepared.speed_ratio};
  next.may_be_divided = may_be_divided;
  next.start_bound = std::min(next.limits.max_rate2, prepared.max_start_rate * prepared.max_start_rate);
  if (!intervals_.empty()) next.start_bound = std::min(next.start_bound, intervals_.back().limits.max_rate2 / next.speed_ratio2);
  if (prepared.stops_at_start) next.start_bound = 0;
  if (next.start_bound == 0 && !intervals_.empty() && intervals_.back().start_bound == 0) split_last();
  push(std::move(next));
}

/// The interval in parts, each with its limits; what holds at its start holds at the start of the first.
void Lookahead::divide_interval(const Interval& whole, std::vector<Interval>& parts) {
  find_parts(whole.segment, whole.limits, part_ends_ms_);
  for_each_part(whole.segment, part_ends_ms_, [&](Segment segment, bool is_first) {
    Interval part{std::move(segment), whole.accel_share, {}, is_first ? whole.speed_ratio2 : 1};
    part.limits = rate_limits(part.segment, limits_, part.accel_share);
    part.start_bound = is_first ? whole.start_bound : part.limits.max_rate2;
    parts.push_back(std::move(part));
  });
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
  for (Interval& interval : taken_out_) intervals_.push_back(std::move(interval));
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

void Lookahead::push(Interval interval) {
  known_ms_ += interval.segment.duration_ms;
  intervals_.push_back(std::move(interval));
}

/// Motion has to stop at both ends of the last segment: in two halves it can move in between.
void Lookahead::split_last() {
  const Interval whole = std::move(intervals_.back());
  intervals_.pop_back();
  known_ms_ -= whole.segment.duration_ms;
  planned_ = std::min(planned_, known());
  const double half_ms = whole.segment.duration_ms / 2;
  for (const double from_ms : {0.0, half_ms}) {
    Interval half{part_of(whole.segment, from_ms, half_ms), whole.accel_share, {}, from_ms == 0 ? whole.speed_ratio2 : 1};
    half.limits = rate_limits(half.segment, limits_, half.accel_share);
    half.start_bound = from_ms == 0 ? 0 : half.limits.max_rate2;
    half.may_be_divided = whole.may_be_divided;
    push(std::move(half));
  }
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
  if (at_start_) rate2_ = intervals_.front().beta;
  at_start_ = false;
  Interval interval = std::move(intervals_.front());
  intervals_.pop_front();
  --planned_;
  known_ms_ -= interval.segment.duration_ms;
  const double ratio2 = intervals_.empty() ? 1 : intervals_.front().speed_ratio2;
  const double next_beta = intervals_.empty() ? end_beta : intervals_.front().beta * ratio2;
  const double next = interval.limits.largest_end(rate2_, std::min(next_beta, interval.limits.max_rate2));
  const bool meets_beta = next == next_beta && (rate2_ < interval.beta || interval.beta == interval.start_bound);
  const bool worthwhile = meets_beta && interval.limits.largest_end(rate2_, interval.limits.max_rate2) > kWorthwhileRise * next;
  const bool done = worthwhile && emit_with_switch(interval, rate2_, next, out);
  if (!done) out.push_back(timed(std::move(interval.segment), rate2_, next));
  rate2_ = next / ratio2;
}

/// Within this segment motion changes from speeding up to slowing down. One more node where the two meet makes both complete:
///
///      x       /\              rising as the first part allows, falling as the second part asks
///     x0  ___/    \___ x1
///
/// False where that is no faster; nothing is appended then.
bool Lookahead::emit_with_switch(const Interval& interval, double x0, double x1, std::vector<TimedSegment>& out) const {
  constexpr int kSteps = 20;
  constexpr double kSamePeak = 1e-4;
  const double whole_ms = interval.segment.duration_ms, highest = interval.limits.max_rate2;
  double low_ms = 0, low_over = x0 - interval.limits.largest_start(highest, x1);         // what can be reached over what may be: below 0 at the start,
  double high_ms = whole_ms, high_over = interval.limits.largest_end(x0, highest) - x1;  // above 0 at the end
  if (low_over >= 0 || high_over <= 0) return false;
  Segment first, second;
  RateLimits first_limits, second_limits;
  double at_ms = 0, peak = 0;
  bool was_low = false;
  for (int i = 0; i < kSteps; ++i) {  // false position; an end that stays counts half (Illinois)
    at_ms = std::clamp(low_ms - low_over * (high_ms - low_ms) / (high_over - low_over), 0.001 * whole_ms, 0.999 * whole_ms);
    first = part_of(interval.segment, 0, at_ms);
    second = part_of(interval.segment, at_ms, whole_ms - at_ms);
    first_limits = rate_limits(first, limits_, interval.accel_share);
    second_limits = rate_limits(second, limits_, interval.accel_share);
    const double reached = first_limits.largest_end(x0, highest), allowed = second_limits.largest_start(highest, x1), over = reached - allowed;
    peak = std::min(reached, allowed);
    if (std::abs(over) <= kSamePeak * peak) break;
    if (i > 0 && (over < 0) == was_low) (was_low ? high_over : low_over) /= 2;
    was_low = over < 0;
    (was_low ? low_ms : high_ms) = at_ms;
    (was_low ? low_over : high_over) = over;
  }
  if (std::min(at_ms, whole_ms - at_ms) < kMinPart_ms) return false;
  const bool faster = peak > x0 + (x1 - x0) * at_ms / whole_ms;
  if (!faster || !first_limits.allows(x0, peak) || !second_limits.allows(peak, x1)) return false;
  out.push_back(timed(std::move(first), x0, peak));
  out.push_back(timed(std::move(second), peak, x1));
  return true;
}

}  // namespace pmac::motion
