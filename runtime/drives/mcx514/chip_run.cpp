// Time passes: events of the drives that run, in order; their ends; the next segment out of the pre-buffer.
#include <algorithm>
#include <cstdlib>

#include <fmt/format.h>

#include "runtime/drives/mcx514/chip_state.h"

namespace pmac::drives::mcx514 {
namespace {

constexpr int kEventsPerLook = 1 << 16;   // between two questions whether the run is interrupted

/// Counters have 32 bits.
std::int64_t wrapped(std::int64_t position) { return static_cast<std::int32_t>(static_cast<std::uint32_t>(position)); }

}  // namespace

void Chip::open_record(Running& running) {
  running.record = {};
  running.record.place = running.segment.place;
  running.record.code = running.segment.code;
  running.record.axes = running.segment.axes;
  running.record.start = running.next;
  running.record.start_position = position_;
  running.closely = sink_ != nullptr || (closely_followed_ > 0 && running.segment.pulses->remaining() <= closely_followed_);
}

void Chip::begin(Segment segment, const SpeedSetting& speed) {
  auto running = std::make_unique<Running>();
  running->segment = std::move(segment);
  running->speed = Speed(speed);
  running->next = now_;
  open_record(*running);
  const bool is_single = (running->segment.axes & (running->segment.axes - 1)) == 0;
  std::unique_ptr<Running>* place = &interpolation_;
  if (is_single) place = &single_[static_cast<std::size_t>(__builtin_ctz(running->segment.axes))];
  *place = std::move(running);
  if (speed.decelerates) count_remaining(**place);
}

void Chip::count_remaining(Running& running) {
  running.counts_remaining = true;
  running.remaining = running.segment.pulses->remaining();
  if (&running != interpolation_.get()) return;
  for (const Segment& segment : queue_) running.remaining += segment.pulses->remaining();
}

void Chip::set_deceleration(Running& running) {
  running.speed.enable_deceleration(decelerates_);
  if (decelerates_) count_remaining(running);
}

Chip::Running* Chip::earliest() {
  Running* first = interpolation_.get();
  for (const std::unique_ptr<Running>& drive : single_)
    if (drive && (first == nullptr || drive->next < first->next)) first = drive.get();
  return first;
}

void Chip::make_event(Running& running) {
  const Event event = running.segment.pulses->next();
  int stretching = 0;
  for (std::size_t axis = 0; axis < kAxes; ++axis) {
    if (event.step[axis] == 0) continue;
    position_[axis] = wrapped(position_[axis] + event.step[axis]);
    ++running.record.pulses[axis];
    if (has_axis(running.segment.stretching, axis)) ++stretching;
  }
  if (sink_ != nullptr) sink_->pulses(running.next, event, position_, *running.segment.pulses);
  running.next += running.speed.take(stretching, running.counts_remaining ? running.remaining : 1);
  if (running.counts_remaining) --running.remaining;
  ++running.record.events;
}

/// Many events at once, where nobody wants to see them. False: none.
bool Chip::pass_events(Running& running, Time until) {
  if (running.closely) return false;
  const std::uint64_t constant = running.speed.constant_events(running.counts_remaining ? running.remaining : std::numeric_limits<std::uint64_t>::max());
  const Time longest = running.speed.constant_period(3);
  const Time fitting = (std::min(until, latest_) - running.next) / longest;
  const auto most = static_cast<std::uint64_t>(std::min<Time>(fitting, static_cast<Time>(constant)));
  const Skip passed = running.segment.pulses->skip(std::min(most, std::numeric_limits<std::uint64_t>::max() / 4));
  if (passed.events == 0) return false;
  running.next += static_cast<Time>(passed.events - passed.doubles) * running.speed.constant_period(1) + static_cast<Time>(passed.doubles) * running.speed.constant_period(2);
  if (running.counts_remaining) running.remaining -= passed.events;
  running.record.events += passed.events;
  for (std::size_t axis = 0; axis < kAxes; ++axis) {
    position_[axis] = wrapped(position_[axis] + passed.steps[axis]);
    running.record.pulses[axis] += std::abs(passed.steps[axis]);
  }
  return true;
}

/// Executes what happens up to and with `until`. False: interrupted, or the latest time came.
bool Chip::advance(Time until) {
  for (int count = 0;; ++count) {
    Running* running = earliest();
    if (running == nullptr || running->next > until) return true;
    if (running->next > latest_) return false;
    if (count == kEventsPerLook) {
      count = 0;
      if (interrupted_ && interrupted_()) return false;
    }
    now_ = running->next;
    if (running->segment.pulses->done()) finish_drive(*running, running->segment.pulses->stop());
    else if (running->speed.finished()) finish_drive(*running, Stop::kDecelerated);
    else if (!pass_events(*running, until)) make_event(*running);
  }
}

void Chip::close_record(Running& running, Stop stop) {
  running.record.end = now_;
  running.record.end_position = position_;
  running.record.quadrants = running.segment.pulses->quadrants();
  running.record.stop = stop;
  if (running.closely) running.record.error = running.segment.pulses->error();
  drives_.push_back(std::move(running.record));
}

void Chip::finish_drive(Running& running, Stop stop) {
  close_record(running, stop);
  if (&running != interpolation_.get()) {
    for (std::unique_ptr<Running>& drive : single_)
      if (drive.get() == &running) drive.reset();
    return;
  }
  if (!queue_.empty() && stop != Stop::kDecelerated) {
    running.segment = std::move(queue_.front());
    queue_.pop_front();
    return open_record(running);
  }
  const std::uint32_t axes = running.segment.axes;
  interpolation_.reset();
  if (!fresh_segment_data_) return;
  fresh_segment_data_ = false;
  for (std::size_t axis = 0; axis < kAxes; ++axis)
    if (has_axis(axes, axis)) (*axes_)[axis].status |= rr2::kContinuousError;
  drives_.back().stop = Stop::kUnderrun;
  happen(true, fresh_place_, "continuous interpolation: the pre-buffer ran empty before the next segment, begun here, had its drive command (RR2 D7)");
}

void Chip::end_now(std::unique_ptr<Running>& drive, Stop stop) {
  close_record(*drive, stop);
  drive.reset();
}

bool Chip::run_until(Time time) {
  if (!advance(time)) return false;
  now_ = std::max(now_, time);
  return true;
}

bool Chip::run_until_idle() {
  constexpr Time never = time_from_clocks(std::numeric_limits<std::int64_t>::max());
  return advance(never);
}

bool Chip::run_until_next() {
  while (interpolation_ && queue_.size() >= kPreBuffer)
    if (!advance(interpolation_->next)) return false;
  return true;
}

}  // namespace pmac::drives::mcx514
