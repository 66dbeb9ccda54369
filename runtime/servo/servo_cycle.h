// Hop 9, behind the commanded positions: every motor's servo over a run of servo interrupts, and what its inputs see. Without a plant
// the actual position is the commanded one and costs nothing. Something that stops a motor (fatal following error, overtravel switch,
// amplifier fault, software limit, a trigger that the actual position has passed) ends the run at its interrupt.
//
// Source: following error, overtravel and software limits, amplifier faults, User's Manual p427-447.
#pragma once

#include <span>
#include <string>

#include "runtime/motor.h"
#include "runtime/state.h"

namespace pmac::runtime {

/// commanded_mu: [motor][count] from home, in; a motor in open loop and one that is held at a software limit change it. actual_mu: likewise,
/// out. Answers how many of the interrupts count; what happened at the last of them is in state.trips.
int run_servos(Machine::State& state, std::span<const int> motors, int count, std::span<double> commanded_mu, std::span<double> actual_mu);

/// True where something may happen at a servo interrupt that its commanded positions have to be looked at for: plants, switches, limits.
bool any_watched(const Machine::State& state, std::span<const int> motors);

/// True where a motor's actual position is not its commanded one.
bool any_plant(const Machine::State& state, std::span<const int> motors);

/// Range that software limits leave to the commanded position, from home; infinite where they are off.
struct PositionRange {
  double min_mu = -kNever, max_mu = kNever;
  bool is_on() const { return max_mu < kNever; }
};
PositionRange software_limits(const ElementStore& elements, int motor);
/// "Motor[1].MaxPos = 5000", for messages.
std::string limit_text(int motor, bool plus, const PositionRange& range);

}  // namespace pmac::runtime
