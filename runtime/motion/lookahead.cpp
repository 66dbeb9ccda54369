#include "runtime/motion/lookahead.h"

#include <algorithm>
#include <cmath>

namespace pmac::motion {
namespace {

/// Shorter parts of a segment are not worth a node.
constexpr double kMinPart_ms = 0.01;

/// Part of a segment from `from` on, `duration` long.
Segment part_of(const Segment& segment, double from_ms, double duration_ms) {
  Segment part = segment;
  part.start_ms += from_ms;
  part.duration_ms = duration_ms;
  for (MotorCubic& q : part.motor)
    q = {q.position(from_ms), q.velocity(from_ms), q.c2 + 3 * q.c3 * from_ms, q.c3};
  return part;
}

/// The segment run through with x from x0 to x1, in units of 1/scale^2; one of them is not zero.
TimedSegment timed(Segment segment, double scale, double x0, double x1) {
  const double rate0 = std::sqrt(x0) / scale, rate1 = std::sqrt(x1) / scale;
  TimedSegment result;
  result.duration_ms = 2 * segment.duration_ms / (rate0 + rate1);
  result.rate = rate0;
  result.rate_slope = (x1 - x0) / (2 * scale * scale * segment.duration_ms);
  result.segment = std::move(segment);
  return result;
}

}  // namespace

Lookahead::Lookahead(std::vector<MotorLimits> limits, int window)
    : limits_(std::move(limits)), window_(std::max(1, window)), chunk_(1 + window_ / 4) {}

void Lookahead::add(Segment segment, std::vector<TimedSegment>& out) {
  const double scale = scale_of(segment);
  RateLimits limits = rate_limits(segment, limits_, scale > 0 ? scale : 1);
  const double bound = start_bound(limits, scale);
  if (bound == 0 && !intervals_.empty() && intervals_.back().start_bound == 0) split_last();
  intervals_.push_back({std::move(segment), scale > 0 ? scale : 1, std::move(limits), bound, 0});
  if (waiting() < needed()) return;
  backward(0);
  commit(chunk_, 0, out);
}

void Lookahead::finish(std::vector<TimedSegment>& out) {
  if (!intervals_.empty()) {
    const bool steps = is_moving(intervals_.back().segment, true);
    if (steps && intervals_.back().start_bound == 0) split_last();
    const double end_beta = steps ? 0 : intervals_.back().limits.max_rate2;
    backward(end_beta);
    commit(waiting(), end_beta, out);
  }
  planned_ = 0;
  at_start_ = true;
}

/// Scale of a segment that is about to be appended; 0 where motion has to stop at its start.
double Lookahead::scale_of(const Segment& segment) const {
  if (intervals_.empty()) return is_moving(segment, false) ? 0 : 1;
  return intervals_.back().scale * speed_ratio(intervals_.back().segment, segment);
}

/// Largest x at its start, by itself and its predecessor.
double Lookahead::start_bound(const RateLimits& limits, double scale) const {
  if (scale == 0) return 0;
  return intervals_.empty() ? limits.max_rate2 : std::min(intervals_.back().limits.max_rate2, limits.max_rate2);
}

/// Motion has to stop at both ends of the last segment: in two halves it can move in between.
void Lookahead::split_last() {
  Interval whole = std::move(intervals_.back());
  intervals_.pop_back();
  planned_ = std::min(planned_, waiting());
  const double half_ms = whole.segment.duration_ms / 2;
  for (const double from_ms : {0.0, half_ms}) {
    Segment part = part_of(whole.segment, from_ms, half_ms);
    RateLimits limits = rate_limits(part, limits_, whole.scale);
    const double bound = from_ms == 0 ? 0 : limits.max_rate2;
    intervals_.push_back({std::move(part), whole.scale, std::move(limits), bound, 0});
  }
}

/// beta of every interval from the last one back, until a value comes out as it was: all before it stand as they are.
void Lookahead::backward(double end_beta) {
  double beta = end_beta;
  for (int i = waiting() - 1; i >= 0; --i) {
    Interval& interval = intervals_[static_cast<std::size_t>(i)];
    beta = interval.limits.largest_start(interval.start_bound, beta);
    if (i < planned_ && beta == interval.beta) break;
    interval.beta = beta;
  }
  planned_ = waiting();
}

void Lookahead::commit(int count, double end_beta, std::vector<TimedSegment>& out) {
  if (at_start_) rate2_ = intervals_.front().beta;
  at_start_ = false;
  for (int i = 0; i < count; ++i) {
    Interval interval = std::move(intervals_.front());
    intervals_.pop_front();
    --planned_;
    const double next_beta = intervals_.empty() ? end_beta : intervals_.front().beta;
    const double next = interval.limits.largest_end(rate2_, next_beta);
    const bool meets_beta = next == next_beta && rate2_ < interval.beta;
    const bool done = meets_beta && emit_with_switch(interval, rate2_, next, out);
    if (!done) out.push_back(timed(std::move(interval.segment), interval.scale, rate2_, next));
    rate2_ = next;
  }
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
  const auto limits_of = [&](const Segment& part) { return rate_limits(part, limits_, interval.scale); };
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
  out.push_back(timed(std::move(first), interval.scale, x0, peak));
  out.push_back(timed(std::move(second), interval.scale, peak, x1));
  return true;
}

}  // namespace pmac::motion
