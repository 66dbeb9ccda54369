// The time law of one move. Every card that takes part in a coordinated move computes the same master distance s(t) by itself and
// scales it to its own axis, so that the cards need no other link than a common start.
//
//   speed
//    V |     ____________                      s(t) runs from 0 to the master length: P28, or the move's own length where P28 is 0.
//      |    /  2         \  3                  1  from the entry speed to the peak: ACC upwards, DEC downwards
//      |   / 1            \                    2  at the peak, VEL or as near to it as the length allows
//   v0 |  /                \                   3  STP to rest; with STP 0 there is no third phase, and the peak is the exit
//      +------------------------- t               speed, which the next move takes over if it is waiting
#pragma once

#include <array>

#include "runtime/acr1000/rates.h"

namespace pmac::acr1000 {

/// A stretch of constant acceleration.
struct SpeedPhase {
  double duration_s = 0;
  double start_speed_pulses_s = 0;
  double accel_pulses_s2 = 0;
  double length_pulses() const { return duration_s * (start_speed_pulses_s + accel_pulses_s2 * duration_s / 2); }
};

struct MasterProfile {
  std::array<SpeedPhase, 3> phase;
  double length_pulses = 0;
  double duration_s = 0;
  double exit_speed_pulses_s = 0;   // 0 where the move ends at rest
  bool stop_is_forced = false;      // STP cannot stop within the length; the stop is as hard as it has to be
};

/// s, its first and second derivative.
struct MasterPoint { double distance_pulses, speed_pulses_s, accel_pulses_s2; };

/// length_pulses >= 0, entry_speed_pulses_s >= 0, rates.speed_pulses_s > 0 where the length is not 0. A length of 0 takes no time and
/// loses the entry speed. Where the entry speed is above VEL and the length is too short for DEC, the move passes VEL by and
/// stops or ends as slow as it can; where STP cannot stop in it, one even ramp does, and stop_is_forced says so [assumed].
MasterProfile master_profile(double length_pulses, const Rates& rates, double entry_speed_pulses_s);

/// At time_s since the start; beyond the ends as at the ends.
MasterPoint at(const MasterProfile& profile, double time_s);

}  // namespace pmac::acr1000
