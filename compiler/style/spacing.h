// Blanks between two words of a line.
#pragma once

#include "compiler/style/statement.h"

namespace pmac::style {

/// Number of blanks, 0 or 1, between the last word of the statement and the next one. written: there is a blank in the text.
/// Where the rules of docs/fmt.md do not say otherwise, a blank stays a blank, and words that touch still touch.
int blanks_between(const SourceText& source, const Statement& statement, const Piece& next, Role next_role, bool written);

}  // namespace pmac::style
