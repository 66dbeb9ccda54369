// Quick stop inside lookahead, and going on after it: the rate of the path's clock is chosen anew at every servo tick, as low (or high) as
// every motor's acceleration limit allows. With q(s) the motor's path over path time and the tick h, the next step ds is the least with
//
//   | q(s + ds) - 2 q(s) + q(s - ds_before) | <= h^2 / InvAmax     for all motors
//
// The step before is always allowed again while the rate is at most 1, since the lookahead has kept the limit at rate 1; so slowing down
// greedily never leads into a corner. Source: what \ does, User's Manual p694; how, the project's own.
#include <algorithm>
#include <cmath>

#include "compiler/bytecode/element.h"
#include "runtime/state.h"

namespace pmac::runtime {
namespace {

using bytecode::ElementId;

constexpr int kBisections = 40;
constexpr double kNoTime_ms = 1e-12;

}  // namespace

std::string CoordSystem::quick_stop(double time_ms) {
  if (!on_path_ || (!lookahead_ && !retracing())) return hold(time_ms);
  shaped_by_slew_ = !lookahead_;
  if (shaping_ != Shaping::kSlower && !quick_stopped_) begin_shaping(Shaping::kSlower);
  return {};
}

void CoordSystem::begin_shaping(Shaping shaping) {
  if (shaping_ == Shaping::kNone) before_mu_.clear();
  shaping_ = shaping;
  time_base_.shape(shaping == Shaping::kFaster && back_ms_ == 0 ? TimeBase::Hold::kResuming : TimeBase::Hold::kSlowing);
  shape_at_ms_ = machine_.tick_ms(machine_.tick + 1);
}

/// True where the step keeps every motor's limit. here_mu: positions at path_ms.
bool CoordSystem::keeps_limits(double path_ms, double step_ms) {
  pipeline_.peek(path_ms + step_ms, there_mu_);
  const double h = machine_.period_ms();
  for (std::size_t i = 0; i < there_mu_.size(); ++i) {
    const double inv_amax = machine_.elements.get(ElementId::kMotorInvAmax, static_cast<unsigned>(path_map_.motors[i]));
    if (std::abs(there_mu_[i] - 2 * here_mu_[i] + before_mu_[i]) * inv_amax > h * h) return false;
  }
  return true;
}

/// The step nearest to wanted_ms that keeps the limits, between it and the last one.
double CoordSystem::step_toward(double path_ms, double last_ms, double wanted_ms) {
  if (keeps_limits(path_ms, wanted_ms)) return wanted_ms;
  double allowed = last_ms, refused = wanted_ms;
  for (int i = 0; i < kBisections; ++i) {
    const double middle = (allowed + refused) / 2;
    (keeps_limits(path_ms, middle) ? allowed : refused) = middle;
  }
  return allowed;
}

/// The same where the rate changes by Coord[].FeedHoldSlew.
double CoordSystem::step_by_slew(double last_ms, double wanted_ms) const {
  const double change_ms = machine_.elements.get(ElementId::kCoordFeedHoldSlew, static_cast<unsigned>(number_));
  return std::clamp(wanted_ms, last_ms - change_ms, last_ms + change_ms);
}

double CoordSystem::wanted_step_ms(double path_ms) const {
  const double full_ms = machine_.period_ms() * std::min(1.0, time_base_.override_rate());
  if (shaping_ == Shaping::kFaster) return full_ms;
  if (shaping_ == Shaping::kSlower) return 0;
  return std::max(-full_ms, pipeline_.oldest_ms() - path_ms);
}

void CoordSystem::shape_rate(double time_ms) {
  const double h = machine_.period_ms(), path_ms = path_position(time_ms);
  if (shaping_ == Shaping::kBack && path_ms < retrace_to_ms_) shaping_ = Shaping::kSlower;
  const double wanted_ms = wanted_step_ms(path_ms);
  double step_ms = wanted_ms;
  if (on_path_) {
    here_mu_.resize(path_map_.motors.size());
    there_mu_.resize(path_map_.motors.size());
    pipeline_.peek(path_ms, here_mu_);
    const bool known = before_mu_.size() == here_mu_.size();
    const double last_ms = path_ms - (known ? before_path_ms_ : path_position(time_ms - h));
    if (shaped_by_slew_) step_ms = step_by_slew(last_ms, wanted_ms);
    else step_ms = known ? step_toward(path_ms, last_ms, wanted_ms) : last_ms;
    step_ms = std::max(step_ms, pipeline_.oldest_ms() - path_ms);
    before_mu_ = here_mu_;
    before_path_ms_ = path_ms;
  }
  run_step(time_ms, step_ms);
  const bool stands = shaping_ == Shaping::kSlower || (shaping_ == Shaping::kBack && path_ms <= pipeline_.oldest_ms());
  const bool goes_on = shaping_ == Shaping::kFaster && back_ms_ == 0;
  if (step_ms == wanted_ms && (stands || goes_on)) end_shaping(time_ms);
  else shape_at_ms_ = wanted_ms == 0 && step_ms == 0 ? kNever : machine_.tick_ms(machine_.tick + 1);   // at 0 %: until that changes
  clock_changed(time_ms);
}

/// The path position goes on by step_ms until the next tick: behind the clock by retracing, at the clock's by its rate.
void CoordSystem::run_step(double time_ms, double step_ms) {
  const double h = machine_.period_ms(), behind_ms = path_position(time_ms) - time_base_.path_at(time_ms);
  back_ms_ = behind_ms > -kNoTime_ms ? 0 : behind_ms;
  back_from_ms_ = time_ms;
  const double ahead_ms = std::max(0.0, back_ms_ + step_ms);   // past the place that the clock stands at
  time_base_.force_rate(time_ms, ahead_ms / h);
  back_rate_ = (step_ms - ahead_ms) / h;
}

void CoordSystem::end_shaping(double time_ms) {
  const bool stopped = shaping_ != Shaping::kFaster;
  shaping_ = Shaping::kNone;
  shape_at_ms_ = kNever;
  time_base_.shape_end(stopped);
  quick_stopped_ = stopped;
  double slope_per_ms = 0;
  if (!stopped && slope_of(ElementId::kCoordFeedHoldSlew, slope_per_ms).empty()) time_base_.release(time_ms, slope_per_ms);   // an override above 100 %
}

}  // namespace pmac::runtime
