#include "compiler/source/suppression.h"

#include <algorithm>

namespace pmac::source {
namespace {

constexpr std::string_view kMark = "pmacc:";

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

std::string_view trim(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

std::string_view trim_front(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(" \t\r"), text.size()));
  return text;
}

/// Reads the marks of a file from its beginning to its end.
class Reader {
 public:
  Reader(const SourceManager& sources, std::int32_t file) : sources_(sources), file_(file), text_(sources.file(file).text) {}

  std::vector<SuppressionComment> run() {
    for (std::size_t at = text_.find(kMark); at != std::string_view::npos; at = text_.find(kMark, at + 1)) take_mark(at);
    return std::move(found_);
  }

 private:
  void take_mark(std::size_t at) {
    const int number = sources_.line_column(file_, static_cast<std::uint32_t>(at)).line;
    if (number != line_number_) begin_line(number);
    const std::size_t column = at - static_cast<std::size_t>(line_.data() - text_.data());
    if (column + kMark.size() > line_.size() || !is_comment_of_its_own(column)) return;
    const std::string_view command = trim_front(line_.substr(column + kMark.size()));
    const bool whole_file = command.starts_with("ignore-file(");
    const std::size_t open = command.find('(');
    const std::size_t close = whole_file || command.starts_with("ignore(") ? command.find_first_of("()", open + 1) : std::string_view::npos;
    if (close == std::string_view::npos || command[close] == '(') {
      if (!command.starts_with("fmt ")) found_.push_back({{}, span_of_word(command), number, false});
      return;
    }
    take_names(command.substr(open + 1, close - open - 1), whole_file, code_before_ ? number : line_behind_comments(number));
  }

  void begin_line(int number) {
    line_number_ = number;
    const std::string_view whole = sources_.line_text(file_, number);
    line_ = trim(whole);
    line_ = whole.substr(0, static_cast<std::size_t>(line_.data() - whole.data()) + line_.size());
    counted_ = 0;
    odd_marks_ = code_before_ = false;
  }

  /// The mark stands behind a // that is not inside of a text. Notes whether there is code in front of it.
  bool is_comment_of_its_own(std::size_t column) {
    std::size_t end = column;
    while (end > counted_ && is_blank(line_[end - 1])) --end;
    const bool behind_slashes = end >= 2 && line_[end - 1] == '/' && line_[end - 2] == '/';
    const std::size_t code_end = behind_slashes ? end - 2 : end;
    for (; counted_ < code_end; ++counted_) {
      odd_marks_ = odd_marks_ != (line_[counted_] == '"');
      code_before_ = code_before_ || !is_blank(line_[counted_]);
    }
    return behind_slashes && !odd_marks_;
  }

  /// The first line behind a comment line that is none.
  int line_behind_comments(int number) {
    if (number >= comments_begin_ && number < comments_end_) return comments_end_;
    const int lines = static_cast<int>(sources_.file(file_).line_starts.size());
    comments_begin_ = number;
    for (comments_end_ = number + 1; comments_end_ < lines && trim_front(sources_.line_text(file_, comments_end_)).starts_with("//");) ++comments_end_;
    return comments_end_;
  }

  void take_names(std::string_view names, bool whole_file, int line) {
    for (std::size_t begin = 0, end = 0; begin <= names.size(); begin = end + 1) {
      end = std::min(names.find(',', begin), names.size());
      const std::string_view name = trim(names.substr(begin, end - begin));
      const char* place = name.empty() ? names.data() : name.data();
      found_.push_back({std::string(name), span_of({place, name.size()}), line, whole_file});
    }
  }

  Span span_of(std::string_view part) const {
    const auto begin = static_cast<std::uint32_t>(part.data() - text_.data());
    return {file_, begin, begin + static_cast<std::uint32_t>(part.size()), -1};
  }
  Span span_of_word(std::string_view part) const { return span_of(part.substr(0, part.find_first_of(" (\t"))); }

  const SourceManager& sources_;
  std::int32_t file_;
  std::string_view text_;
  std::vector<SuppressionComment> found_;
  int line_number_ = 0;
  std::string_view line_;     // without the blanks at its end
  std::size_t counted_ = 0;   // what the next two say is said of the line up to here
  bool odd_marks_ = false;    // a text in quotation marks is open
  bool code_before_ = false;
  int comments_begin_ = 0, comments_end_ = 0;  // lines of nothing but comments
};

}  // namespace

std::vector<SuppressionComment> read_suppressions(const SourceManager& sources, std::int32_t file) { return Reader(sources, file).run(); }

}  // namespace pmac::source
