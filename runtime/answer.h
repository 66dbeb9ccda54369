// Texts of answers that several commands give.
#pragma once

#include <string>
#include <string_view>

#include "runtime/state.h"

namespace pmac::runtime {

// Bits of echo: what answers leave out. Clients send echo 7 for bare values; which bit leaves out what is assumed.
enum EchoBit { kNoNames = 1, kNoDefinitionNames = 2, kNoAddressSigns = 4, kDecimalMasks = 8 };
inline bool echoes_without(const Machine::State& s, EchoBit bit) { return (s.echo & bit) != 0; }

/// "1000x", "8660.25x-5000y+20000", "i", "s", "0": what the motor is defined as.
std::string axis_definition_text(Machine::State& s, const Motor& m);
/// "M5->u.io:$a0000c.12.1".
std::string pointer_definition_text(const Machine::State& s, int m);
/// "#1->1000x", or what is behind the arrow alone, as echo wants it.
std::string definition_answer(const Machine::State& s, const std::string& name, const std::string& definition);

}  // namespace pmac::runtime
