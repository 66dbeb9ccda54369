// Texts in quotation marks on a line of source: where they end.
#pragma once

#include <cstddef>
#include <string_view>

namespace pmac::source {

/// Finds the closing quotation marks of one text, asked from its beginning to its end.
///
/// A backslash takes the character behind it away, so that \" closes nothing; a text ends on its line. Method: where a search has
/// come to the end of the line, every mark that it has passed had a backslash before it, and a search from there would read the
/// same characters in the same way. So those marks are known to be not closed, and each line is looked at twice at most.
class ClosingMarks {
 public:
  /// What a backslash before a line end does.
  enum class LineEnd : unsigned char {
    kCanBeTaken,  // the text goes on, as for the preprocessor
    kEndsText     // as for the lexer of the grammar, where a carriage return is a line end, too
  };
  explicit ClosingMarks(std::string_view text, LineEnd line_end = LineEnd::kCanBeTaken) : text_(text), line_end_(line_end) {}

  /// Offset behind the mark that closes the one at `opening`; opening + 1 where none does: that one stands alone.
  std::size_t end_of(std::size_t opening);

 private:
  bool ends_line(char c) const { return c == '\n' || (c == '\r' && line_end_ == LineEnd::kEndsText); }

  std::string_view text_;
  LineEnd line_end_;
  std::size_t open_until_ = 0;  // marks before this place, behind the first that was asked about, are not closed
};

}  // namespace pmac::source
