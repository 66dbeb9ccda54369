// Passing over events: within an octant the point nearest to the circle is known for every coordinate of the short axis (the long one is
// the rounded root of what is left of R^2), so that stepping there one by one or at once gives the same. Near the ends of octants and near
// the finish point events are made one by one.
#include "runtime/drives/mcx514/arc.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace pmac::drives::mcx514 {
namespace {

constexpr std::int64_t kMargin = 4;       // events before the end of an octant that are not passed over
constexpr std::int64_t kWorthPassing = 16;

std::int64_t floor_root(std::int64_t value) {
  auto root = static_cast<std::int64_t>(std::sqrt(static_cast<double>(value)));
  while (root * root > value) --root;
  while ((root + 1) * (root + 1) <= value) ++root;
  return root;
}

std::size_t index(int axis) { return static_cast<std::size_t>(axis); }

int octants_between(int from, int to, bool clockwise) { return (clockwise ? from - to + 8 : to - from + 8) % 8; }

}  // namespace

std::int64_t rounded_root(std::int64_t value) {
  const std::int64_t root = floor_root(value);
  return value > root * root + root ? root + 1 : root;
}

double finish_off_circle(const ArcSetting& setting) {
  const auto dx = static_cast<double>(setting.finish.ax1 - setting.center.ax1), dy = static_cast<double>(setting.finish.ax2 - setting.center.ax2);
  return std::hypot(dx, dy) - std::hypot(static_cast<double>(setting.center.ax1), static_cast<double>(setting.center.ax2));
}

Arc::Arc(const ArcSetting& setting) : setting_(setting) {
  const Plane start{-setting.center.ax1, -setting.center.ax2};
  const Plane finish{setting.finish.ax1 - setting.center.ax1, setting.finish.ax2 - setting.center.ax2};
  at_ = {start.ax1, start.ax2};
  finish_ = {finish.ax1, finish.ax2};
  r2_ = start.ax1 * start.ax1 + start.ax2 * start.ax2;
  const int first = entered_octant(start, setting.clockwise);
  left_ = octants_between(first, arrived_octant(finish, setting.clockwise), setting.clockwise);
  enter(first);
  if (left_ == 0 && at_or_past_finish()) left_ = 8;  // not ahead: almost a full turn
  left_ += 8 * static_cast<std::int64_t>(setting.further_turns);
}

double Arc::radius() const { return std::sqrt(static_cast<double>(r2_)); }

void Arc::enter(int octant) {
  octant_ = octant;
  run_ = octant_run(octant, setting_.clockwise);
  visited_.push_back(octant);
}

std::int64_t Arc::short_distance_to_finish() const {
  const std::size_t s = index(run_.short_axis);
  return run_.short_step * (finish_[s] - at_[s]);
}

bool Arc::leaves_octant() const {
  const std::size_t s = index(run_.short_axis);
  const bool at_boundary = run_.outward ? std::abs(at_[s]) >= std::abs(at_[1 - s]) : at_[s] == 0;
  return at_boundary && entered_octant({at_[0], at_[1]}, setting_.clockwise) != octant_;
}

/// What the new position means: the same quadrant, the next one, or the end.
void Arc::settle() {
  if (!leaves_octant()) {
    if (left_ == 0 && at_or_past_finish()) stop_ = Stop::kShortAxis;
    return;
  }
  if (left_ == 0) {
    stop_ = at_or_past_finish() ? Stop::kShortAxis : Stop::kEndOfQuadrant;
    return;
  }
  const int entered = entered_octant({at_[0], at_[1]}, setting_.clockwise);
  left_ -= octants_between(octant_, entered, setting_.clockwise);  // more than one where the radius is tiny
  if (left_ < 0) {
    stop_ = Stop::kEndOfQuadrant;
    return;
  }
  enter(entered);
  if (left_ == 0 && at_or_past_finish()) stop_ = Stop::kShortAxis;
}

Event Arc::next() {
  Event event;
  const std::size_t s = index(run_.short_axis), l = 1 - s;
  f_ += 2 * at_[s] * run_.short_step + 1;
  at_[s] += run_.short_step;
  event.step[index(setting_.axis[s])] = static_cast<std::int8_t>(run_.short_step);
  const std::int64_t with_long = f_ + 2 * at_[l] * run_.long_step + 1;
  if (std::abs(with_long) < std::abs(f_)) {
    f_ = with_long;
    at_[l] += run_.long_step;
    event.step[index(setting_.axis[l])] = static_cast<std::int8_t>(run_.long_step);
  }
  f_low_ = std::min(f_low_, f_);
  f_high_ = std::max(f_high_, f_);
  settle();
  return event;
}

/// How many events can be passed over from here: none where the point is not the nearest to the circle, as just after a boundary.
std::uint64_t Arc::events_to_pass() const {
  const std::size_t s = index(run_.short_axis);
  if (std::abs(at_[1 - s]) != rounded_root(r2_ - at_[s] * at_[s])) return 0;
  const std::int64_t from_axis = std::abs(at_[s]);
  std::int64_t count = run_.outward ? floor_root(r2_ / 2) - from_axis - kMargin : from_axis - kMargin;
  if (left_ == 0) count = std::min(count, short_distance_to_finish() - kMargin);
  return count > 0 ? static_cast<std::uint64_t>(count) : 0;
}

void Arc::pass(std::uint64_t events, Skip& total) {
  const std::size_t s = index(run_.short_axis), l = 1 - s;
  const auto count = static_cast<std::int64_t>(events);
  at_[s] += run_.short_step * count;
  const std::int64_t before = at_[l];
  at_[l] = (before < 0 ? -1 : 1) * rounded_root(r2_ - at_[s] * at_[s]);
  f_ = at_[s] * at_[s] + at_[l] * at_[l] - r2_;
  total.events += events;
  total.doubles += static_cast<std::uint64_t>(std::abs(at_[l] - before));
  total.steps[index(setting_.axis[s])] += run_.short_step * count;
  total.steps[index(setting_.axis[l])] += at_[l] - before;
  passed_over_ = true;
}

Skip Arc::skip(std::uint64_t most) {
  Skip total;
  const std::uint64_t events = std::min(events_to_pass(), most);
  if (events >= static_cast<std::uint64_t>(kWorthPassing)) pass(events, total);
  return total;
}

std::uint64_t Arc::remaining() const {
  Arc rest = *this;
  std::uint64_t events = 0;
  while (!rest.done()) {
    const Skip skipped = rest.skip(std::numeric_limits<std::uint64_t>::max());
    events += skipped.events;
    if (skipped.events > 0) continue;
    rest.next();
    ++events;
  }
  return events;
}

double Arc::radial_error(std::int64_t f) const {
  // sqrt(R^2 + F) - R without the loss of digits
  const auto r2 = static_cast<double>(r2_);
  return static_cast<double>(f) / (std::sqrt(r2 + static_cast<double>(f)) + std::sqrt(r2));
}

std::optional<ErrorRange> Arc::error() const {
  if (passed_over_) return std::nullopt;
  return ErrorRange{radial_error(f_low_), radial_error(f_high_)};
}

Helix::Helix(const ArcSetting& setting, const AxisCounts& along, std::int64_t circle_events)
    : arc_(setting), along_(along), circle_events_(circle_events) {
  for (std::size_t axis = 0; axis < along.size(); ++axis) left_[axis] = std::abs(along[axis]);
}

Event Helix::next() {
  Event event = arc_.next();
  for (std::size_t axis = 0; axis < along_.size(); ++axis) {
    sum_[axis] += 2 * std::abs(along_[axis]);
    if (left_[axis] == 0 || sum_[axis] < circle_events_) continue;
    sum_[axis] -= 2 * circle_events_;
    --left_[axis];
    event.step[axis] = along_[axis] > 0 ? 1 : -1;
  }
  stop_ = arc_.stop();
  return event;
}

}  // namespace pmac::drives::mcx514
