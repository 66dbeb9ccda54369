#include "runtime/motor_moves.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "compiler/bytecode/element.h"

namespace pmac::runtime {
namespace {

using bytecode::ElementId;
using motion::JogParameters;
using motion::MotorProfile;

double element(const Machine::State& s, ElementId id, const Motor& m) { return s.elements.get(id, static_cast<unsigned>(m.number)); }

JogParameters parameters_at(const Machine::State& s, const Motor& m, double speed_mu_ms) {
  return {speed_mu_ms, element(s, ElementId::kMotorJogTa, m), element(s, ElementId::kMotorJogTs, m)};
}

JogParameters jog_parameters(const Machine::State& s, const Motor& m) { return parameters_at(s, m, element(s, ElementId::kMotorJogSpeed, m)); }

/// A motor of a coordinate system runs by its time base. User's Manual p693.
const TimeBase* clock_of(Machine::State& s, const Motor& m) { return m.coord >= 0 ? s.coord(m.coord).clock_for_motion(s.now_ms) : nullptr; }

double clock_ms(const TimeBase* clock, double time_ms) { return clock ? clock->path_at(time_ms) : time_ms; }

/// Where the trigger lies, from home; nullopt: there is none.
std::optional<double> trigger_mu(const Machine::State& s, const Motor& m) {
  const auto n = static_cast<unsigned>(m.number);
  if (!s.elements.assigned(ElementId::kSimMotorTriggerPos, n)) return std::nullopt;
  return s.elements.get(ElementId::kSimMotorTriggerPos, n) - m.home_position_mu;
}

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

void find_trigger(Machine::State& s, Motor& m) {
  const auto at_mu = trigger_mu(s, m);
  m.trigger_at = at_mu ? m.profile.first_time_at(*at_mu, m.profile_time(s.now_ms)) : std::numeric_limits<double>::infinity();
}

/// The profile has passed the trigger: from there, at the speed that there was, to the place that was asked for.
void turn_to_trigger(Machine::State& s, Motor& m) {
  const double at_ms = m.trigger_at, at_mu = trigger_mu(s, m).value_or(m.profile.position_mu(at_ms));
  const Motor::Task then = m.task == Motor::Task::kSeekHome ? Motor::Task::kReturnHome : Motor::Task::kNone;
  m.follow(MotorProfile::move(at_ms, at_mu, m.profile.velocity_mu_ms(at_ms), at_mu + m.trigger_distance_mu, m.trigger_parameters,
                              m.profile.accel_mu_ms2(at_ms)), m.clock);
  m.task = then;
}

void report(Machine::State& s, Motor& m) {
  m.jogging = false;
  if (s.options.observers.move)
    s.options.observers.move({m.jog_mode, m.jog_source, -1, m.number, m.jog_start_ms, m.rest_since_ms, std::abs(m.position_mu - m.jog_start_mu)});
}

void arrive(Motor& m, double time_ms) {
  const Motor::Task task = m.task;
  if (task == Motor::Task::kSeekTrigger) m.trigger_not_found = true;
  m.settle(time_ms);
  if (task != Motor::Task::kReturnHome) return;
  m.jog_start_mu -= m.position_mu;   // the place where it started, from the new home
  m.home_here(m.rest_since_ms);
}

}  // namespace

std::string jog_to(Machine::State& s, Motor& m, double target_mu, bytecode::SourceLine source, std::optional<double> trigger_distance_mu) {
  const double distance_mu = trigger_distance_mu.value_or(0);
  if (!std::isfinite(target_mu) || !std::isfinite(distance_mu))
    return fmt::format("error #21: ILLEGAL PARAMETER: jog target {} of motor {}", number_text(std::isfinite(target_mu) ? distance_mu : target_mu), m.number);
  begin_record(s, m, "jog", source);
  move_to(s, m, target_mu, jog_parameters(s, m));
  if (trigger_distance_mu) seek_trigger(s, m, distance_mu, jog_parameters(s, m));
  return {};
}

std::string jog_endless(Machine::State& s, Motor& m, int direction, bytecode::SourceLine source) {
  begin_record(s, m, "jog", source);
  move_endless(s, m, direction, jog_parameters(s, m));
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
  if (speed_mu_ms == 0 || !std::isfinite(speed_mu_ms)) return fmt::format("error #21: ILLEGAL PARAMETER: Motor[{}].HomeVel is {}", m.number, number_text(speed_mu_ms));
  if (!trigger_mu(s, m))
    return fmt::format("error #21: ILLEGAL PARAMETER: motor {} has no trigger and would move for ever; say where it is: Sim.Motor[{}].TriggerPos=...",
                       m.number, m.number);
  const JogParameters parameters = parameters_at(s, m, std::abs(speed_mu_ms));
  begin_record(s, m, "home", source);
  move_endless(s, m, speed_mu_ms < 0 ? -1 : 1, parameters);
  m.home_complete = false;
  seek_trigger(s, m, element(s, ElementId::kMotorHomeOffset, m), parameters);
  m.task = Motor::Task::kSeekHome;
  if (std::isinf(m.trigger_at))
    s.warn(source, fmt::format("motor {} moves away from its trigger (Sim.Motor[{}].TriggerPos) and will not find it", m.number, m.number));
  return {};
}

Fault killed_under_program(Machine::State& s, const Motor& m) {
  const CoordSystem& coord = s.coord(m.coord);
  return {FaultKind::kMotorKilled, coord.line_in_motion(s.now_ms),
          fmt::format("the loop of motor {} was opened under program {}, which is aborted; abort a program before a motor of it is killed", m.number,
                      coord.runner().thread.top_program().program->number)};
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

void trigger_moved(Machine::State& s, Motor& m) {
  if (m.seeks_trigger()) find_trigger(s, m);
}

double next_motor_event_ms(const Motor& m) {
  if (m.source != Motor::Source::kProfile) return m.kill_ms;
  const double end_ms = std::min(m.profile_end_ms(), m.kill_ms);
  return m.seeks_trigger() ? std::min(m.trigger_ms(), end_ms) : end_ms;
}

void service_motor(Machine::State& s, Motor& m) {
  if (m.seeks_trigger() && m.trigger_ms() <= s.now_ms) turn_to_trigger(s, m);
  if (m.source == Motor::Source::kProfile && m.profile_end_ms() <= s.now_ms) arrive(m, s.now_ms);
  if (m.kill_at_rest && !m.moving()) delay_kill(s, m, s.now_ms);
  if (m.kill_ms <= s.now_ms) {
    const bool in_use = m.coord >= 0 && s.coord(m.coord).program_running();
    if (in_use) s.coord(m.coord).fail(s.now_ms, killed_under_program(s, m));
    m.kill(s.now_ms);
  }
  if (m.jogging && !m.moving()) report(s, m);
}

}  // namespace pmac::runtime
