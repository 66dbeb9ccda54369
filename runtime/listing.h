// The command list.
#pragma once

#include <string>
#include <vector>

#include "runtime/state.h"

namespace pmac::runtime {

/// words: "list", what (prog, subprog, plc, forward, inverse, pc, apc), and its number or name; for pc and apc "," with the number of
/// lines behind it. Answers a refusal or empty.
std::string list(Machine::State& s, int addressed_coord, const std::vector<std::string>& words);

}  // namespace pmac::runtime
