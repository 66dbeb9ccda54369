#include "compiler/source/closing_marks.h"

namespace pmac::source {

std::size_t ClosingMarks::end_of(std::size_t opening) {
  if (opening < open_until_) return opening + 1;
  std::size_t at = opening + 1;
  for (; at < text_.size() && !ends_line(text_[at]); ++at) {
    if (text_[at] == '"') return at + 1;
    if (text_[at] != '\\') continue;
    if (line_end_ == LineEnd::kEndsText && at + 1 < text_.size() && ends_line(text_[at + 1])) break;
    ++at;
  }
  open_until_ = at;
  return opening + 1;
}

}  // namespace pmac::source
