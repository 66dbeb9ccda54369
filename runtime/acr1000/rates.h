// The four rates that a program sets, and what they are in pulses and seconds. The card's manual gives neither unit; both are set-up
// of the simulation.
#pragma once

#include <cstdint>

namespace pmac::acr1000 {

/// As the program writes them: VEL, ACC, DEC, STP. >= 0; 0 of the last three: no ramp, speed changes at once.
struct RateSettings {
  std::int64_t vel = 0, acc = 0, dec = 0, stp = 0;
  bool operator==(const RateSettings&) const = default;
};

/// What one unit of a setting is. [assumed] both 1; the card's documents do not say.
struct RateUnits {
  double vel_unit_pulses_s = 1;
  double ramp_unit_pulses_s2 = 1;
};

struct Rates {
  double speed_pulses_s = 0;   // VEL: of the master, > 0
  double accel_pulses_s2 = 0;  // ACC: from a lower to a higher speed; 0: a step
  double decel_pulses_s2 = 0;  // DEC: from a higher to a lower speed between joined moves; 0: a step
  double stop_pulses_s2 = 0;   // STP: to rest at the end of the move; 0: the move ends at speed and joins the next
};

inline Rates rates_from_settings(const RateSettings& s, const RateUnits& u) {
  return {static_cast<double>(s.vel) * u.vel_unit_pulses_s, static_cast<double>(s.acc) * u.ramp_unit_pulses_s2,
          static_cast<double>(s.dec) * u.ramp_unit_pulses_s2, static_cast<double>(s.stp) * u.ramp_unit_pulses_s2};
}

}  // namespace pmac::acr1000
