// The letters of letter-number words such as G1, X10 and XX5: A to Z are 1 to 26, AA to ZZ are 27 to 52. Word n is read into D(n),
// and stands for bit n - 1 in the mask D0 (User's Manual, command read).
#pragma once

#include <string>
#include <string_view>

namespace pmac::bytecode {

inline constexpr int kLetterCount = 52;
inline constexpr double kLetterMaskEnd = 4503599627370496.0;  // 2^52: masks of letters are below
inline constexpr int kMaxLineWords = 256;                     // of one line; further ones are refused

/// Number of a letter or doubled letter in either case, or 0.
int letter_number(std::string_view name);
/// "G", "XX"; "?" for 0 and numbers above kLetterCount.
std::string letter_name(int number);
/// D F G H M S T: each has an element of Coord[] with the number of its subprogram.
bool is_code_letter(int number);

}  // namespace pmac::bytecode
