// Values as the controller writes them in its answers and saved files. Source: saved configurations (0.442740000000000022,
// 9.9999997e-5, 1.4084582e8, $1fd, Sys.pushm+$2c, EncTable[1].a).
#pragma once

#include <string>

#include "compiler/bytecode/element.h"

namespace pmac::runtime {

/// 18 significant digits at most, the exponent without sign + and without leading zeros.
std::string double_text(double value);
/// The same with the 8 digits of a float.
std::string float_text(double value);
/// $ and hex digits; negative values as 32-bit two's complement.
std::string mask_text(double value);
/// Name of the element that the number is the address of, with the bytes behind it; a number that is no address as it is.
std::string address_text(double value);
/// The value of an element of this type.
std::string value_text(bytecode::ElementType type, double value);

}  // namespace pmac::runtime
