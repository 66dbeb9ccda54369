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
void divide(const Segment& segment, double from_ms, double to_ms, double longest_ms, int halvings, std::vector<double>& ends_ms) {
  constexpr double kChange = 0.03;
  const bool even = to_ms - from_ms <= longest_ms && change_of_velocity(segment, from_ms, to_ms) <= kChange;
  if (halvings == 0 || even) return ends_ms.push_back(to_ms);
  const double middle_ms = (from_ms + to_ms) / 2;
  divide(segment, from_ms, middle_ms, longest_ms, halvings - 1, ends_ms);
  divide(segment, middle_ms, to_ms, longest_ms, halvings - 1, ends_ms);
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
    backward(0);
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
    backward(end_beta);
    while (known() > 0) commit_first(end_beta, out);
  }
  known_ms_ = 0;
  planned_ = 0;
  at_start_ = true;
}

/// In parts, where the velocity of the program changes much or a speed limit is far below it: x is linear over each, and may reach its
/// highest value between them.
void Lookahead::append(PreparedSegment prepared) {
  constexpr int kHalvings = 6;
  if (!may_be_limited(prepared.segment, limits_, prepared.accel_share)) return append_part(std::move(prepared));
  part_ends_ms_.clear();
  const double whole_ms = prepared.segment.duration_ms, slowest_rate = std::sqrt(rate_limits(prepared.segment, limits_, 1).max_rate2);
  divide(prepared.segment, 0, whole_ms, whole_ms * std::max(slowest_rate, 1e-6) * (1 + 1e-9), kHalvings, part_ends_ms_);   // each takes no longer than the segment at full rate
  if (part_ends_ms_.size() == 1) return append_part(std::move(prepared));
  double from_ms = 0;
  for (const double to_ms : part_ends_ms_) {
    PreparedSegment part{part_of(prepared.segment, from_ms, to_ms - from_ms)};
    part.accel_share = prepared.accel_share;
    if (from_ms == 0) {
      part.stops_at_start = prepared.stops_at_start;
      part.speed_ratio = prepared.speed_ratio;
      part.max_start_rate = prepared.max_start_rate;
    }
    append_part(std::move(part));
    from_ms = to_ms;
  }
}

void Lookahead::append_part(PreparedSegment prepared) {
  runtime::poll_interruption();
  Interval next{std::move(prepared.segment), prepared.accel_share, {}, prepared.speed_ratio * prepared.speed_ratio};
  next.limits = rate_limits(next.segment, limits_, next.accel_share);
  next.start_bound = std::min(next.limits.max_rate2, prepared.max_start_rate * prepared.max_start_rate);
  if (!intervals_.empty()) next.start_bound = std::min(next.start_bound, intervals_.back().limits.max_rate2 / next.speed_ratio2);
  if (prepared.stops_at_start) next.start_bound = 0;
  if (next.start_bound == 0 && !intervals_.empty() && intervals_.back().start_bound == 0) split_last();
  push(std::move(next));
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
  constexpr int kSteps = 30;
  const double whole_ms = interval.segment.duration_ms;
  const auto limits_of = [&](const Segment& part) { return rate_limits(part, limits_, interval.accel_share); };
  const auto rise = [&](double at_ms) {
    return limits_of(part_of(interval.segment, 0, at_ms)).largest_end(x0, interval.limits.max_rate2);
  };
  const auto fall = [&](double at_ms) {
    return limits_of(part_of(interval.segment, at_ms, whole_ms - at_ms)).largest_start(interval.limits.max_rate2, x1);
  };
  double low = 0, high = whole_ms;
  for (int i = 0; i < kSteps; ++i) {
    const double middle = (low + high) / 2;
    (rise(middle) < fall(middle) ? low : high) = middle;
  }
  if (std::min(low, whole_ms - low) < kMinPart_ms) return false;
  const double peak = std::min(rise(low), fall(low));
  Segment first = part_of(interval.segment, 0, low), second = part_of(interval.segment, low, whole_ms - low);
  const bool faster = peak > x0 + (x1 - x0) * low / whole_ms;
  if (!faster || !limits_of(first).allows(x0, peak) || !limits_of(second).allows(peak, x1)) return false;
  out.push_back(timed(std::move(first), x0, peak));
  out.push_back(timed(std::move(second), peak, x1));
  return true;
}

}  // namespace pmac::motion
