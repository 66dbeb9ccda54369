#include "runtime/motion/timeline.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace pmac::motion {
namespace {

constexpr int kBlock = 64;  // samples evaluated together

double end_of(const TimedSegment& segment) { return segment.start_ms + segment.duration_ms; }

}  // namespace

void Timeline::reset(std::vector<double> position_mu, double time_ms) {
  segments_.clear();
  cursor_ = 0;
  end_ms_ = sampled_ms_ = time_ms;
  rest_mu_ = std::move(position_mu);
}

void Timeline::push(TimedSegment segment) {
  end_ms_ = end_of(segment);
  for (std::size_t m = 0; m < rest_mu_.size(); ++m) rest_mu_[m] = segment.segment.motor[m].position(segment.segment.duration_ms);
  segments_.push_back(std::move(segment));
}

void Timeline::prune() {
  segments_.erase(segments_.begin(), segments_.begin() + static_cast<std::ptrdiff_t>(cursor_));
  cursor_ = 0;
}

int Timeline::segments_after(double time_ms) const {
  const auto first = std::partition_point(segments_.begin(), segments_.end(), [&](const TimedSegment& s) { return s.start_ms < time_ms; });
  return static_cast<int>(segments_.end() - first);
}

SourceLine Timeline::source_at(double time_ms) const {
  const auto next = std::partition_point(segments_.begin(), segments_.end(), [&](const TimedSegment& s) { return end_of(s) <= time_ms; });
  return next == segments_.end() || next->start_ms > time_ms ? SourceLine{} : next->segment.source;
}

void Timeline::sample(double start_ms, double period_ms, int count, std::span<double> position_mu, std::span<double> velocity_mu_ms) {
  int done = 0;
  while (done < count) {
    const double time_ms = start_ms + done * period_ms;
    while (cursor_ < segments_.size() && end_of(segments_[cursor_]) <= time_ms) ++cursor_;
    if (cursor_ == segments_.size()) {
      sample_rest(done, count, count, position_mu, velocity_mu_ms);
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

void Timeline::sample_rest(int first, int last, int count, std::span<double> position_mu, std::span<double> velocity_mu_ms) const {
  for (std::size_t m = 0; m < rest_mu_.size(); ++m) {
    const std::size_t row = m * static_cast<std::size_t>(count);
    std::fill(position_mu.begin() + row + first, position_mu.begin() + row + last, rest_mu_[m]);
    if (!velocity_mu_ms.empty()) std::fill(velocity_mu_ms.begin() + row + first, velocity_mu_ms.begin() + row + last, 0.0);
  }
}

}  // namespace pmac::motion
