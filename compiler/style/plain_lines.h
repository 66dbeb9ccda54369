// Part programs of a million lines are mostly lines like `X12.5 Y-3 Z0;`. This reads such lines without the compiler's lexer, ten
// times as fast and with the same result: tests/unit/style/plain_lines_test.cpp compares.
#pragma once

#include <string>
#include <vector>

#include "compiler/style/source_text.h"

namespace pmac::style {

/// Takes lines of nothing but axis, vector and F words with constant numbers out of a code (blanks in their place) and returns their
/// words. Such a line is only taken behind one that ends a statement for certain.
std::vector<Piece> take_plain_lines(std::string& code);

/// The name could stand in a plain line: X1, Y, X1Y2.
bool could_be_plain(std::string_view name);

}  // namespace pmac::style
