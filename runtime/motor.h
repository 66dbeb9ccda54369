// One simulated motor: where its commanded position comes from, and its status. Positions are in motor units from home unless they say
// raw: those count from power-on. Without a plant (Sim.Motor[].Plant) the actual position is the commanded one.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <string_view>

#include "compiler/bytecode/bytecode.h"
#include "runtime/coordinate/time_base.h"
#include "runtime/motion/profile.h"
#include "runtime/servo/servo_loop.h"

namespace pmac::runtime {

struct Motor {
  enum class Source { kRest, kProfile, kPath };  // kPath: its coordinate system's pipeline
  /// What its profile is part of: up to the trigger, or back to it.
  enum class Task { kNone, kSeekTrigger, kSeekHome, kReturnHome };

  int number = 0;
  Source source = Source::kRest;
  motion::MotorProfile profile;
  const TimeBase* clock = nullptr; // that the profile runs by; null: the machine's time
  double position_mu = 0;          // at the last servo tick or event
  double velocity_mu_ms = 0;       // of path motors, at the last event
  double rest_since_ms = -std::numeric_limits<double>::infinity();
  double home_position_mu = 0;     // HomePos
  double prejog_mu = 0;
  bool closed_loop = true, amplifier_enabled = true, home_complete = true;
  double jog_start_ms = 0, jog_start_mu = 0;  // of the jog that is under way
  bytecode::SourceLine jog_source;
  std::string_view jog_mode = "jog";
  bool jogging = false;
  Task task = Task::kNone;
  double trigger_at = kNever;      // when the profile passes the trigger, in the time of the clock
  double trigger_distance_mu = 0;  // where it goes then, from the trigger
  motion::JogParameters trigger_parameters{};
  bool trigger_not_found = false;
  bool kill_at_rest = false;       // adisable: a delayed kill when it has come to rest
  double kill_ms = kNever;         // of a delayed kill
  bool in_use = false;             // belongs to a coordinate system, or has moved
  int coord = -1;                  // coordinate system it is defined in with an axis, -1 none
  int shares_with = -1;            // whose time base and faults it shares: coord, or that of its null definition
  /// Clock of a spindle: that of its coordinate system, of coordinate system 0, or the machine's time.
  enum class Spindle { kNo, kOwnClock, kClockOf0, kRealTime };
  Spindle spindle = Spindle::kNo;

  // --- the servo and its inputs, at the last servo interrupt (servo/servo_cycle.h) ------------------------------------------
  ServoLoop loop;
  bool has_plant = false;
  double commanded_raw_mu = 0;
  double open_loop_share = 0;      // out: of the largest output, while the loop is open and the amplifier enabled
  std::int64_t cycles_in_band = 0; // consecutive interrupts at rest within InPosBand
  bool following_warning = false, following_fatal = false, amplifier_fault = false;
  bool plus_limit = false, minus_limit = false;   // overtravel switches
  enum class LimitStop { kNone, kSwitch, kPlusPosition, kMinusPosition };
  LimitStop limit_stop = LimitStop::kNone;        // what it has stopped at, or is stopping at, until it is told to move again
  LimitStop clipped_at = LimitStop::kNone;        // its profile ends at a software limit instead of its target

  bool moving() const { return source != Source::kRest; }
  /// Programs of its coordinate system move it.
  bool has_axis() const { return coord >= 0 && spindle == Spindle::kNo; }
  double actual_at(double time_ms) const { return has_plant ? loop.position_mu() - home_position_mu : position_at(time_ms); }
  /// Motor units a servo cycle.
  double actual_velocity_at(double time_ms, double period_ms) const { return has_plant ? loop.velocity_mu_cycle() : velocity_at(time_ms) * period_ms; }
  double following_error_mu() const { return has_plant && closed_loop ? loop.error_mu() : 0; }

  bool seeks_trigger() const { return task == Task::kSeekTrigger || task == Task::kSeekHome; }
  bool homing() const { return task == Task::kSeekHome || task == Task::kReturnHome; }
  double trigger_ms() const { return clock ? clock->time_at(trigger_at) : trigger_at; }
  double profile_time(double time_ms) const { return clock ? clock->path_at(time_ms) : time_ms; }
  double position_at(double time_ms) const {
    return source == Source::kProfile ? profile.position_mu(profile_time(time_ms)) : position_mu;
  }
  double velocity_at(double time_ms) const {
    if (source == Source::kProfile) return profile.velocity_mu_ms(profile_time(time_ms)) * (clock ? clock->rate_at(time_ms) : 1.0);
    return source == Source::kPath ? velocity_mu_ms : 0.0;
  }
  /// Machine time of the profile's end; infinity for a jog without end, and while its clock stands.
  double profile_end_ms() const { return clock ? clock->time_at(profile.end_ms()) : profile.end_ms(); }
  /// Speed and acceleration by a clock, for a profile that goes on from here; of a path motor they are not continued.
  double velocity_by(const TimeBase* by, double time_ms) const {
    if (source != Source::kProfile) return 0;
    if (by == clock) return profile.velocity_mu_ms(profile_time(time_ms));
    const double rate = by ? by->rate_at(time_ms) : 1.0;
    return rate > 0 ? velocity_at(time_ms) / rate : 0;
  }
  double accel_by(const TimeBase* by, double time_ms) const {
    return source == Source::kProfile && by == clock ? profile.accel_mu_ms2(profile_time(time_ms)) : 0.0;
  }
  /// p is in the time of the clock.
  void follow(const motion::MotorProfile& p, const TimeBase* by = nullptr) {
    profile = p;
    clock = by;
    task = Task::kNone;
    source = Source::kProfile;
    in_use = true;
    limit_stop = clipped_at = LimitStop::kNone;
  }
  void follow_path() {
    source = Source::kPath;
    limit_stop = clipped_at = LimitStop::kNone;
  }
  void rest(double time_ms, double at_mu) {
    if (source != Source::kRest) rest_since_ms = time_ms;
    source = Source::kRest;
    task = Task::kNone;
    position_mu = at_mu;
    velocity_mu_ms = 0;
  }
  /// Open loop. A motor without a plant stands where it is; with one it coasts, and its commanded position follows it.
  void kill(double time_ms) {
    rest(time_ms, actual_at(time_ms));
    closed_loop = amplifier_enabled = kill_at_rest = false;
    kill_ms = kNever;
    open_loop_share = 0;
  }
  void enable() {
    closed_loop = amplifier_enabled = true;
    kill_at_rest = false;
    kill_ms = kNever;
    following_fatal = amplifier_fault = false;
  }
  /// homez: home is where the motor stands.
  void home_here(double time_ms) {
    home_position_mu += position_at(time_ms);
    rest(time_ms, 0);
    home_complete = true;
  }
  /// A profile that has ended by time_ms becomes rest at its own end.
  void settle(double time_ms) {
    if (source == Source::kProfile && profile_end_ms() <= time_ms) rest(profile_end_ms(), profile.target_mu());
  }
  /// Consecutive in-position checks at servo ticks up to time_ms.
  double checks_at_rest(double time_ms, double period_ms) const {
    if (moving()) return 0;
    if (std::isinf(rest_since_ms)) return std::numeric_limits<double>::infinity();
    return std::floor(time_ms / period_ms + 1e-9) - std::ceil(rest_since_ms / period_ms - 1e-9) + 1;
  }
};

}  // namespace pmac::runtime
