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

}  // namespace

std::string CoordSystem::quick_stop(double time_ms) {
  if (!on_path_ || !lookahead_) return hold(time_ms);
  if (shaping_ == Shaping::kNone || shaping_ == Shaping::kFaster) begin_shaping(Shaping::kSlower);
  return {};
}

void CoordSystem::begin_shaping(Shaping shaping) {
  if (shaping_ == Shaping::kNone) before_mu_.clear();
  shaping_ = shaping;
  time_base_.shape(shaping == Shaping::kSlower ? TimeBase::Hold::kSlowing : TimeBase::Hold::kResuming);
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

void CoordSystem::shape_rate(double time_ms) {
  const double h = machine_.period_ms(), path_ms = time_base_.path_at(time_ms);
  const double last_ms = path_ms - time_base_.path_at(time_ms - h);
  const double wanted_ms = shaping_ == Shaping::kSlower ? 0 : h * std::min(1.0, time_base_.override_rate());
  double step_ms = wanted_ms;
  if (on_path_) {
    here_mu_.resize(path_map_.motors.size());
    there_mu_.resize(path_map_.motors.size());
    pipeline_.peek(path_ms, here_mu_);
    const bool known = before_mu_.size() == here_mu_.size();
    step_ms = known ? step_toward(path_ms, last_ms, wanted_ms) : last_ms;
    before_mu_ = here_mu_;
  }
  time_base_.force_rate(time_ms, step_ms / h);
  if (step_ms == wanted_ms) end_shaping(time_ms);
  else shape_at_ms_ = machine_.tick_ms(machine_.tick + 1);
  clock_changed(time_ms);
}

void CoordSystem::end_shaping(double time_ms) {
  const bool stopped = shaping_ == Shaping::kSlower;
  shaping_ = Shaping::kNone;
  shape_at_ms_ = kNever;
  time_base_.shape_end(stopped);
  quick_stopped_ = stopped;
  double slope_per_ms = 0;
  if (!stopped && slope_of(ElementId::kCoordFeedHoldSlew, slope_per_ms).empty()) time_base_.release(time_ms, slope_per_ms);   // an override above 100 %
}

}  // namespace pmac::runtime
