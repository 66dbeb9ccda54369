#include "runtime/acr1000/master_profile.h"

#include <algorithm>
#include <cmath>

namespace pmac::acr1000 {
namespace {

/// Relative room for rounding: a move whose length is just what STP needs is no forced stop.
constexpr double kRounding = 1e-9;

double inverse(double rate) { return rate > 0 ? 1 / rate : 0; }


/// The highest speed up to VEL from which STP still stops in the length, with ACC before it.
double peak_upwards(double length, const Rates& rates, double entry) {
  const double inverse_ramps = inverse(rates.accel_pulses_s2) + inverse(rates.stop_pulses_s2);
  if (inverse_ramps == 0) return rates.speed_pulses_s;
  const double reachable2 = (2 * length + entry * entry * inverse(rates.accel_pulses_s2)) / inverse_ramps;
  return std::min(rates.speed_pulses_s, std::sqrt(reachable2));
}

/// VEL, or where DEC does not come down to it in the length, the speed at which STP or the end of the move takes over.
double peak_downwards(double length, const Rates& rates, double entry) {
  const double inverse_decel = inverse(rates.decel_pulses_s2), inverse_stop = inverse(rates.stop_pulses_s2);
  const double vel = rates.speed_pulses_s;
  const double decel_length = (entry * entry - vel * vel) * inverse_decel / 2;
  if (decel_length <= length - vel * vel * inverse_stop / 2) return vel;
  if (inverse_stop == 0) return std::sqrt(entry * entry - 2 * rates.decel_pulses_s2 * length);
  return std::sqrt((entry * entry * inverse_decel - 2 * length) / (inverse_decel - inverse_stop));
}

MasterProfile forced_stop(double length, double entry) {
  MasterProfile profile;
  profile.length_pulses = length;
  profile.duration_s = 2 * length / entry;
  profile.phase[2] = {profile.duration_s, entry, -entry / profile.duration_s};
  profile.stop_is_forced = true;
  return profile;
}

SpeedPhase first_phase(const Rates& rates, double entry, double peak) {
  const double rate = peak >= entry ? rates.accel_pulses_s2 : rates.decel_pulses_s2;
  return {std::abs(peak - entry) * inverse(rate), entry, peak >= entry ? rate : -rate};
}

SpeedPhase stop_phase(const Rates& rates, double peak) {
  return {peak * inverse(rates.stop_pulses_s2), peak, -rates.stop_pulses_s2};
}

}  // namespace

MasterProfile master_profile(double length_pulses, const Rates& rates, double entry_speed_pulses_s) {
  const double entry = entry_speed_pulses_s;
  if (length_pulses <= 0) return {};
  const double shortest_stop = entry * entry * inverse(rates.stop_pulses_s2) / 2;
  if (shortest_stop > length_pulses * (1 + kRounding)) return forced_stop(length_pulses, entry);

  const bool upwards = entry <= rates.speed_pulses_s;
  const double peak = upwards ? peak_upwards(length_pulses, rates, entry) : peak_downwards(length_pulses, rates, entry);
  MasterProfile profile;
  profile.length_pulses = length_pulses;
  profile.phase[0] = first_phase(rates, entry, peak);
  profile.phase[2] = stop_phase(rates, peak);
  const double even_length = length_pulses - profile.phase[0].length_pulses() - profile.phase[2].length_pulses();
  profile.phase[1] = {std::max(0.0, even_length) / peak, peak, 0};
  for (const SpeedPhase& phase : profile.phase) profile.duration_s += phase.duration_s;
  profile.exit_speed_pulses_s = rates.stop_pulses_s2 > 0 ? 0 : peak;
  return profile;
}

MasterPoint at(const MasterProfile& profile, double time_s) {
  double left_s = std::max(0.0, time_s), distance = 0;
  for (const SpeedPhase& phase : profile.phase) {
    if (left_s < phase.duration_s)
      return {std::min(profile.length_pulses, distance + left_s * (phase.start_speed_pulses_s + phase.accel_pulses_s2 * left_s / 2)),
              phase.start_speed_pulses_s + phase.accel_pulses_s2 * left_s, phase.accel_pulses_s2};
    left_s -= phase.duration_s;
    distance += phase.length_pulses();
  }
  return {profile.length_pulses, profile.exit_speed_pulses_s, 0};
}

}  // namespace pmac::acr1000
