#include "runtime/servo/servo_cycle.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "compiler/bytecode/element.h"
#include "runtime/servo/trigger.h"

namespace pmac::runtime {
namespace {

using bytecode::ElementId;

constexpr double kRounding_mu = 1e-6;  // that a commanded position may pass a software limit by

/// What is looked at, and the limits in force.
struct Watch {
  bool plant = false, closed = true, counts_band = false;
  ServoGains gains;
  ServoPlant body;
  double fatal_mu = 0, warning_mu = 0, band_mu = 0;   // 0: off, for the first two
  double plus_switch_mu = kNever, minus_switch_mu = -kNever;
  PositionRange range;          // of commanded positions on the path
  PositionRange actual_range;   // of a plant
  bool holds_at_limit = false, stops_at_limit = false;
  bool amplifier_fault = false;
  std::optional<Trigger> trigger;
};

/// One motor over a run of interrupts, on copies of its state.
struct Run {
  const Motor* motor = nullptr;
  Watch watch;
  double* commanded = nullptr;
  double* actual = nullptr;
  double period_ms = 0;
  ServoLoop loop;
  double commanded_raw_mu = 0, actual_raw_mu = 0;
  std::int64_t cycles_in_band = 0;
};

ServoGains gains_of(const ElementStore& e, unsigned n) {
  ServoGains g;
  g.kp = e.get(ElementId::kMotorServoKp, n);
  g.ki = e.get(ElementId::kMotorServoKi, n);
  g.kvfb = e.get(ElementId::kMotorServoKvfb, n);
  g.kvff = e.get(ElementId::kMotorServoKvff, n);
  g.kaff = e.get(ElementId::kMotorServoKaff, n);
  g.max_integral = e.get(ElementId::kMotorServoMaxInt, n);
  g.max_error_mu = e.get(ElementId::kMotorServoMaxPosErr, n);
  g.max_output = e.get(ElementId::kMotorMaxDac, n);
  g.integrates_at_rest_only = e.get(ElementId::kMotorServoSwZvInt, n) != 0;
  return g;
}

bool has_plant(const ElementStore& e, int motor) { return e.get(ElementId::kSimMotorPlant, static_cast<unsigned>(motor)) != 0; }

/// Where the software limits themselves are: commanded positions stay SoftLimitOffset inside them.
PositionRange actual_limits(const ElementStore& e, unsigned n) {
  const double min_mu = e.get(ElementId::kMotorMinPos, n), max_mu = e.get(ElementId::kMotorMaxPos, n);
  return max_mu > min_mu ? PositionRange{min_mu, max_mu} : PositionRange{};
}

void watch_plant(const ElementStore& e, const Motor& m, Watch& w) {
  const auto n = static_cast<unsigned>(m.number);
  w.gains = gains_of(e, n);
  w.gains.open_output = m.amplifier_enabled ? m.open_loop_share * w.gains.max_output : 0;
  w.body = {e.get(ElementId::kSimMotorAccelGain, n), e.get(ElementId::kSimMotorFriction, n)};
  w.fatal_mu = e.get(ElementId::kMotorFatalFeLimit, n);
  w.warning_mu = e.get(ElementId::kMotorWarnFeLimit, n);
  w.band_mu = e.get(ElementId::kMotorInPosBand, n);
  if (m.seeks_trigger()) w.trigger = trigger_of(e, m.number);
  const bool stops_already = m.limit_stop == Motor::LimitStop::kPlusPosition || m.limit_stop == Motor::LimitStop::kMinusPosition;
  if (m.moving() && m.closed_loop && !m.homing() && !stops_already) w.actual_range = actual_limits(e, n);
}

void watch_switches(const ElementStore& e, unsigned n, Watch& w) {
  if (e.get(ElementId::kMotorPLimits, n) == 0) return;
  if (e.assigned(ElementId::kSimMotorPlusLimitPos, n)) w.plus_switch_mu = e.get(ElementId::kSimMotorPlusLimitPos, n);
  if (e.assigned(ElementId::kSimMotorMinusLimitPos, n)) w.minus_switch_mu = e.get(ElementId::kSimMotorMinusLimitPos, n);
}

bool reports_fault(const ElementStore& e, const Motor& m) {
  const auto n = static_cast<unsigned>(m.number);
  return m.amplifier_enabled && e.get(ElementId::kSimMotorAmpFault, n) != 0 && e.get(ElementId::kMotorPAmpFault, n) != 0;
}

bool is_watched(const Machine::State& s, const Motor& m) {
  const ElementStore& e = s.elements;
  const auto n = static_cast<unsigned>(m.number);
  const bool switches = e.assigned(ElementId::kSimMotorPlusLimitPos, n) || e.assigned(ElementId::kSimMotorMinusLimitPos, n);
  return has_plant(e, m.number) || switches || reports_fault(e, m) || software_limits(e, m.number).is_on();
}

Watch watch_of(const Machine::State& s, const Motor& m) {
  const ElementStore& e = s.elements;
  const auto n = static_cast<unsigned>(m.number);
  Watch w;
  w.plant = has_plant(e, m.number);
  w.closed = m.closed_loop && e.get(ElementId::kMotorServoCtrl, n) > 0;
  if (w.plant) watch_plant(e, m, w);
  w.counts_band = m.closed_loop && !m.moving() && !(m.coord >= 0 && s.coords[static_cast<std::size_t>(m.coord)]->dwelling());
  watch_switches(e, n, w);
  w.amplifier_fault = reports_fault(e, m);
  if (m.source == Motor::Source::kPath) {
    w.range = software_limits(e, m.number);
    w.holds_at_limit = w.range.is_on() && e.get(ElementId::kCoordSoftLimitStopDis, static_cast<unsigned>(std::max(m.coord, 0))) != 0;
    w.stops_at_limit = w.range.is_on() && !w.holds_at_limit;
  }
  return w;
}

/// What stops the motor at this interrupt.
std::optional<ServoTrip> trip_at(const Run& r, double commanded_raw_mu, double actual_raw_mu) {
  const Watch& w = r.watch;
  const int motor = r.motor->number;
  const double step_mu = commanded_raw_mu - r.commanded_raw_mu, home_mu = r.motor->home_position_mu;
  const bool free_to_trip = r.motor->moving() && r.motor->limit_stop != Motor::LimitStop::kSwitch;
  if (w.amplifier_fault) return ServoTrip{motor, ServoTrip::Kind::kAmplifier, 0};
  if (w.plant && w.closed && w.fatal_mu > 0 && std::abs(r.loop.error_mu()) > w.fatal_mu)
    return ServoTrip{motor, ServoTrip::Kind::kFollowingError, r.loop.error_mu()};
  if (free_to_trip && step_mu > 0 && actual_raw_mu >= w.plus_switch_mu) return ServoTrip{motor, ServoTrip::Kind::kPlusSwitch, actual_raw_mu};
  if (free_to_trip && step_mu < 0 && actual_raw_mu <= w.minus_switch_mu) return ServoTrip{motor, ServoTrip::Kind::kMinusSwitch, actual_raw_mu};
  if (w.stops_at_limit && step_mu > 0 && commanded_raw_mu - home_mu > w.range.max_mu + kRounding_mu)
    return ServoTrip{motor, ServoTrip::Kind::kPlusPosition, commanded_raw_mu - home_mu};
  if (w.stops_at_limit && step_mu < 0 && commanded_raw_mu - home_mu < w.range.min_mu - kRounding_mu)
    return ServoTrip{motor, ServoTrip::Kind::kMinusPosition, commanded_raw_mu - home_mu};
  if (step_mu > 0 && actual_raw_mu - home_mu > w.actual_range.max_mu) return ServoTrip{motor, ServoTrip::Kind::kPlusActual, actual_raw_mu - home_mu};
  if (step_mu < 0 && actual_raw_mu - home_mu < w.actual_range.min_mu) return ServoTrip{motor, ServoTrip::Kind::kMinusActual, actual_raw_mu - home_mu};
  if (w.trigger)
    if (const auto met = w.trigger->met_between(r.actual_raw_mu, actual_raw_mu)) return ServoTrip{motor, ServoTrip::Kind::kTrigger, *met};
  return std::nullopt;
}

/// At most count interrupts; answers how many, the last of which may have brought a trip.
int run(Run& r, int count, std::vector<ServoTrip>& trips) {
  const double home_mu = r.motor->home_position_mu;
  const Watch& w = r.watch;
  for (int k = 0; k < count; ++k) {
    double& commanded = r.commanded[k];
    if (w.holds_at_limit) commanded = std::clamp(commanded, w.range.min_mu, w.range.max_mu);
    if (w.plant) r.loop.step(commanded + home_mu, w.closed, w.gains, w.body, r.period_ms);
    const double actual_raw_mu = w.plant ? r.loop.position_mu() : commanded + home_mu;
    if (w.plant && !w.closed) commanded = actual_raw_mu - home_mu;
    r.actual[k] = w.plant ? actual_raw_mu - home_mu : commanded;
    const auto trip = trip_at(r, commanded + home_mu, actual_raw_mu);
    r.commanded_raw_mu = commanded + home_mu;
    r.actual_raw_mu = actual_raw_mu;
    const bool in_band = w.counts_band && std::abs(r.loop.error_mu()) <= w.band_mu;
    r.cycles_in_band = in_band ? r.cycles_in_band + 1 : 0;
    if (!trip) continue;
    trips.push_back(*trip);
    return k + 1;
  }
  return count;
}

void keep(const Run& r, Motor& m) {
  const Watch& w = r.watch;
  m.has_plant = w.plant;
  m.loop = r.loop;
  m.commanded_raw_mu = r.commanded_raw_mu;
  m.cycles_in_band = r.cycles_in_band;
  m.plus_limit = r.actual_raw_mu >= w.plus_switch_mu;
  m.minus_limit = r.actual_raw_mu <= w.minus_switch_mu;
  m.following_warning = w.plant && w.closed && w.warning_mu > 0 && std::abs(r.loop.error_mu()) > w.warning_mu;
  if (w.plant && !w.closed && !m.moving()) m.position_mu = r.actual_raw_mu - m.home_position_mu;
  const double position_mu = r.commanded_raw_mu - m.home_position_mu;
  if (w.holds_at_limit && position_mu >= w.range.max_mu) m.limit_stop = Motor::LimitStop::kPlusPosition;
  else if (w.holds_at_limit && position_mu <= w.range.min_mu) m.limit_stop = Motor::LimitStop::kMinusPosition;
  else if (w.holds_at_limit) m.limit_stop = Motor::LimitStop::kNone;
}

/// A motor that has just got its plant stands, or goes on, where it was commanded to be.
ServoLoop loop_of(const Machine::State& s, const Motor& m, const Watch& w) {
  if (!w.plant || m.has_plant) return m.loop;
  ServoLoop loop;
  loop.start(m.commanded_raw_mu, m.velocity_at(s.now_ms), s.period_ms());
  return loop;
}

Run start_run(const Machine::State& s, const Motor& m, double* commanded, double* actual) {
  const Watch w = watch_of(s, m);
  const ServoLoop loop = loop_of(s, m, w);
  return {&m, w, commanded, actual, s.period_ms(), loop, m.commanded_raw_mu, w.plant ? loop.position_mu() : m.commanded_raw_mu, m.cycles_in_band};
}

/// Nothing looks at any motor: all are where they are commanded to be.
int pass_through(Machine::State& s, std::span<const int> motors, int count, std::span<double> commanded_mu, std::span<double> actual_mu) {
  const auto n = static_cast<std::size_t>(count);
  for (std::size_t u = 0; u < motors.size(); ++u) {
    Motor& m = s.motors[static_cast<std::size_t>(motors[u])];
    m.commanded_raw_mu = commanded_mu[(u + 1) * n - 1] + m.home_position_mu;
    m.has_plant = m.following_warning = m.plus_limit = m.minus_limit = false;
  }
  if (actual_mu.data() != commanded_mu.data()) std::copy_n(commanded_mu.begin(), motors.size() * n, actual_mu.begin());
  return count;
}

}  // namespace

PositionRange software_limits(const ElementStore& e, int motor) {
  const auto n = static_cast<unsigned>(motor);
  const double min_mu = e.get(ElementId::kMotorMinPos, n), max_mu = e.get(ElementId::kMotorMaxPos, n);
  if (!(max_mu > min_mu)) return {};
  const double inside_mu = std::clamp(e.get(ElementId::kMotorSoftLimitOffset, n), 0.0, (max_mu - min_mu) / 2);
  return {min_mu + inside_mu, max_mu - inside_mu};
}

std::string limit_text(int motor, bool plus, const PositionRange& range) {
  return fmt::format("Motor[{}].{} = {}", motor, plus ? "MaxPos" : "MinPos", plus ? range.max_mu : range.min_mu);
}

bool any_plant(const Machine::State& s, std::span<const int> motors) {
  return std::any_of(motors.begin(), motors.end(), [&](int motor) { return has_plant(s.elements, motor); });
}

bool any_watched(const Machine::State& s, std::span<const int> motors) {
  return std::any_of(motors.begin(), motors.end(), [&](int n) { return is_watched(s, s.motors[static_cast<std::size_t>(n)]); });
}

int run_servos(Machine::State& s, std::span<const int> motors, int count, std::span<double> commanded_mu, std::span<double> actual_mu) {
  s.trips.clear();
  if (!any_watched(s, motors)) return pass_through(s, motors, count, commanded_mu, actual_mu);
  std::array<Run, bytecode::kMaxMotors> runs;
  int used = count;
  for (bool all_alike = false; !all_alike;) {  // again from the beginning where one has cut the run short, so that all end with it
    all_alike = true;
    s.trips.clear();
    for (std::size_t u = 0; u < motors.size(); ++u) {
      const Motor& m = s.motors[static_cast<std::size_t>(motors[u])];
      const std::size_t row = u * static_cast<std::size_t>(count);
      runs[u] = start_run(s, m, commanded_mu.data() + row, actual_mu.data() + row);
      const int n = run(runs[u], used, s.trips);
      all_alike = all_alike && n == used;
      used = n;
    }
  }
  for (std::size_t u = 0; u < motors.size(); ++u) keep(runs[u], s.motors[static_cast<std::size_t>(motors[u])]);
  return used;
}

}  // namespace pmac::runtime
