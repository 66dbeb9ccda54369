// Random valid projects: a machine, subprograms, a motion program and PLC programs that use every move mode, control flow, calls, expressions,
// synchronous assignments and jogs. Only text: what it means is for others to say.
#pragma once

#include <cstdint>
#include <string>

namespace pmac::reference {

struct RandomMachine {
  std::string text;                 // motion program 1 runs in coordinate system 1 (X Y Z), PLC 1 and 2 are enabled by the text
  bool limits_must_hold = false;    // every move is planned by the lookahead, with limits of speed and acceleration
};

/// Same seed, same text.
RandomMachine random_machine(std::uint32_t seed);

}  // namespace pmac::reference
