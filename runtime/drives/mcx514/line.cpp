#include "runtime/drives/mcx514/line.h"

#include <algorithm>
#include <cstdlib>

namespace pmac::drives::mcx514 {

Line::Line(const AxisCounts& finish, std::int64_t events) {
  for (std::size_t axis = 0; axis < finish.size(); ++axis) {
    length_[axis] = std::abs(finish[axis]);
    direction_[axis] = finish[axis] < 0 ? -1 : 1;
    events_ = std::max(events_, length_[axis]);
    if (length_[axis] > 0) ++moving_;
  }
  events_ = std::max(events_, events);
  if (events_ == 0) stop_ = Stop::kFinishPoint;
}

Event Line::next() {
  Event event;
  for (std::size_t axis = 0; axis < length_.size(); ++axis) {
    sum_[axis] += 2 * length_[axis];
    if (sum_[axis] < events_ || length_[axis] == 0) continue;
    sum_[axis] -= 2 * events_;
    event.step[axis] = direction_[axis];
  }
  for (std::size_t axis = 0; axis < length_.size(); ++axis) {
    sum_low_[axis] = std::min(sum_low_[axis], sum_[axis]);
    sum_high_[axis] = std::max(sum_high_[axis], sum_[axis]);
  }
  if (++at_ == events_) stop_ = Stop::kFinishPoint;
  return event;
}

Skip Line::skip(std::uint64_t most) {
  Skip total;
  const bool has_long_axis = *std::max_element(length_.begin(), length_.end()) == events_;
  if (moving_ > 2 || !has_long_axis || events_ - at_ < 2) return total;  // doubles could not be told
  const auto count = static_cast<std::int64_t>(std::min(most, static_cast<std::uint64_t>(events_ - at_ - 1)));
  std::int64_t least = count;
  for (std::size_t axis = 0; axis < length_.size(); ++axis) {
    if (length_[axis] == 0) continue;
    const std::int64_t steps = (2 * length_[axis] * count + sum_[axis] + events_) / (2 * events_);
    sum_[axis] += 2 * length_[axis] * count - 2 * events_ * steps;
    total.steps[axis] = direction_[axis] * steps;
    least = std::min(least, steps);
  }
  at_ += count;
  passed_over_ = passed_over_ || count > 0;
  total.events = static_cast<std::uint64_t>(count);
  total.doubles = moving_ == 2 ? static_cast<std::uint64_t>(least) : 0;
  return total;
}

std::optional<ErrorRange> Line::error() const {
  if (passed_over_ || events_ == 0) return std::nullopt;
  ErrorRange range;
  for (std::size_t axis = 0; axis < length_.size(); ++axis) {
    range.low = std::min(range.low, -static_cast<double>(sum_high_[axis]) / static_cast<double>(2 * events_));
    range.high = std::max(range.high, -static_cast<double>(sum_low_[axis]) / static_cast<double>(2 * events_));
  }
  return range;
}

double Line::error_now() const {
  double worst = 0;
  for (const std::int64_t sum : sum_) {
    const double error = -static_cast<double>(sum) / static_cast<double>(2 * events_);
    if (std::abs(error) > std::abs(worst)) worst = error;
  }
  return worst;
}

Skip Endless::skip(std::uint64_t most) {
  Skip total;
  total.events = most;
  for (std::size_t axis = 0; axis < event_.step.size(); ++axis) total.steps[axis] = event_.step[axis] * static_cast<std::int64_t>(most);
  return total;
}

BitPattern::BitPattern(const std::array<Bits, kAxes>& bits) : bits_(bits) {
  for (const Bits& axis : bits)
    for (int bit = 0; bit < events_; ++bit)
      if ((axis.plus & axis.minus) >> bit & 1) events_ = bit;
  if (events_ == 0) stop_ = Stop::kEndOfPattern;
}

Event BitPattern::next() {
  Event event;
  for (std::size_t axis = 0; axis < bits_.size(); ++axis)
    event.step[axis] = static_cast<std::int8_t>((bits_[axis].plus >> at_ & 1) - (bits_[axis].minus >> at_ & 1));
  if (++at_ == events_) stop_ = Stop::kEndOfPattern;
  return event;
}

}  // namespace pmac::drives::mcx514
