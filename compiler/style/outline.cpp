// Comments, directives and line ends of a text: what the preprocessor takes away before the lexer reads. The rules are those of
// compiler/frontend/power_pmac/preprocessor.cpp; macros are not expanded and conditions not evaluated, but for #if 0.
#include <algorithm>
#include <array>
#include <cctype>

#include "compiler/source/closing_marks.h"
#include "compiler/style/source_text.h"

namespace pmac::style {
namespace {

constexpr std::array<std::string_view, 14> kDirectives{"define", "undef", "ifdef",   "ifndef", "if",      "elif", "else",
                                                       "endif",  "include", "line", "pragma", "warning", "error", "region"};

bool begins_conditional(std::string_view name) { return name == "if" || name == "ifdef" || name == "ifndef"; }

class OutlineReader {
 public:
  explicit OutlineReader(std::string_view text) : text_(text), marks_(text) { outline_.code = std::string(text); }

  Outline run() {
    if (text_.starts_with("\xef\xbb\xbf")) blank_out(0, 3), at_ = 3;
    while (at_ < text_.size()) {
      const char c = text_[at_];
      if (c == '\n' || (c == '\r' && peek(1) == '\n')) take_newline();
      else if (c == '/' && peek(1) == '/') take_comment(end_of_line(at_));
      else if (c == '/' && peek(1) == '*') take_comment(end_of_block_comment(at_));
      else if (is_blank(c)) ++at_;
      else if (c == '#' && !line_has_code_ && is_directive()) take_directive();
      else if (skipping_) take_skipped();
      else take_code();
    }
    return std::move(outline_);
  }

 private:
  char peek(std::size_t ahead) const { return at_ + ahead < text_.size() ? text_[at_ + ahead] : '\0'; }

  void add(PieceKind kind, std::size_t end) {
    outline_.pieces.push_back({static_cast<std::uint32_t>(at_), static_cast<std::uint32_t>(end), 0, kind});
  }

  void blank_out(std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (text_[i] != '\n') outline_.code[i] = ' ';
  }

  void take_newline() {
    const std::size_t end = at_ + (text_[at_] == '\r' ? 2 : 1);
    add(PieceKind::kNewline, end);
    at_ = end;
    line_has_code_ = false;
  }

  void take_comment(std::size_t end) {
    add(PieceKind::kComment, end);
    blank_out(at_, end);
    at_ = end;
  }

  void take_code() {
    line_has_code_ = true;
    at_ = text_[at_] == '"' ? marks_.end_of(at_) : at_ + 1;
  }

  /// End of the line that holds an offset, without its line end.
  std::size_t end_of_line(std::size_t at) const {
    const std::size_t end = std::min(text_.find('\n', at), text_.size());
    return end < text_.size() && end > at && text_[end - 1] == '\r' ? end - 1 : end;
  }

  std::size_t end_of_block_comment(std::size_t at) const {
    const std::size_t end = text_.find("*/", at + 2);
    return end == std::string_view::npos ? text_.size() : end + 2;
  }

  std::string_view directive_name() const {
    std::size_t end = at_ + 1;
    while (end < text_.size() && is_name_part(text_[end])) ++end;
    return text_.substr(at_ + 1, end - at_ - 1);
  }

  bool is_directive() const { return std::find(kDirectives.begin(), kDirectives.end(), directive_name()) != kDirectives.end(); }

  void take_directive() {
    const std::string_view name = directive_name();
    const std::size_t begin = at_;
    const std::size_t end = end_of_directive();
    const std::string_view rest = text_.substr(begin + 1 + name.size(), end - begin - 1 - name.size());
    follow_conditionals(name, rest);
    if (name == "define" && !skipping_) note_macro(rest);
    add(PieceKind::kDirective, end);
    blank_out(at_, end);
    at_ = end;
    line_has_code_ = true;
  }

  /// Behind the last continued line, or where a comment of several lines begins.
  std::size_t end_of_directive() {
    std::size_t at = at_;
    while (at < text_.size()) {
      const std::string_view rest = text_.substr(at, 3);
      if (rest.starts_with("\\\n")) at += 2;
      else if (rest == "\\\r\n") at += 3;
      else if (rest.starts_with("\n") || rest.starts_with("\r\n")) return at;
      else if (rest.starts_with("//")) return end_of_line(at);
      else if (rest.starts_with("\"")) at = marks_.end_of(at);
      else if (rest.starts_with("/*")) {
        const std::size_t end = end_of_block_comment(at);
        if (text_.substr(at, end - at).find('\n') != std::string_view::npos) return at;
        at = end;
      } else ++at;
    }
    return at;
  }

  void note_macro(std::string_view rest) {
    const std::size_t begin = std::min(rest.find_first_not_of(" \t"), rest.size());
    std::size_t end = begin;
    while (end < rest.size() && is_name_part(rest[end])) ++end;
    const bool takes_arguments = end < rest.size() && rest[end] == '(';
    if (end > begin) outline_.macros[std::string(rest.substr(begin, end - begin))] |= takes_arguments;
  }

  /// #if 0 hides text that need not be a program, up to the #else or #endif that belongs to it.
  void follow_conditionals(std::string_view name, std::string_view rest) {
    const std::size_t first = std::min(rest.find_first_not_of(" \t"), rest.size());
    const std::string_view condition = rest.substr(first);
    const bool is_never = name == "if" && condition.starts_with("0") && (condition.size() == 1 || is_blank(condition[1]) || condition[1] == '/');
    if (skipping_ && begins_conditional(name)) ++skipped_depth_;
    else if (skipping_ && name == "endif" && skipped_depth_-- == 0) skipping_ = false;
    else if (skipping_ && (name == "else" || name == "elif") && skipped_depth_ == 0) skipping_ = false;
    else if (!skipping_ && is_never) skipping_ = true, skipped_depth_ = 0;
  }

  /// The rest of a line that #if 0 hides.
  void take_skipped() {
    std::size_t end = at_;
    while (end < text_.size()) {
      const std::string_view rest = text_.substr(end, 2);
      if (rest.starts_with("\n") || rest == "\r\n") break;
      if (rest == "//") { end = end_of_line(end); break; }
      if (rest == "/*") end = end_of_block_comment(end);
      else end = text_[end] == '"' ? marks_.end_of(end) : end + 1;
    }
    add(PieceKind::kSkipped, end);
    blank_out(at_, end);
    at_ = end;
    line_has_code_ = true;
  }

  std::string_view text_;
  source::ClosingMarks marks_;
  Outline outline_;
  std::size_t at_ = 0;
  bool line_has_code_ = false;  // something but blanks and comments since the last line end
  bool skipping_ = false;
  int skipped_depth_ = 0;       // conditionals inside #if 0
};

}  // namespace

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\f' || c == '\v'; }
bool is_name_part(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }

std::string lower_case(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return result;
}

Outline read_outline(std::string_view text) { return OutlineReader(text).run(); }

std::vector<std::string> included_files(std::string_view text) {
  std::vector<std::string> files;
  for (std::size_t at = text.find("#include"); at != std::string_view::npos; at = text.find("#include", at + 1)) {
    const std::size_t line_end = std::min(text.find('\n', at), text.size());
    const std::string_view line = text.substr(at, line_end - at);
    const std::size_t open = line.find_first_of("\"<");
    const std::size_t close = open == std::string_view::npos ? open : line.find_first_of("\">", open + 1);
    if (close != std::string_view::npos) files.emplace_back(line.substr(open + 1, close - open - 1));
  }
  return files;
}

}  // namespace pmac::style
