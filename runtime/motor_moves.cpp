#include "runtime/motor_moves.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "compiler/bytecode/element.h"
#include "runtime/servo/servo_cycle.h"
#include "runtime/servo/trigger.h"

namespace pmac::runtime {
namespace {

using bytecode::ElementId;
using motion::JogParameters;
using motion::MotorProfile;

constexpr double kJustAfter_ms = 1e-6;  // of an edge: on which side of it the motor goes on

double element(const Machine::State& s, ElementId id, const Motor& m) { return s.elements.get(id, static_cast<unsigned>(m.number)); }

JogParameters parameters_at(const Machine::State& s, const Motor& m, double speed_mu_ms) {
  return {speed_mu_ms, element(s, ElementId::kMotorJogTa, m), element(s, ElementId::kMotorJogTs, m)};
}

JogParameters jog_parameters(const Machine::State& s, const Motor& m) { return parameters_at(s, m, element(s, ElementId::kMotorJogSpeed, m)); }

/// A motor of a coordinate system runs by its time base; a spindle by the one that its definition says. User's Manual p501-506, p693.
const TimeBase* clock_of(Machine::State& s, const Motor& m) {
  const int coord = m.spindle == Motor::Spindle::kClockOf0 ? 0 : m.spindle == Motor::Spindle::kRealTime ? -1 : m.shares_with;
  return coord >= 0 ? s.coord(coord).clock_for_motion(s.now_ms) : nullptr;
}

double clock_ms(const TimeBase* clock, double time_ms) { return clock ? clock->path_at(time_ms) : time_ms; }

/// From rest to rest counts as one move.
void begin_record(Machine::State& s, Motor& m, std::string_view mode, bytecode::SourceLine source) {
  if (m.moving()) return;
  m.jogging = true;
  m.jog_mode = mode;
  m.jog_start_ms = s.now_ms;
  m.jog_start_mu = m.position_mu;
  m.jog_source = source;
}

void move_to(Machine::State& s, Motor& m, double target_mu, const JogParameters& parameters) {
  const TimeBase* clock = clock_of(s, m);
  m.follow(MotorProfile::move(clock_ms(clock, s.now_ms), m.position_at(s.now_ms), m.velocity_by(clock, s.now_ms), target_mu, parameters,
                              m.accel_by(clock, s.now_ms)), clock);
}

void move_endless(Machine::State& s, Motor& m, int direction, const JogParameters& parameters) {
  const TimeBase* clock = clock_of(s, m);
  m.follow(MotorProfile::jog(clock_ms(clock, s.now_ms), m.position_at(s.now_ms), m.velocity_by(clock, s.now_ms), direction, parameters,
                             m.accel_by(clock, s.now_ms)), clock);
}

/// When the commanded position passes the trigger; for ever for a motor with a plant, whose actual position is looked at.
void find_trigger(Machine::State& s, Motor& m) {
  m.trigger_at = std::numeric_limits<double>::infinity();
  const auto trigger = trigger_of(s.elements, m.number);
  if (!trigger || m.has_plant) return;
  const double now = m.profile_time(s.now_ms), home_mu = m.home_position_mu;
  if (trigger->active(home_mu + m.profile.position_mu(now))) m.trigger_at = now;
  for (const double edge_mu : {trigger->from_mu, trigger->to_mu}) {
    if (!std::isfinite(edge_mu)) continue;
    double at = m.profile.first_time_at(edge_mu - home_mu, now);
    const auto leads_away = [&] { return !trigger->is_place() && std::isfinite(at) && !trigger->active(home_mu + m.profile.position_mu(at + kJustAfter_ms)); };
    if (leads_away()) at = m.profile.first_time_at(edge_mu - home_mu, at + kJustAfter_ms);
    if (!leads_away()) m.trigger_at = std::min(m.trigger_at, at);
  }
}

/// From the present place and speed to the place that was asked for, from the trigger. at_ms: of the profile.
void turn_to_trigger(Machine::State& s, Motor& m, double at_ms, double position_mu, double place_mu) {
  const bool homes = m.task == Motor::Task::kSeekHome;
  const double target_mu = homes ? place_mu + m.trigger_distance_mu : clip_target(s, m, place_mu + m.trigger_distance_mu);
  m.follow(MotorProfile::move(at_ms, position_mu, m.profile.velocity_mu_ms(at_ms), target_mu, m.trigger_parameters, m.profile.accel_mu_ms2(at_ms)), m.clock);
  m.task = homes ? Motor::Task::kReturnHome : Motor::Task::kNone;
  if (!homes) note_clip(m, target_mu, place_mu + m.trigger_distance_mu);
}

/// The profile has passed the trigger.
void pass_trigger(Machine::State& s, Motor& m) {
  const double at_ms = m.trigger_at, here_mu = m.profile.position_mu(at_ms);
  const auto trigger = trigger_of(s.elements, m.number);
  double place_mu = here_mu;
  if (trigger)   // exactly the edge where it lies here
    for (const double edge_mu : {trigger->from_mu - m.home_position_mu, trigger->to_mu - m.home_position_mu})
      if (std::abs(edge_mu - here_mu) <= 1e-6 * std::max(1.0, std::abs(here_mu))) place_mu = edge_mu;
  turn_to_trigger(s, m, at_ms, place_mu, place_mu);
}

void report(Machine::State& s, Motor& m) {
  m.jogging = false;
  if (s.options.observers.move)
    s.options.observers.move({m.jog_mode, m.jog_source, -1, m.number, m.jog_start_ms, m.rest_since_ms, std::abs(m.position_mu - m.jog_start_mu),
                               {}, governed_by_itself(s, m)});
}

void arrive(Motor& m, double time_ms) {
  const Motor::Task task = m.task;
  if (task == Motor::Task::kSeekTrigger) m.trigger_not_found = true;
  m.settle(time_ms);
  if (m.clipped_at != Motor::LimitStop::kNone) m.limit_stop = m.clipped_at;
  if (task != Motor::Task::kReturnHome) return;
  m.jog_start_mu -= m.position_mu;   // the place where it started, from the new home
  m.home_here(m.rest_since_ms);
}

}  // namespace

double clip_target(const Machine::State& s, const Motor& m, double target_mu) {
  const PositionRange range = software_limits(s.elements, m.number);
  const double here_mu = m.position_at(s.now_ms);
  return std::clamp(target_mu, std::min(range.min_mu, here_mu), std::max(range.max_mu, here_mu));
}

void note_clip(Motor& m, double clipped_mu, double target_mu) {
  if (clipped_mu == target_mu) return;
  m.clipped_at = clipped_mu < target_mu ? Motor::LimitStop::kPlusPosition : Motor::LimitStop::kMinusPosition;
}

std::string jog_to(Machine::State& s, Motor& m, double target_mu, bytecode::SourceLine source, std::optional<double> trigger_distance_mu) {
  const double distance_mu = trigger_distance_mu.value_or(0);
  if (!std::isfinite(target_mu) || !std::isfinite(distance_mu))
    return fmt::format("error #21: ILLEGAL PARAMETER: jog target {} of motor {}", std::isfinite(target_mu) ? distance_mu : target_mu, m.number);
  begin_record(s, m, "jog", source);
  const double clipped_mu = clip_target(s, m, target_mu);
  if (clipped_mu != target_mu)
    s.warn(source, fmt::format("the jog of motor {} to {} ends at {}", m.number, target_mu, limit_text(m.number, clipped_mu < target_mu, software_limits(s.elements, m.number))));
  move_to(s, m, clipped_mu, jog_parameters(s, m));
  note_clip(m, clipped_mu, target_mu);
  if (trigger_distance_mu) seek_trigger(s, m, distance_mu, jog_parameters(s, m));
  return {};
}

std::string jog_endless(Machine::State& s, Motor& m, int direction, bytecode::SourceLine source) {
  begin_record(s, m, "jog", source);
  const double endless_mu = direction * std::numeric_limits<double>::infinity(), clipped_mu = clip_target(s, m, endless_mu);
  if (std::isinf(clipped_mu)) {
    move_endless(s, m, direction, jog_parameters(s, m));
  } else {
    move_to(s, m, clipped_mu, jog_parameters(s, m));
    note_clip(m, clipped_mu, endless_mu);
  }
  return {};
}

void jog_stop(Machine::State& s, Motor& m) {
  if (!m.moving()) return;
  const TimeBase* clock = clock_of(s, m);
  m.follow(MotorProfile::stop(clock_ms(clock, s.now_ms), m.position_at(s.now_ms), m.velocity_by(clock, s.now_ms), jog_parameters(s, m),
                              m.accel_by(clock, s.now_ms)), clock);
}

std::string home(Machine::State& s, Motor& m, bytecode::SourceLine source) {
  const double speed_mu_ms = element(s, ElementId::kMotorHomeVel, m);
  if (speed_mu_ms == 0 || !std::isfinite(speed_mu_ms)) return fmt::format("error #21: ILLEGAL PARAMETER: Motor[{}].HomeVel is {}", m.number, speed_mu_ms);
  if (!trigger_of(s.elements, m.number))
    return fmt::format("error #21: ILLEGAL PARAMETER: motor {} has no trigger and would move for ever; say where it is: Sim.Motor[{}].TriggerPos=... "
                       "or Sim.Motor[{}].FlagPos=...", m.number, m.number, m.number);
  const JogParameters parameters = parameters_at(s, m, std::abs(speed_mu_ms));
  begin_record(s, m, "home", source);
  move_endless(s, m, speed_mu_ms < 0 ? -1 : 1, parameters);
  m.home_complete = false;
  seek_trigger(s, m, element(s, ElementId::kMotorHomeOffset, m), parameters);
  m.task = Motor::Task::kSeekHome;
  if (std::isinf(m.trigger_at) && !m.has_plant)
    s.warn(source, fmt::format("motor {} moves away from its trigger (Sim.Motor[{}].TriggerPos or FlagPos) and will not find it", m.number, m.number));
  return {};
}

void abort_motor(Machine::State& s, Motor& m) {
  if (!m.moving()) return;
  const JogParameters stop{0, element(s, ElementId::kMotorAbortTa, m), element(s, ElementId::kMotorAbortTs, m)};
  m.follow(MotorProfile::stop(s.now_ms, m.position_at(s.now_ms), m.velocity_at(s.now_ms), stop));
}

void delay_kill(Machine::State& s, Motor& m, double brake_ms) {
  m.kill_at_rest = false;
  m.kill_ms = brake_ms + std::max(0.0, element(s, ElementId::kMotorBrakeOnDelay, m));
}

void seek_trigger(Machine::State& s, Motor& m, double trigger_distance_mu, const JogParameters& parameters) {
  m.task = Motor::Task::kSeekTrigger;
  m.trigger_not_found = false;
  m.trigger_distance_mu = trigger_distance_mu;
  m.trigger_parameters = parameters;
  find_trigger(s, m);
}

void trigger_captured(Machine::State& s, Motor& m, double place_raw_mu) {
  if (!m.seeks_trigger()) return;
  const double now = m.profile_time(s.now_ms);
  turn_to_trigger(s, m, now, m.profile.position_mu(now), place_raw_mu - m.home_position_mu);
}

void trigger_moved(Machine::State& s, Motor& m) {
  if (m.seeks_trigger()) find_trigger(s, m);
}

std::vector<motion::GoverningShare> governed_by_itself(const Machine::State& s, const Motor& m) {
  if (!s.options.note_governing || !std::isfinite(m.profile.end_ms())) return {};
  const double cruise_ms = m.profile.cruise_ms(), ramps_ms = m.profile.end_ms() - m.profile.start_ms() - cruise_ms;
  motion::GoverningShare speed{motion::GoverningLimit::kJogSpeed, m.number, cruise_ms}, ramps{motion::GoverningLimit::kJogRamp, m.number, ramps_ms};
  if (ramps_ms > cruise_ms) std::swap(speed, ramps);
  return {speed, ramps};
}

double next_motor_event_ms(const Motor& m) {
  if (m.source != Motor::Source::kProfile) return m.kill_ms;
  const double end_ms = std::min(m.profile_end_ms(), m.kill_ms);
  return m.seeks_trigger() ? std::min(m.trigger_ms(), end_ms) : end_ms;
}

void service_motor(Machine::State& s, Motor& m) {
  if (m.seeks_trigger() && m.trigger_ms() <= s.now_ms) pass_trigger(s, m);
  if (m.source == Motor::Source::kProfile && m.profile_end_ms() <= s.now_ms) arrive(m, s.now_ms);
  if (m.kill_at_rest && !m.moving()) delay_kill(s, m, s.now_ms);
  if (m.kill_ms <= s.now_ms) m.kill(s.now_ms);
  if (m.jogging && !m.moving()) report(s, m);
}

}  // namespace pmac::runtime
