// One simulated motor: where its commanded position comes from, and its status. Positions are in motor units from home. The servo
// loop is ideal: the actual position is the commanded one.
#pragma once

#include <cmath>
#include <limits>

#include "compiler/bytecode/bytecode.h"
#include "runtime/motion/profile.h"

namespace pmac::runtime {

struct Motor {
  enum class Source { kRest, kProfile, kPath };  // kPath: its coordinate system's pipeline

  int number = 0;
  Source source = Source::kRest;
  motion::MotorProfile profile;
  double position_mu = 0;          // at the last servo tick or event
  double velocity_mu_ms = 0;       // of path motors, at the last event
  double rest_since_ms = -std::numeric_limits<double>::infinity();
  double home_position_mu = 0;     // HomePos
  double prejog_mu = 0;
  bool closed_loop = true, amplifier_enabled = true, home_complete = true;
  double jog_start_ms = 0, jog_start_mu = 0;  // of the jog that is under way
  bytecode::SourceLine jog_source;
  bool jogging = false;
  bool in_use = false;             // belongs to a coordinate system, or has moved
  int coord = -1;                  // coordinate system it is defined in, -1 none

  bool moving() const { return source != Source::kRest; }

  double position_at(double time_ms) const {
    return source == Source::kProfile ? profile.position_mu(time_ms) : position_mu;
  }
  double velocity_at(double time_ms) const {
    if (source == Source::kProfile) return profile.velocity_mu_ms(time_ms);
    return source == Source::kPath ? velocity_mu_ms : 0.0;
  }
  /// Of a motor on a profile; a path motor's is not continued.
  double accel_at(double time_ms) const { return source == Source::kProfile ? profile.accel_mu_ms2(time_ms) : 0.0; }
  void follow(const motion::MotorProfile& p) {
    profile = p;
    source = Source::kProfile;
    in_use = true;
  }
  void rest(double time_ms, double at_mu) {
    if (source != Source::kRest) rest_since_ms = time_ms;
    source = Source::kRest;
    position_mu = at_mu;
    velocity_mu_ms = 0;
  }
  /// homez: home is where the motor stands.
  void home_here(double time_ms) {
    home_position_mu += position_at(time_ms);
    rest(time_ms, 0);
    home_complete = true;
  }
  /// A profile that has ended by time_ms becomes rest at its own end.
  void settle(double time_ms) {
    if (source == Source::kProfile && profile.end_ms() <= time_ms) rest(profile.end_ms(), profile.target_mu());
  }
  /// Consecutive in-position checks at servo ticks up to time_ms.
  double checks_at_rest(double time_ms, double period_ms) const {
    if (moving()) return 0;
    if (std::isinf(rest_since_ms)) return std::numeric_limits<double>::infinity();
    return std::floor(time_ms / period_ms + 1e-9) - std::ceil(rest_since_ms / period_ms - 1e-9) + 1;
  }
};

}  // namespace pmac::runtime
