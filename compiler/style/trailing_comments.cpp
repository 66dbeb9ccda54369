#include "compiler/style/trailing_comments.h"

#include <algorithm>

namespace pmac::style {
namespace {

constexpr std::size_t kTabWidth = 4;
constexpr std::size_t kGap = 2;            // blanks between code and comment, at least
constexpr std::size_t kLongestCode = 60;   // longer lines do not push the comments of the others

}  // namespace

std::size_t end_column(std::string_view text, std::size_t column, bool utf8) {
  for (const char c : text) {
    if (c == '\t') column += kTabWidth - column % kTabWidth;
    else if (!utf8 || (static_cast<unsigned char>(c) & 0xc0) != 0x80) ++column;
  }
  return column;
}

void TrailingComments::begin_line(std::size_t indent) {
  if (indent != indent_) end_block();
  indent_ = indent;
}

void TrailingComments::add_line(std::string code, std::size_t indent) {
  begin_line(indent);
  if (lines_.empty()) {
    out_ += code;
    out_ += line_end_;
  } else {
    lines_.push_back({std::move(code), {}, 0});
  }
}

void TrailingComments::add_line(std::string code, std::size_t indent, std::string_view comment, std::size_t column) {
  begin_line(indent);
  lines_.push_back({std::move(code), comment, column});
}

/// The column that the writer chose, where all comments stand in it and the code leaves room; else two blanks behind the
/// longest line.
std::size_t TrailingComments::common_column() const {
  const std::size_t chosen = lines_.front().column;
  bool is_chosen = true;
  std::size_t needed = 0;
  for (const Line& line : lines_) {
    if (line.comment.empty()) continue;
    const std::size_t end = width(line);
    is_chosen = is_chosen && line.column == chosen && end + kGap <= chosen;
    if (end <= kLongestCode) needed = std::max(needed, end + kGap);
  }
  return is_chosen ? chosen : needed;
}

void TrailingComments::end_block() {
  if (lines_.empty()) return;
  const std::size_t column = common_column();
  for (const Line& line : lines_) write(line, column);
  lines_.clear();
}

void TrailingComments::write(const Line& line, std::size_t comment_column) {
  out_ += line.code;
  if (!line.comment.empty()) {
    const std::size_t end = width(line);
    const bool fits = end + kGap <= comment_column;
    out_.append(fits ? comment_column - end : kGap, ' ');
    out_ += line.comment;
  }
  out_ += line_end_;
}

}  // namespace pmac::style
