// What a motor's fault or limit does to it and to its coordinate system. Source: fatal following error and amplifier faults kill the
// motor and abort the others of its coordinate system, or with FaultMode bit 0 kill them, too; an overtravel switch aborts all of them;
// other coordinate systems go on; User's Manual p427-447. Inferred: a jog or home search that runs into a switch while no program
// executes is no fault of the run (searching for a switch is done so), it is a warning.
#pragma once

#include "runtime/state.h"

namespace pmac::runtime {

/// Acts on what has happened at the last servo interrupt.
void react_to_trips(Machine::State& state);

}  // namespace pmac::runtime
