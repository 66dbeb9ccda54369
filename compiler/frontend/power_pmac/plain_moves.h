// The fast path for part programs: lines that hold nothing but axis letters, centre letters and numbers,
//
//     X12.5 Y-3 Z0.25
//     X1Y2R5           // a comment may follow
//
// are read here, in front of the preprocessor and the parser, into the rows of bytecode::MoveRun. It takes only lines whose meaning
// does not depend on anything but themselves; for all others, and for runs of a few lines, the grammar is the only reader.
// That both give the same program is what tests/property/plain_moves_test.cpp checks on random lines.
#pragma once

#include <cstddef>
#include <string_view>

#include "compiler/ir/ir.h"

namespace pmac::compiler::power_pmac {

/// Shorter runs are left to the grammar.
inline constexpr std::size_t kMinPlainMoves = 64;

/// One character that stands for a run of plain move lines in expanded text.
inline constexpr char kPlainMovesMark = '\x01';

/// True where the line that begins at `at` is a plain move line. end: behind its line end.
bool is_plain_move(std::string_view text, std::size_t at, std::size_t& end);

/// Where the plain move lines that begin at `at` end, and how many they are; at most `most` are looked at.
struct PlainMoveLines { std::size_t end = 0; std::size_t count = 0; };
PlainMoveLines count_plain_moves(std::string_view text, std::size_t at, std::size_t most);

/// Reads all plain move lines from `at` on. first_line: number of the first; file: for their places. end: behind the last of them.
ir::MoveRows read_plain_moves(std::string_view text, std::size_t at, std::int32_t file, int first_line, std::size_t& end);

/// True for a name that a macro or a declaration could put in the place of words of a plain move: X, X10, YY2.
bool reads_as_move_word(std::string_view name);

}  // namespace pmac::compiler::power_pmac
