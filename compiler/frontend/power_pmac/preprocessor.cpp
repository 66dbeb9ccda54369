#include "compiler/frontend/power_pmac/preprocessor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <utility>

#include "compiler/frontend/power_pmac/plain_lines.h"
#include "compiler/frontend/power_pmac/plain_moves.h"
#include "compiler/frontend/power_pmac/turbo_text.h"

namespace pmac::compiler::power_pmac {
namespace {

using Kind = PreprocessorToken::Kind;

constexpr std::size_t kMaxExpandedBytes = 512u << 20;  // of one file with what it includes

bool is_name_start(char c) { return std::isalpha(static_cast<unsigned char>(c)) || c == '_'; }
bool is_name_part(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }
bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\f' || c == '\v'; }
bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

Kind kind_at(char c) {
  if (is_name_start(c)) return Kind::kIdentifier;
  if (is_digit(c)) return Kind::kNumber;
  if (c == '"') return Kind::kString;
  if (c == '\n') return Kind::kNewline;
  return is_blank(c) ? Kind::kBlank : Kind::kOther;
}

/// A number takes no letters: 1X stays two tokens, as the controller's loader reads b1r. $ takes hex digits.
std::size_t end_of_token(std::string_view text, std::size_t at, source::ClosingMarks& marks) {
  std::size_t end = at + 1;
  const auto run = [&](auto accepts) { while (end < text.size() && accepts(text[end])) ++end; };
  switch (kind_at(text[at])) {
    case Kind::kIdentifier: run(is_name_part); break;
    case Kind::kNumber: run(is_digit); break;
    case Kind::kBlank: run(is_blank); break;
    case Kind::kString: return marks.end_of(at);
    default:
      if (text[at] == '$') run([](char c) { return std::isxdigit(static_cast<unsigned char>(c)) != 0; });
      break;
  }
  return end;
}

}  // namespace

void ExpandedText::append(std::string_view text, const source::Span& span, bool exact) {
  if (text.empty()) return;
  const auto continues_last = [&](const Segment& last) {
    return exact && last.exact && last.span.file == span.file && last.span.expansion == -1 && span.expansion == -1 &&
           last.span.begin + (text_.size() - last.begin) == span.begin;
  };
  if (!segments_.empty() && continues_last(segments_.back())) segments_.back().span.end = span.end;
  else segments_.push_back({text_.size(), span, exact});
  text_ += text;
}

void ExpandedText::append_plain_moves(ir::MoveRows moves, const source::Span& span) {
  moves_.emplace(text_.size(), std::move(moves));
  append(std::string{kPlainMovesMark, '\n'}, span, false);
}

void ExpandedText::append_plain_lines(ir::Body statements, const source::Span& span) {
  lines_.emplace(text_.size(), std::make_unique<ir::Body>(std::move(statements)));
  append(std::string{kPlainMovesMark, '\n'}, span, false);
}

ir::Body* ExpandedText::plain_lines_at(std::size_t offset) const {
  const auto found = lines_.find(offset);
  return found == lines_.end() ? nullptr : found->second.get();
}

const ir::MoveRows* ExpandedText::plain_moves_at(std::size_t offset) const {
  const auto found = moves_.find(offset);
  return found == moves_.end() ? nullptr : &found->second;
}

ExpandedText ExpandedText::with_moves_written_out(const source::SourceManager& sources) const {
  ExpandedText result;
  for (std::size_t i = 0; i < segments_.size(); ++i) {
    const Segment& segment = segments_[i];
    const std::size_t end = i + 1 < segments_.size() ? segments_[i + 1].begin : text_.size();
    if (!moves_.contains(segment.begin) && !lines_.contains(segment.begin)) {
      result.append(std::string_view(text_).substr(segment.begin, end - segment.begin), segment.span, segment.exact);
      continue;
    }
    const std::string_view file = sources.file(segment.span.file).text;
    for (std::size_t at = segment.span.begin; at < segment.span.end;) {
      const std::size_t line_end = file.find('\n', at);
      const std::size_t comment = file.substr(at, line_end - at).find("//");
      const std::size_t code_end = comment == std::string_view::npos ? line_end : at + comment;
      const auto place = [&](std::size_t begin, std::size_t last) { return source::Span{segment.span.file, static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(last), -1}; };
      result.append(file.substr(at, code_end - at), place(at, code_end), true);
      result.append("\n", place(line_end, line_end + 1), true);
      at = line_end + 1;
    }
  }
  return result;
}

ExpandedText ExpandedText::text_only() const {
  ExpandedText result;
  result.text_ = text_;
  result.segments_ = segments_;
  return result;
}

source::Span ExpandedText::span_at(std::size_t offset) const {
  const auto after = std::upper_bound(segments_.begin(), segments_.end(), offset, [](std::size_t o, const Segment& s) { return o < s.begin; });
  if (after == segments_.begin()) return {};
  const Segment& segment = *std::prev(after);
  if (!segment.exact) return segment.span;
  source::Span span = segment.span;
  span.begin = static_cast<std::uint32_t>(segment.span.begin + (offset - segment.begin));
  span.end = span.begin + 1;
  return span;
}

source::Span ExpandedText::span_of(std::size_t begin, std::size_t end) const {
  const source::Span first = span_at(begin);
  return end > begin + 1 ? source::join(first, span_at(end - 1)) : first;
}

PreprocessorTokens split_tokens(std::string_view text, const source::Span& span) {
  PreprocessorTokens tokens;
  source::ClosingMarks marks(text);
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = end_of_token(text, at, marks);
    source::Span place = span;
    place.begin = static_cast<std::uint32_t>(span.begin + at);
    place.end = static_cast<std::uint32_t>(span.begin + end);
    tokens.push_back({kind_at(text[at]), text.substr(at, end - at), place});
    at = end;
  }
  return tokens;
}

Preprocessor::Preprocessor(source::SourceManager& sources, source::Diagnostics& diagnostics, std::vector<std::string> include_dirs)
    : sources_(sources), diagnostics_(diagnostics), include_dirs_(std::move(include_dirs)), macros_(sources, diagnostics) {}

ExpandedText Preprocessor::run(std::int32_t file) {
  ExpandedText out;
  out_ = &out;
  include_count_ = 0;
  includes_stopped_ = false;
  in_program_ = false;
  run_file(file);
  out_ = nullptr;
  return out;
}

void Preprocessor::define(const std::string& name, const std::string& text) {
  const std::int32_t file = sources_.add_file("<command line>", name + " " + (text.empty() ? "1" : text));
  const std::string& whole = sources_.file(file).text;
  const auto size = static_cast<std::uint32_t>(whole.size());
  define_directive(split_tokens(whole, {file, 0, size, -1}), 0, {file, 0, size, -1});
}

void Preprocessor::run_file(std::int32_t file) {
  const std::size_t open_conditionals = conditionals_.size();
  const std::string& text = sources_.file(file).text;
  std::size_t cursor = text.starts_with("\xef\xbb\xbf") ? 3 : 0;
  const bool turbo_before = std::exchange(turbo_file_, is_turbo_text(text));
  const source::ClosingMarks marks_before = std::exchange(marks_, source::ClosingMarks(text));
  record(SourceLine::Kind::kFileBegins, {}, file);
  while (cursor < text.size()) {
    const std::size_t line_begin = cursor;
    Tokens line = next_line(file, cursor);
    follow_program(line);
    if (!take_directive(line) && is_active()) emit_line(std::move(line), file, cursor);
    else out_->append("\n", {file, static_cast<std::uint32_t>(cursor - 1), static_cast<std::uint32_t>(cursor), -1}, true);
    if (in_program_ && line_begin >= plain_tried_) take_plain_text(file, cursor);
    if (out_->text().size() <= kMaxExpandedBytes) continue;
    diagnostics_.error("PM1012", {file, static_cast<std::uint32_t>(cursor - 1), static_cast<std::uint32_t>(cursor), -1}, fmt::format("this file expands to more than {} MiB of text", kMaxExpandedBytes >> 20));
    break;
  }
  record(SourceLine::Kind::kFileEnds, {}, file);
  while (conditionals_.size() > open_conditionals) {
    diagnostics_.error("PM1007", conditionals_.back().span, "#if without #endif");
    conditionals_.pop_back();
  }
  turbo_file_ = turbo_before;
  marks_ = marks_before;
}

/// Moves stand in prog and subprog buffers; elsewhere the grammar says what is wrong with them.
void Preprocessor::follow_program(const Tokens& line) {
  if (!is_active()) return;
  const auto is_word = [](const PreprocessorToken& token, std::string_view word) {
    return token.kind == Kind::kIdentifier && token.text.size() == word.size() &&
           std::equal(word.begin(), word.end(), token.text.begin(), [](char a, char b) { return a == std::tolower(static_cast<unsigned char>(b)); });
  };
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (is_word(line[i], "close")) in_program_ = false;
    const std::size_t next = is_word(line[i], "open") ? skip_blanks(line, i + 1) : line.size();
    if (next < line.size()) in_program_ = is_word(line[next], "prog") || is_word(line[next], "subprog");
  }
}

/// The fast paths: the plain lines from the cursor on, when they are many. The line in front of them went through the grammar, or was
/// one of them, so that a statement which is open there ends with it.
void Preprocessor::take_plain_text(std::int32_t file, std::size_t& cursor) {
  const std::string_view text = sources_.file(file).text;
  if (!is_active() || recording_ || cursor < 2) return;
  const bool moves = moves_wanted_ && !macros_.may_change_moves(), lines = lines_wanted_ && !macros_.may_change_lines();
  const std::size_t last_line = text.rfind('\n', cursor - 2);
  std::size_t line_end = 0;
  const std::size_t before = last_line == std::string_view::npos ? 0 : last_line + 1;
  const bool behind_move = moves && is_plain_move(text, before, line_end) && line_end == cursor;
  if (!behind_move && !(lines && is_plain_line(text, before, line_end) && line_end == cursor)) return;
  bool taken = true;
  while (taken) taken = (moves && take_plain_moves(file, cursor)) || (lines && take_plain_lines(file, cursor));
}

bool Preprocessor::take_plain_moves(std::int32_t file, std::size_t& cursor) {
  const std::string_view text = sources_.file(file).text;
  const PlainMoveLines lines = count_plain_moves(text, cursor, kMinPlainMoves);
  plain_tried_ = std::max(plain_tried_, lines.end);
  if (lines.count < kMinPlainMoves) return false;
  std::size_t end = cursor;
  ir::MoveRows moves = power_pmac::read_plain_moves(text, cursor, file, sources_.line_column(file, static_cast<std::uint32_t>(cursor)).line, end);
  out_->append_plain_moves(std::move(moves), {file, static_cast<std::uint32_t>(cursor), static_cast<std::uint32_t>(end), -1});
  cursor = plain_tried_ = end;
  return true;
}

bool Preprocessor::take_plain_lines(std::int32_t file, std::size_t& cursor) {
  PlainLines lines = read_plain_lines(sources_.file(file).text, cursor, file);
  plain_tried_ = std::max(plain_tried_, lines.tried);
  if (lines.lines < kMinPlainMoves) return false;
  out_->append_plain_lines(std::move(lines.body), {file, static_cast<std::uint32_t>(cursor), static_cast<std::uint32_t>(lines.end), -1});
  cursor = plain_tried_ = lines.end;
  return true;
}

bool Preprocessor::begins_turbo_comment(std::string_view text, std::size_t at) const {
  if (turbo_file_) return true;
  return reads_as_prose(text.substr(at + 1, std::min(text.find('\n', at), text.size()) - at - 1));
}

void Preprocessor::report_turbo_comment(std::int32_t file, std::size_t at) {
  if (!is_active()) return;
  const source::Span span{file, static_cast<std::uint32_t>(at), static_cast<std::uint32_t>(at + 1), -1};
  auto& error = diagnostics_.error("PM2020", span, "; ends a statement and begins no comment; write //");
  error.fix = source::FixIt{span, "//"};
}

/// One line with its line end, comments left out; goes on over line ends inside block comments, and after a backslash where the
/// line is a directive.
Preprocessor::Tokens Preprocessor::next_line(std::int32_t file, std::size_t& cursor) {
  const std::string_view text = sources_.file(file).text;
  Tokens line;
  const auto add = [&](std::size_t begin, std::size_t end) {
    const Tokens piece = split_tokens(text.substr(begin, end - begin), {file, static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end), -1});
    line.insert(line.end(), piece.begin(), piece.end());
  };
  const auto is_directive = [&] {
    const std::size_t first = skip_blanks(line, 0);
    return first + 1 < line.size() && line[first].text == "#" && line[first + 1].kind == Kind::kIdentifier;
  };
  std::size_t start = cursor;
  while (cursor < text.size()) {
    const char c = text[cursor];
    const char next = cursor + 1 < text.size() ? text[cursor + 1] : '\0';
    if (c == '\n') {
      add(start, ++cursor);
      return line;
    }
    if (c == '"') {
      cursor = marks_.end_of(cursor);
    } else if (c == '/' && next == '/') {
      add(start, cursor);
      cursor = std::min(text.find('\n', cursor), text.size());
      start = cursor;
    } else if (c == ';' && begins_turbo_comment(text, cursor)) {
      add(start, cursor);
      report_turbo_comment(file, cursor);
      cursor = std::min(text.find('\n', cursor), text.size());
      start = cursor;
    } else if (c == '/' && next == '*') {
      add(start, cursor);
      const std::size_t end = text.find("*/", cursor + 2);
      const source::Span opening{file, static_cast<std::uint32_t>(cursor), static_cast<std::uint32_t>(cursor + 2), -1};
      if (end == std::string_view::npos) diagnostics_.error("PM1001", opening, "comment is not closed; add */");
      const std::size_t after = end == std::string_view::npos ? text.size() : end + 2;
      check_swallowed_program(text.substr(cursor, after - cursor), opening);
      const bool spans_lines = text.substr(cursor, after - cursor).find('\n') != std::string_view::npos;
      line.push_back({spans_lines ? Kind::kNewline : Kind::kBlank, spans_lines ? "\n" : " ", opening});
      start = cursor = after;
      if (spans_lines && is_directive()) return line;
    } else if (c == '\\' && (next == '\n' || (next == '\r' && text.substr(cursor).starts_with("\\\r\n")))) {
      add(start, cursor);
      const bool continued = is_directive();
      if (!continued) add(cursor, cursor + 1);
      cursor += next == '\n' ? 2 : 3;
      start = continued ? cursor : cursor - 1;
      if (!continued) { add(start, cursor); return line; }
    } else {
      ++cursor;
    }
  }
  add(start, cursor);
  return line;
}

/// A line of nothing but /***** opens a comment; when that takes in an open ... close, the program is lost without a word.
void Preprocessor::check_swallowed_program(std::string_view comment, const source::Span& span) {
  if (!comment.starts_with("/**") || comment.find('\n') == std::string_view::npos) return;
  bool opened = false;
  bool closed = false;
  for (std::size_t at = 0; at < comment.size();) {
    const std::size_t end = std::min(comment.find('\n', at), comment.size());
    const std::size_t first = std::min(comment.find_first_not_of(" \t", at), end);
    const std::string_view line = comment.substr(first, end - first);
    if (line.starts_with("open ")) opened = true;
    if (opened && line.starts_with("close")) closed = true;
    at = end + 1;
  }
  if (!closed) return;
  auto& warning = diagnostics_.warning("PM1002", span, "this comment takes in a whole program, which is not compiled; a line /*****/ is complete, a line /***** opens a comment");
  const std::size_t stars = comment.find_first_not_of('*', 1);
  warning.fix = source::FixIt{{span.file, span.begin + static_cast<std::uint32_t>(stars), span.begin + static_cast<std::uint32_t>(stars), -1}, "/"};
}

void Preprocessor::emit_line(Tokens line, std::int32_t file, std::size_t& cursor) {
  constexpr int kMaxCallLines = 200;
  const std::size_t end = sources_.file(file).text.size();
  for (int lines = 0; cursor < end && lines < kMaxCallLines && macros_.needs_next_line(line); ++lines) {
    const Tokens more = next_line(file, cursor);
    if (!take_directive(more) && is_active()) line.insert(line.end(), more.begin(), more.end());
  }
  record(SourceLine::Kind::kText, line, file);
  for (const PreprocessorToken& token : macros_.expand(line))
    out_->append(token.text, token.span, token.span.expansion < 0 && token.text.size() == token.span.end - token.span.begin);
}

void Preprocessor::record(SourceLine::Kind kind, const Tokens& tokens, std::int32_t file) {
  if (recording_) recorded_.push_back({kind, tokens, file});
}

}  // namespace pmac::compiler::power_pmac
