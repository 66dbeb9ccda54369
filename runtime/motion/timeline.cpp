#include "runtime/motion/timeline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace pmac::motion {
namespace {

constexpr std::size_t kBlock = 64;  // samples evaluated together

constexpr std::size_t kFew = 6;      // samples of a segment for which the preparations of a vectorised loop are not worth it

double end_of(const TimedSegment& segment) { return segment.start_ms + segment.duration_ms; }

/// Programmed time of a segment t after its start; it stands at its ends.
double programmed_inside(const TimedSegment& segment, double t) {
  const double d = segment.programmed_ms(t), end = segment.segment.duration_ms;
  return t <= 0 ? 0 : d < end ? d : end;
}

}  // namespace

void Timeline::reset(std::vector<double> position_mu, double time_ms) {
  known_.clear();
  cursor_ = 0;
  end_ms_ = sampled_ms_ = time_ms;
  set_rest(std::move(position_mu));
}

void Timeline::set_rest(std::vector<double> position_mu) {
  rest_mu_ = std::move(position_mu);
  end_velocity_mu_ms_.clear();
  end_is_noted_ = true;
}

void Timeline::push(TimedSegment&& segment) {
  end_ms_ = end_of(segment);
  const double programmed_ms = segment.segment.duration_ms;
  Known& known = known_.extend();
  known.timed = std::move(segment);
  known.programmed_ms = programmed_end_ms_;
  programmed_end_ms_ += programmed_ms;
  end_is_noted_ = false;
}

Segment& Timeline::extend(double start_ms, double duration_ms) {
  Known& known = known_.extend();
  TimedSegment& timed = known.timed;
  timed.start_ms = start_ms;
  timed.duration_ms = timed.segment.duration_ms = duration_ms;
  timed.rate = 1;
  timed.rate_slope = timed.jerk_step = timed.segment.passed_ms = 0;
  known.programmed_ms = programmed_end_ms_;
  programmed_end_ms_ += duration_ms;
  end_ms_ = start_ms + duration_ms;
  end_is_noted_ = false;
  return timed.segment;
}

/// Where the last segment ends, and how fast.
void Timeline::note_end() {
  if (std::exchange(end_is_noted_, true)) return;
  const TimedSegment& last = known_.back().timed;
  const double rate = last.rate_at(last.duration_ms), programmed_ms = last.segment.duration_ms;
  end_velocity_mu_ms_.resize(rest_mu_.size());
  for (std::size_t m = 0; m < rest_mu_.size(); ++m) {
    rest_mu_[m] = last.segment.motor[m].position(programmed_ms);
    end_velocity_mu_ms_[m] = rate * last.segment.motor[m].velocity(programmed_ms);
  }
}

std::size_t Timeline::first_ending_after(double time_ms) const {
  return known_.first_not([&](const Known& k) { return end_of(k.timed) <= time_ms; });
}

void Timeline::prune() {
  std::size_t kept = 0;
  if (history_ms_ > 0 && cursor_ > 0) {
    const double oldest_ms = (cursor_ < known_.size() ? known_[cursor_].programmed_ms : programmed_end_ms_) - history_ms_;
    const std::size_t first = std::min(cursor_, known_.first_not([&](const Known& k) { return k.programmed_ms <= oldest_ms; }));
    kept = cursor_ - (first > 0 ? first - 1 : 0);
  }
  if (cursor_ - kept == known_.size()) note_end();
  for (; cursor_ > kept; --cursor_) known_.pop_front();
}

double Timeline::history_start_ms(double time_ms, double amount_ms) const {
  const std::size_t at = first_ending_after(time_ms);
  double wanted_ms = programmed_end_ms_ - amount_ms;
  if (at < known_.size()) wanted_ms = known_[at].programmed_ms + known_[at].timed.programmed_ms(std::max(0.0, time_ms - known_[at].timed.start_ms)) - amount_ms;
  const std::size_t beyond = known_.first_not([&](const Known& k) { return k.programmed_ms <= wanted_ms; });
  if (beyond == 0) return oldest_ms();
  const Known& first = known_[beyond - 1];
  return first.timed.start_ms + time_at(first.timed, std::min(wanted_ms - first.programmed_ms, first.timed.segment.duration_ms));
}

double Timeline::programmed_after(double time_ms) const {
  const std::size_t first = known_.first_not([&](const Known& k) { return k.timed.start_ms < time_ms; });
  return first == known_.size() ? 0 : programmed_end_ms_ - known_[first].programmed_ms;
}

double Timeline::programmed_until_ms(double amount_ms) const {
  const std::size_t beyond = known_.first_not([&](const Known& k) { return k.programmed_ms <= programmed_end_ms_ - amount_ms; });
  return beyond == 0 ? -std::numeric_limits<double>::infinity() : known_[beyond - 1].timed.start_ms;
}

SourceLine Timeline::source_at(double time_ms) const {
  const std::size_t next = first_ending_after(time_ms);
  return next == known_.size() || known_[next].timed.start_ms > time_ms ? SourceLine{} : known_[next].timed.segment.source;
}

void Timeline::sample(std::span<const double> time_ms, std::span<double> position_mu, std::span<double> velocity_mu_ms) {
  const std::size_t count = time_ms.size();
  for (std::size_t done = 0; done < count;) {
    stand_at(time_ms[done]);
    const bool is_over = cursor_ == known_.size();
    if (!is_over && velocity_mu_ms.empty() && are_few(known_[cursor_].timed, time_ms, done)) {
      done = sample_few(known_[cursor_].timed, time_ms, done, position_mu);
      continue;
    }
    const std::size_t last = is_over ? rest_until(time_ms, done) : segment_until(known_[cursor_].timed, time_ms, done);
    if (is_over) sample_rest(time_ms, done, last, position_mu, velocity_mu_ms);
    else sample_segment(known_[cursor_].timed, time_ms, done, last, position_mu, velocity_mu_ms);
    done = last;
  }
  if (count > 0) sampled_ms_ = time_ms.back();
}

void Timeline::pass(double time_ms) {
  stand_at(time_ms);
  sampled_ms_ = time_ms;
}

/// Backwards where the path is retraced, or a run was cut short.
void Timeline::stand_at(double time_ms) {
  while (cursor_ > 0 && end_of(known_[cursor_ - 1].timed) > time_ms) --cursor_;
  while (cursor_ < known_.size() && end_of(known_[cursor_].timed) <= time_ms) ++cursor_;
}

/// Of ascending times, from `first` on, no more than kFew lie before the end of the segment.
bool Timeline::are_few(const TimedSegment& segment, std::span<const double> time_ms, std::size_t first) {
  return first + kFew >= time_ms.size() || time_ms[first + kFew] >= end_of(segment);
}

/// Positions at those times, one after the other; answers one behind the last of them.
std::size_t Timeline::sample_few(const TimedSegment& segment, std::span<const double> time_ms, std::size_t first, std::span<double> position_mu) {
  const std::size_t count = time_ms.size(), most = std::min(count, first + kFew);
  const double end_ms = end_of(segment), first_ms = time_ms[first];
  std::size_t at = first;
  do {
    const double d = programmed_inside(segment, time_ms[at] - segment.start_ms);
    double* position = position_mu.data() + at;
    for (const MotorCubic& q : segment.segment.motor) {
      *position = q.position(d);
      position += count;
    }
    ++at;
  } while (at < most && time_ms[at] < end_ms && time_ms[at] >= first_ms);
  return at;
}

/// One behind the last of the ascending times, from `first` on, that lies before the end of the segment; at most kBlock of them.
std::size_t Timeline::segment_until(const TimedSegment& segment, std::span<const double> time_ms, std::size_t first) const {
  const std::size_t most = std::min(time_ms.size(), first + kBlock);
  const double start_ms = time_ms[first], end_ms = end_of(segment);
  std::size_t last = first + 1;
  while (last < most && time_ms[last] < end_ms && time_ms[last] >= start_ms) ++last;
  return last;
}

/// One behind the last of the times, from `first` on, that lies behind all segments.
std::size_t Timeline::rest_until(std::span<const double> time_ms, std::size_t first) {
  note_end();
  std::size_t last = first + 1;
  while (last < time_ms.size() && time_ms[last] >= time_ms[first]) ++last;
  return last;
}

void Timeline::peek(double time_ms, std::span<double> position_mu) const {
  std::size_t at = first_ending_after(time_ms);
  if (at == known_.size() && end_is_noted_) {
    std::copy(rest_mu_.begin(), rest_mu_.end(), position_mu.begin());
    return;
  }
  const bool is_over = at == known_.size();
  const TimedSegment& timed = known_[is_over ? at - 1 : at].timed;
  const double d = is_over ? timed.segment.duration_ms : std::clamp(timed.programmed_ms(time_ms - timed.start_ms), 0.0, timed.segment.duration_ms);
  for (std::size_t m = 0; m < position_mu.size(); ++m) position_mu[m] = timed.segment.motor[m].position(d);
}

/// Samples first..last-1, none after the end of the segment; before its start it stands at its first point.
void Timeline::sample_segment(const TimedSegment& segment, std::span<const double> time_ms, std::size_t first, std::size_t last,
                              std::span<double> position_mu, std::span<double> velocity_mu_ms) const {
  std::array<double, kBlock> at;  // programmed time since its start; filled as far as it is read
  const std::size_t n = last - first, count = time_ms.size();
  const double segment_ms = segment.start_ms, end = segment.segment.duration_ms, rate = segment.rate, half_slope = segment.rate_slope / 2;
  const double* time = time_ms.data() + first;
  const bool is_even = segment.slope_growth == 0;
  for (std::size_t k = 0; k < n; ++k) {
    const double t = time[k] - segment_ms, d = is_even ? t * (rate + t * half_slope) : segment.programmed_ms(t), inside = d < end ? d : end;
    at[k] = t <= 0 ? 0 : inside;
  }
  for (std::size_t m = 0; m < segment.segment.motor.size(); ++m) {
    const MotorCubic q = segment.segment.motor[m];
    double* position = position_mu.data() + m * count + first;
    for (std::size_t k = 0; k < n; ++k) position[k] = q.position(at[k]);
    if (velocity_mu_ms.empty()) continue;
    double* velocity = velocity_mu_ms.data() + m * count + first;
    for (std::size_t k = 0; k < n; ++k) {
      const double t = time[k] - segment_ms;
      velocity[k] = q.velocity(at[k]) * (t < 0 ? 0 : segment.rate_at(t));
    }
  }
}

/// Samples first..last-1, after the last segment. The very end of it still has its velocity.
void Timeline::sample_rest(std::span<const double> time_ms, std::size_t first, std::size_t last, std::span<double> position_mu,
                           std::span<double> velocity_mu_ms) const {
  const bool at_end = time_ms[first] == end_ms_ && !end_velocity_mu_ms_.empty();
  for (std::size_t m = 0; m < rest_mu_.size(); ++m) {
    const std::size_t row = m * time_ms.size();
    std::fill(position_mu.data() + row + first, position_mu.data() + row + last, rest_mu_[m]);
    if (velocity_mu_ms.empty()) continue;
    std::fill(velocity_mu_ms.data() + row + first, velocity_mu_ms.data() + row + last, 0.0);
    if (at_end) velocity_mu_ms[row + first] = end_velocity_mu_ms_[m];
  }
}

}  // namespace pmac::motion
