// Bit fields of words, as M-variable definitions name them: ".start.width", unsigned or two's complement (Users Manual p560).
#pragma once

#include <cstdint>

#include "compiler/bytecode/bytecode.h"

namespace pmac::runtime {

/// Value of the field definition.start_bit, definition.width of a word.
double read_bits(std::uint32_t word, const bytecode::PointerDefinition& definition);

/// The word with the field set to value, truncated toward zero and masked to the width; other bits are kept. A value that is
/// no 64-bit integer counts as integer_from() takes it (nan is 0).
std::uint32_t write_bits(std::uint32_t word, const bytecode::PointerDefinition& definition, double value);

/// The same on the integer value of an element, whose bits above 31 are kept.
double read_bit_field(double element_value, const bytecode::PointerDefinition& definition);
double write_bit_field(double element_value, const bytecode::PointerDefinition& definition, double value);

}  // namespace pmac::runtime
