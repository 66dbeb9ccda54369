#include "runtime/motion/timeline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace pmac::motion {
namespace {

constexpr int kBlock = 64;  // samples evaluated together

double end_of(const TimedSegment& segment) { return segment.start_ms + segment.duration_ms; }

}  // namespace

void Timeline::reset(std::vector<double> position_mu, double time_ms) {
  segments_.clear();
  programmed_ms_.clear();
  cursor_ = 0;
  end_ms_ = sampled_ms_ = time_ms;
  rest_mu_ = std::move(position_mu);
  end_velocity_mu_ms_.clear();
}

void Timeline::set_rest(std::vector<double> position_mu) {
  rest_mu_ = std::move(position_mu);
  end_velocity_mu_ms_.clear();
}

void Timeline::push(TimedSegment segment) {
  end_ms_ = end_of(segment);
  const double rate = segment.rate + segment.rate_slope * segment.duration_ms, programmed_ms = segment.segment.duration_ms;
  end_velocity_mu_ms_.resize(rest_mu_.size());
  for (std::size_t m = 0; m < rest_mu_.size(); ++m) {
    rest_mu_[m] = segment.segment.motor[m].position(programmed_ms);
    end_velocity_mu_ms_[m] = rate * segment.segment.motor[m].velocity(programmed_ms);
  }
  programmed_ms_.push_back(programmed_end_ms_);
  programmed_end_ms_ += segment.segment.duration_ms;
  segments_.push_back(std::move(segment));
}

void Timeline::prune() {
  std::size_t kept = 0;
  if (history_ms_ > 0 && cursor_ > 0) {
    const double reached_ms = cursor_ < programmed_ms_.size() ? programmed_ms_[cursor_] : programmed_end_ms_;
    const auto first = std::upper_bound(programmed_ms_.begin(), programmed_ms_.begin() + static_cast<std::ptrdiff_t>(cursor_), reached_ms - history_ms_);
    kept = cursor_ - static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, first - programmed_ms_.begin() - 1));
  }
  const auto gone = static_cast<std::ptrdiff_t>(cursor_ - kept);
  segments_.erase(segments_.begin(), segments_.begin() + gone);
  programmed_ms_.erase(programmed_ms_.begin(), programmed_ms_.begin() + gone);
  cursor_ = kept;
}

double Timeline::history_start_ms(double time_ms, double amount_ms) const {
  const auto at = std::partition_point(segments_.begin(), segments_.end(), [&](const TimedSegment& s) { return end_of(s) <= time_ms; });
  const double reached_ms = at == segments_.end() ? programmed_end_ms_ : programmed_ms_[static_cast<std::size_t>(at - segments_.begin())];
  const auto first = std::lower_bound(programmed_ms_.begin(), programmed_ms_.end(), reached_ms - amount_ms);
  return first == programmed_ms_.end() ? oldest_ms() : segments_[static_cast<std::size_t>(first - programmed_ms_.begin())].start_ms;
}

double Timeline::programmed_after(double time_ms) const {
  const auto first = std::partition_point(segments_.begin(), segments_.end(), [&](const TimedSegment& s) { return s.start_ms < time_ms; });
  return first == segments_.end() ? 0 : programmed_end_ms_ - programmed_ms_[static_cast<std::size_t>(first - segments_.begin())];
}

double Timeline::programmed_until_ms(double amount_ms) const {
  const auto beyond = std::upper_bound(programmed_ms_.begin(), programmed_ms_.end(), programmed_end_ms_ - amount_ms);
  if (beyond == programmed_ms_.begin()) return -std::numeric_limits<double>::infinity();
  return segments_[static_cast<std::size_t>(beyond - programmed_ms_.begin()) - 1].start_ms;
}

SourceLine Timeline::source_at(double time_ms) const {
  const auto next = std::partition_point(segments_.begin(), segments_.end(), [&](const TimedSegment& s) { return end_of(s) <= time_ms; });
  return next == segments_.end() || next->start_ms > time_ms ? SourceLine{} : next->segment.source;
}

void Timeline::sample(double start_ms, double period_ms, int count, std::span<double> position_mu, std::span<double> velocity_mu_ms) {
  int done = 0;
  while (cursor_ > 0 && count > 0 && end_of(segments_[cursor_ - 1]) > start_ms) --cursor_;  // the path is retraced, or a run was cut short
  while (done < count) {
    const double time_ms = start_ms + done * period_ms;
    while (cursor_ < segments_.size() && end_of(segments_[cursor_]) <= time_ms) ++cursor_;
    if (cursor_ == segments_.size()) {
      sample_rest(time_ms, done, count, position_mu, velocity_mu_ms);
      break;
    }
    const TimedSegment& segment = segments_[cursor_];
    int last = done + 1;
    while (last < count && last - done < kBlock && start_ms + last * period_ms < end_of(segment)) ++last;
    sample_segment(segment, start_ms, period_ms, done, last, count, position_mu, velocity_mu_ms);
    done = last;
  }
  if (count > 0) sampled_ms_ = start_ms + (count - 1) * period_ms;
}

void Timeline::peek(double time_ms, std::span<double> position_mu) const {
  const auto at = std::partition_point(segments_.begin(), segments_.end(), [&](const TimedSegment& s) { return end_of(s) <= time_ms; });
  if (at == segments_.end()) {
    std::copy(rest_mu_.begin(), rest_mu_.end(), position_mu.begin());
    return;
  }
  const double d = std::clamp(at->programmed_ms(time_ms - at->start_ms), 0.0, at->segment.duration_ms);
  for (std::size_t m = 0; m < position_mu.size(); ++m) position_mu[m] = at->segment.motor[m].position(d);
}

/// Samples first..last-1, none after the end of the segment; before its start it stands at its first point.
void Timeline::sample_segment(const TimedSegment& segment, double start_ms, double period_ms, int first, int last, int count,
                              std::span<double> position_mu, std::span<double> velocity_mu_ms) const {
  std::array<double, kBlock> at{}, rate{};
  const int n = last - first;
  for (int k = 0; k < n; ++k) {
    const double t = start_ms + (first + k) * period_ms - segment.start_ms;
    const std::size_t i = static_cast<std::size_t>(k);
    at[i] = t <= 0 ? 0 : std::min(segment.programmed_ms(t), segment.segment.duration_ms);
    rate[i] = t < 0 ? 0 : segment.rate + segment.rate_slope * t;
  }
  for (std::size_t m = 0; m < segment.segment.motor.size(); ++m) {
    const MotorCubic q = segment.segment.motor[m];
    double* position = position_mu.data() + m * static_cast<std::size_t>(count) + first;
    for (int k = 0; k < n; ++k) position[k] = q.position(at[static_cast<std::size_t>(k)]);
    if (velocity_mu_ms.empty()) continue;
    double* velocity = velocity_mu_ms.data() + m * static_cast<std::size_t>(count) + first;
    for (int k = 0; k < n; ++k) velocity[k] = q.velocity(at[static_cast<std::size_t>(k)]) * rate[static_cast<std::size_t>(k)];
  }
}

/// Samples first..count-1, the first at time_ms, after the last segment. The very end of it still has its velocity.
void Timeline::sample_rest(double time_ms, int first, int count, std::span<double> position_mu, std::span<double> velocity_mu_ms) const {
  const bool at_end = time_ms == end_ms_ && !end_velocity_mu_ms_.empty();
  for (std::size_t m = 0; m < rest_mu_.size(); ++m) {
    const auto row = static_cast<std::ptrdiff_t>(m) * count;
    std::fill(position_mu.begin() + row + first, position_mu.begin() + row + count, rest_mu_[m]);
    if (velocity_mu_ms.empty()) continue;
    std::fill(velocity_mu_ms.begin() + row + first, velocity_mu_ms.begin() + row + count, 0.0);
    if (at_end) velocity_mu_ms[static_cast<std::size_t>(row + first)] = end_velocity_mu_ms_[m];
  }
}

}  // namespace pmac::motion
