// The command backup: the set-up as lines that can be loaded.
#pragma once

#include <string>

#include "runtime/state.h"

namespace pmac::runtime {

/// what: empty for everything that differs from the factory's; "sys.", "motor[1].", "coord[0]..", "gate3" for a structure with its
/// defaults; "mdefs" for the definitions of pointers. Answers a refusal or empty.
std::string backup(Machine::State& s, const Thread& thread, std::string what);

}  // namespace pmac::runtime
