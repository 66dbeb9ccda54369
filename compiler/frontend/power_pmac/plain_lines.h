// The second fast path for part programs: lines of constants with modes, code letters and block numbers,
//
//     N100 G1 X12.5 Y-3 F200
//     linear abs ta10 F50 X5
//     circle2 X4 Y4 I2 J0     // a comment may follow, or stand alone
//
// are read here into the statements that the grammar would give. Lines that only move are the business of plain_moves.h, which is
// faster still. As there: it takes only lines whose meaning does not depend on anything but themselves, the grammar reads all others,
// and tests/property/plain_moves_test.cpp compares both on random lines.
#pragma once

#include <cstddef>
#include <string_view>

#include "compiler/ir/ir.h"

namespace pmac::compiler::power_pmac {

/// True where the line that begins at `at` is such a line, and not blank. end: behind its line end.
bool is_plain_line(std::string_view text, std::size_t at, std::size_t& end);

/// The statements of all such lines from `at` on, blank lines between them included. Ends where plain moves begin that are enough for
/// plain_moves.h. end: behind the last line; tried: how far was looked.
struct PlainLines { ir::Body body; std::size_t lines = 0, end = 0, tried = 0; };
PlainLines read_plain_lines(std::string_view text, std::size_t at, std::int32_t file);

/// True for a name that a macro or a declaration could put in the place of words of such lines: G1, N5, linear, ta10.
bool reads_as_line_word(std::string_view name);

}  // namespace pmac::compiler::power_pmac
