// A free run: the stage between two looks of the whole machine, for as long as all that happens is that programs calculate their paths on.
// No motor moves by itself or has a plant, switches or software limits, no PLC program runs, nothing is gathered, and nobody has asked for
// anything. Then an event is the calculation of the coordinate system whose turn it is, and the servo samples between events wait until
// there is a block of them:
//
//     whole machine   service ------------------------------------------------ service
//     free run               calculate  calculate  calculate  calculate
//     samples                                   block ............ block ... the rest
//
// Whatever looks at motors, or changes what acts next, calls State::catch_up() first: the samples up to now are made, and the machine goes
// on as a whole. The samples, and all else that comes out of a run, are the same with and without.
#pragma once

#include <cstdint>

#include "runtime/state.h"

namespace pmac::runtime {

/// Between two looks at the owner's budgets.
inline constexpr std::uint64_t kEventsPerLook = 256;

/// Takes the machine, which has just been serviced, through its events before limit_ms as far as they are those of a free run; it has then
/// been serviced at its present time. event: number of the last event; answers the number of the last one now.
std::uint64_t run_free(Machine::State& state, double limit_ms, std::uint64_t event);

}  // namespace pmac::runtime
