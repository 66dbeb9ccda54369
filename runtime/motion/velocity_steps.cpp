#include "runtime/motion/velocity_steps.h"

#include <algorithm>
#include <cmath>

namespace pmac::motion {
namespace {

/// Velocities that differ by less, relative to the speed, are equal.
constexpr double kSameVelocity = 1e-6;
/// Speeds below this fraction of the fastest in the segment are rest.
constexpr double kRest = 1e-9;
/// Part of an acceleration limit that steps in direction may use, and how much of it is kept in hand because the rate differs a
/// little between neighbouring steps.
constexpr double kStepShare = 0.65, kInHand = 0.1;
/// A step that would have to be passed more slowly than this part of the programmed speed is better stopped at: the motion
/// around it then has its whole acceleration.
constexpr double kSlowestRate = 0.05;

double speed_at(const Segment& segment, bool at_end) {
  double sum = 0;
  for (const MotorCubic& q : segment.motor) {
    const double v = at_end ? q.velocity(segment.duration_ms) : q.c1;
    sum += v * v;
  }
  return std::sqrt(sum);
}

double end_of(const Segment& segment) { return segment.start_ms + segment.duration_ms; }

}  // namespace

bool is_moving(const Segment& segment, bool at_end) {
  double mean = 0;
  for (const MotorCubic& q : segment.motor) mean = std::max(mean, std::abs(q.position(segment.duration_ms) - q.c0) / segment.duration_ms);
  return speed_at(segment, at_end) > kRest * std::max(mean, speed_at(segment, !at_end));
}

VelocitySteps::Ends VelocitySteps::ends_of(const Segment& segment) {
  const double h = segment.duration_ms;
  double start2 = 0, end2 = 0, way = 0;
  for (const MotorCubic& q : segment.motor) {
    const double end = q.velocity(h);
    start2 += q.c1 * q.c1;
    end2 += end * end;
    way = std::max(way, std::abs(q.position(h) - q.c0));
  }
  const double start = std::sqrt(start2), end = std::sqrt(end2), mean = way / h;
  return {start, end, start > kRest * std::max(mean, end), end > kRest * std::max(mean, start)};
}

VelocitySteps::VelocitySteps(std::vector<MotorLimits> limits, double servo_period_ms)
    : limits_(std::move(limits)), period_ms_(servo_period_ms) {}

void VelocitySteps::add(Segment segment, std::vector<PreparedSegment>& out) {
  PreparedSegment prepared;
  prepared.segment = std::move(segment);
  const Ends ends = ends_of(prepared.segment);
  if (!held_.empty()) compare(held_.back().segment, last_ends_, prepared, ends);
  if (held_.empty()) prepared.stops_at_start = ends.moves_at_start;
  last_ends_ = ends;
  const double known_ms = end_of(prepared.segment);
  held_.push_back(std::move(prepared));
  decide_steps(known_ms);
  release(known_ms - 5 * period_ms_, out);
}

void VelocitySteps::finish(std::vector<PreparedSegment>& out) {
  constexpr double kAll = std::numeric_limits<double>::infinity();
  decide_steps(kAll);
  release(kAll, out);
  held_.clear();
  steps_.clear();
  rated_ = decided_ = 0;
}

/// Fills in how `after` begins, and notes a step in direction.
void VelocitySteps::compare(const Segment& before, const Ends& before_ends, PreparedSegment& after, const Ends& after_ends) {
  const bool moves_before = before_ends.moves_at_end, moves_after = after_ends.moves_at_start;
  if (!moves_before && !moves_after) return;
  if (!moves_before || !moves_after) {
    after.stops_at_start = true;
    return;
  }
  const double speed_before = before_ends.end_speed, speed_after = after_ends.start_speed;
  if (std::abs(speed_after - speed_before) > kSameVelocity * speed_after) after.speed_ratio = speed_after / speed_before;
  const auto change = [&](std::size_t m) { return std::abs(after.segment.motor[m].c1 - after.speed_ratio * before.motor[m].velocity(before.duration_ms)); };
  double largest = 0;
  for (std::size_t m = 0; m < before.motor.size(); ++m) largest = std::max(largest, change(m));
  if (largest <= kSameVelocity * speed_after) return;
  Step step{after.segment.start_ms, {}};
  for (std::size_t m = 0; m < before.motor.size(); ++m) step.change_mu_ms.push_back(change(m));
  steps_.push_back(std::move(step));
}

/// A step can be rated when all others within two periods are known, and decided when these are rated.
void VelocitySteps::decide_steps(double known_ms) {
  for (; rated_ < steps_.size() && steps_[rated_].place_ms + 2 * period_ms_ <= known_ms; ++rated_)
    steps_[rated_].own_rate = period_ms_ > 0 ? rate_that_fits(rated_) : 0;
  for (; decided_ < rated_ && steps_[decided_].place_ms + 4 * period_ms_ <= known_ms; ++decided_) {
    PreparedSegment& segment = *starting_at(steps_[decided_].place_ms);
    segment.max_start_rate = lowest_rate_near(decided_);
    steps_[decided_].is_gentle = segment.max_start_rate >= kSlowestRate;
    segment.stops_at_start = !steps_[decided_].is_gentle;
  }
}

/// Largest rate, up to 1, at which the steps around this one take no more than their share of any motor's acceleration.
double VelocitySteps::rate_that_fits(std::size_t at) const {
  double rate = 1;
  for (std::size_t m = 0; m < std::min(limits_.size(), steps_[at].change_mu_ms.size()); ++m) {
    if (limits_[m].inv_amax_ms2_mu <= 0 || share_taken(m, at, rate) <= kStepShare) continue;
    double low = 0;
    for (int i = 0; i < 20; ++i) {
      const double middle = (low + rate) / 2;
      (share_taken(m, at, middle) <= kStepShare ? low : rate) = middle;
    }
    rate = low;
  }
  return rate;
}

/// Acceleration that a second difference of the samples sees of the steps when it is taken at step `at`, in parts of the limit.
/// Between steps it is less.
double VelocitySteps::share_taken(std::size_t motor, std::size_t at, double rate) const {
  double sum = 0;
  const double place_ms = steps_[at].place_ms;
  const auto add = [&](const Step& step) {
    const double weight = rate - std::abs(step.place_ms - place_ms) / period_ms_;
    if (weight > 0) sum += weight * step.change_mu_ms[motor];
    return weight > 0;
  };
  for (std::size_t k = at; k < steps_.size() && add(steps_[k]); ++k) {}
  for (std::size_t k = at; k-- > 0 && add(steps_[k]);) {}
  return sum / period_ms_ * limits_[motor].inv_amax_ms2_mu * (1 + kInHand);
}

/// Steps within two periods can enter one second difference; all of them go by the lowest of their rates.
double VelocitySteps::lowest_rate_near(std::size_t at) const {
  double rate = steps_[at].own_rate;
  const auto is_near = [&](std::size_t k) { return std::abs(steps_[k].place_ms - steps_[at].place_ms) <= 2 * period_ms_; };
  for (std::size_t k = at + 1; k < rated_ && is_near(k); ++k) rate = std::min(rate, steps_[k].own_rate);
  for (std::size_t k = at; k-- > 0 && is_near(k);) rate = std::min(rate, steps_[k].own_rate);
  return rate;
}

/// Held segments that end at or before end_ms go on; the newest stays for comparison with the next.
void VelocitySteps::release(double end_ms, std::vector<PreparedSegment>& out) {
  const bool all = std::isinf(end_ms);
  while (!held_.empty() && (all || (held_.size() > 1 && end_of(held_.front().segment) <= end_ms))) {
    PreparedSegment& segment = held_.front();
    const double to_ms = end_of(segment.segment) + period_ms_;
    hand_on(std::move(segment), out);
    held_.pop_front();
    while (decided_ > 0 && steps_.front().place_ms < to_ms - 6 * period_ms_) {
      steps_.pop_front();
      --decided_;
      --rated_;
    }
  }
}

/// Gentle steps take their share of the acceleration within a period of programmed time, which is at most as long as it takes; long segments are cut there.
void VelocitySteps::hand_on(PreparedSegment whole, std::vector<PreparedSegment>& out) const {
  const double from_ms = whole.segment.start_ms, to_ms = end_of(whole.segment), near_ms = 2 * period_ms_;
  if (!has_gentle_step(from_ms - period_ms_, to_ms + period_ms_)) return out.push_back(std::move(whole));
  const bool at_start = has_gentle_step(from_ms - period_ms_, from_ms + near_ms), at_end = has_gentle_step(to_ms - near_ms, to_ms + period_ms_);
  const double first_ms = at_start ? near_ms : 0, last_ms = at_end ? near_ms : 0, middle_ms = to_ms - from_ms - first_ms - last_ms;
  if (middle_ms < near_ms) {
    whole.accel_share = 1 - kStepShare;
    return out.push_back(std::move(whole));
  }
  const auto add = [&](double offset_ms, double duration_ms, double share) {
    if (duration_ms == 0) return;
    PreparedSegment part{part_of(whole.segment, offset_ms, duration_ms)};
    if (offset_ms == 0) {
      part.stops_at_start = whole.stops_at_start;
      part.speed_ratio = whole.speed_ratio;
      part.max_start_rate = whole.max_start_rate;
    }
    part.accel_share = share;
    out.push_back(std::move(part));
  };
  add(0, first_ms, 1 - kStepShare);
  add(first_ms, middle_ms, 1);
  add(first_ms + middle_ms, last_ms, 1 - kStepShare);
}

bool VelocitySteps::has_gentle_step(double from_ms, double to_ms) const {
  for (std::size_t i = 0; i < decided_; ++i)
    if (steps_[i].is_gentle && steps_[i].place_ms > from_ms && steps_[i].place_ms < to_ms) return true;
  return false;
}

PreparedSegment* VelocitySteps::starting_at(double place_ms) {
  return &held_[held_.first_not([&](const PreparedSegment& held) { return held.segment.start_ms < place_ms; })];
}

}  // namespace pmac::motion
