// Arguments of verbs that are no numbers: what a statement leaves out, and the list *. Each is one particular nan, so that what a program
// has calculated is not taken for them.
#pragma once

#include <bit>
#include <cstdint>

namespace pmac::bytecode {

/// Quiet nans with payloads of their own; calculations give nans without one.
inline double missing_argument() { return std::bit_cast<double>(std::uint64_t{0x7FF8'0000'6D69'7373}); }
inline double all_of_them() { return std::bit_cast<double>(std::uint64_t{0x7FF8'0000'616C'6C00}); }

inline bool is_missing(double argument) { return std::bit_cast<std::uint64_t>(argument) == std::bit_cast<std::uint64_t>(missing_argument()); }
inline bool is_all(double argument) { return std::bit_cast<std::uint64_t>(argument) == std::bit_cast<std::uint64_t>(all_of_them()); }

}  // namespace pmac::bytecode
