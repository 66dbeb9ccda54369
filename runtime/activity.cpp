// Which limits hold for a motor now. Source: programmed moves, User's Manual p727-729, p791; jogs and rapid moves, p712; position
// limits, p429-431.
#include "runtime/servo/activity.h"

#include <algorithm>
#include <cmath>

#include "compiler/bytecode/element.h"
#include "runtime/state.h"

namespace pmac::runtime {
namespace {

using bytecode::ElementId;

constexpr double kNone = std::numeric_limits<double>::infinity();

double limit_of(double value) { return value > 0 ? value : kNone; }
double limit_of_inverse(double inverse) { return inverse > 0 ? 1 / inverse : kNone; }

/// In lookahead by option; without segmentation where InvJmax has been assigned.
bool jerk_is_limited(const Machine::State& s, unsigned motor, unsigned coord) {
  const bool segmented = s.elements.get(ElementId::kCoordSegMoveTime, coord) > 0;
  return segmented ? s.options.limit_jerk : s.elements.assigned(ElementId::kMotorInvJmax, motor);
}

void limits_of_path(const ElementStore& e, unsigned motor, bool limits_jerk, MotorActivity& activity) {
  activity.max_speed_mu_ms = limit_of(e.get(ElementId::kMotorMaxSpeed, motor));
  activity.max_accel_mu_ms2 = activity.max_stop_mu_ms2 = limit_of_inverse(e.get(ElementId::kMotorInvAmax, motor));
  if (e.assigned(ElementId::kMotorInvDmax, motor)) activity.max_stop_mu_ms2 = limit_of_inverse(e.get(ElementId::kMotorInvDmax, motor));
  if (limits_jerk) activity.max_jerk_mu_ms3 = limit_of_inverse(e.get(ElementId::kMotorInvJmax, motor));
}

/// A motor that was faster when the profile began may slow down from there; one that stops has no speed of its own.
void limits_of_profile(const ElementStore& e, unsigned motor, const motion::MotorProfile& profile, MotorActivity& activity) {
  const motion::JogParameters& jog = profile.parameters();
  const double own_mu_ms = jog.speed_mu_ms > 0 ? std::max(jog.speed_mu_ms, std::abs(profile.start_velocity_mu_ms())) : kNone;
  activity.max_speed_mu_ms = std::min(own_mu_ms, limit_of(e.get(ElementId::kMotorMaxSpeed, motor)));
  activity.max_accel_mu_ms2 = activity.max_stop_mu_ms2 = limit_of_inverse(-jog.ta);
  activity.max_jerk_mu_ms3 = limit_of_inverse(-jog.ts);
}

}  // namespace

MotorActivity Machine::activity(int motor, double time_ms) const {
  const State& s = *state_;
  const Motor& m = s.motors[static_cast<std::size_t>(motor)];
  const auto n = static_cast<unsigned>(motor);
  MotorActivity activity;
  activity.coord = m.coord;
  activity.home_mu = m.home_position_mu;
  const double low_mu = s.elements.get(ElementId::kMotorMinPos, n), high_mu = s.elements.get(ElementId::kMotorMaxPos, n);
  if (high_mu > low_mu) activity.min_mu = low_mu, activity.max_mu = high_mu;
  switch (m.source) {
    case Motor::Source::kRest: break;
    case Motor::Source::kPath:
      activity.kind = MotorActivity::Kind::kPath;
      limits_of_path(s.elements, n, jerk_is_limited(s, n, static_cast<unsigned>(std::max(m.coord, 0))), activity);
      break;
    case Motor::Source::kProfile:
      activity.kind = MotorActivity::Kind::kOwn;
      limits_of_profile(s.elements, n, m.profile, activity);
      break;
  }
  const bool by_itself = activity.kind == MotorActivity::Kind::kOwn && m.jogging;
  if (activity.kind != MotorActivity::Kind::kRest)
    activity.source = by_itself || m.coord < 0 ? m.jog_source : s.coords[static_cast<std::size_t>(m.coord)]->executing_source(time_ms);
  return activity;
}

}  // namespace pmac::runtime
