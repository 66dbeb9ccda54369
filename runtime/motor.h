// One simulated motor: where its commanded position comes from, and its status. Positions are in motor units from home. The servo
// loop is ideal: the actual position is the commanded one.
#pragma once

#include <cmath>
#include <limits>
#include <string_view>

#include "compiler/bytecode/bytecode.h"
#include "runtime/coordinate/time_base.h"
#include "runtime/motion/profile.h"

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
  double output_percent = 0;       // of Motor[].MaxDac, in open loop; an ideal motor has no mechanics that it would move
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
  int coord = -1;                  // coordinate system it is defined in, -1 none

  bool moving() const { return source != Source::kRest; }

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
  }
  void rest(double time_ms, double at_mu) {
    if (source != Source::kRest) rest_since_ms = time_ms;
    source = Source::kRest;
    task = Task::kNone;
    position_mu = at_mu;
    velocity_mu_ms = 0;
  }
  /// Open loop; the ideal motor stands where it is.
  void kill(double time_ms) {
    rest(time_ms, position_at(time_ms));
    closed_loop = amplifier_enabled = kill_at_rest = false;
    output_percent = 0;
    kill_ms = kNever;
  }
  /// Open loop with the amplifier on.
  void open_loop(double time_ms, double percent) {
    kill(time_ms);
    amplifier_enabled = true;
    output_percent = percent;
  }
  void enable() {
    output_percent = 0;
    closed_loop = amplifier_enabled = true;
    kill_at_rest = false;
    kill_ms = kNever;
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
