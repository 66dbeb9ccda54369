// The operators of script expressions on doubles, as the interpreter's instructions and the compiler's constant folding
// share them. Rules: arithmetic is IEEE; the bitwise operators work on 64-bit two's complement integers (Software
// Reference Manual p58-59). What the manual leaves open is decided here and never undefined behaviour.
#pragma once

#include <cmath>
#include <cstdint>

namespace pmac::bytecode {

/// The integer that a bitwise operator sees: truncated toward zero. nan counts as 0; values from 2^63 to below 2^64 (hex
/// masks with the top bit set) keep their 64 bits; anything further out saturates.
std::int64_t integer_from(double value);

/// Modulo. right > 0: left - right * floor(left / right), in [0, right). right < 0: the symmetric rollover in
/// [-|right|, |right|). Computed without the rounding of the quotient. A zero or infinite modulus, an infinite left
/// side and nan give nan.
double modulo(double left, double right);

/// left << count and left >> count (arithmetic). A count below 0 or nan shifts by nothing, one above 63 shifts every
/// bit out: 0, or -1 for a negative number shifted right.
double shift_left(double left, double count);
double shift_right(double left, double count);

inline double bit_and(double left, double right) {
  return static_cast<double>(integer_from(left) & integer_from(right));
}
inline double bit_or(double left, double right) {
  return static_cast<double>(integer_from(left) | integer_from(right));
}
inline double bit_xor(double left, double right) {
  return static_cast<double>(integer_from(left) ^ integer_from(right));
}
inline double bit_not(double value) { return static_cast<double>(~integer_from(value)); }

/// The comparator ~: closer than one half (Training p285).
inline bool is_near(double left, double right) { return std::abs(left - right) < 0.5; }

}  // namespace pmac::bytecode
