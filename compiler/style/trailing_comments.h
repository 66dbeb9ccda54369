// Comments behind code, put one below the other within a block: lines of one level without a blank line or a comment line between.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace pmac::style {

/// Column that a text reaches when it begins in `column`; tabulators stop at every fourth column. utf8: a character of several
/// bytes is one column.
std::size_t end_column(std::string_view text, std::size_t column, bool utf8);

class TrailingComments {
 public:
  TrailingComments(std::string& out, std::string_view line_end, bool utf8) : out_(out), line_end_(line_end), utf8_(utf8) {}

  /// A line of code whose statement stands `indent` blanks in.
  void add_line(std::string code, std::size_t indent);
  /// column: of the comment in the text that was read.
  void add_line(std::string code, std::size_t indent, std::string_view comment, std::size_t column);
  /// Lines of the block go to the output.
  void end_block();

 private:
  struct Line { std::string code; std::string_view comment; std::size_t column; };
  std::size_t width(const Line& line) const { return end_column(line.code, 0, utf8_); }
  std::size_t common_column() const;
  void begin_line(std::size_t indent);
  void write(const Line& line, std::size_t comment_column);

  std::string& out_;
  std::string_view line_end_;
  bool utf8_;
  std::size_t indent_ = 0;   // of the block
  std::vector<Line> lines_;  // from the first one with a comment on
};

}  // namespace pmac::style
