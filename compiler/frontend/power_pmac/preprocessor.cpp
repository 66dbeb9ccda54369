#include "compiler/frontend/power_pmac/preprocessor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <utility>

#include "compiler/frontend/power_pmac/turbo_text.h"

namespace pmac::compiler::power_pmac {
namespace {

using Token = PreprocessorToken;
using Kind = PreprocessorToken::Kind;

constexpr std::size_t kMaxExpansionDepth = 200;
constexpr std::size_t kMaxProducedTokens = 200000;
constexpr int kMaxArgumentDepth = 100;  // macro calls inside the arguments of macro calls

bool is_name_start(char c) { return std::isalpha(static_cast<unsigned char>(c)) || c == '_'; }
bool is_name_part(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }
bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\f' || c == '\v'; }
bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

std::size_t end_of_string(std::string_view text, std::size_t at) {
  for (std::size_t i = at + 1; i < text.size() && text[i] != '\n'; ++i) {
    if (text[i] == '\\') ++i;
    else if (text[i] == '"') return i + 1;
  }
  return at + 1;  // not closed: a lone quotation mark
}

Kind kind_at(char c) {
  if (is_name_start(c)) return Kind::kIdentifier;
  if (is_digit(c)) return Kind::kNumber;
  if (c == '"') return Kind::kString;
  if (c == '\n') return Kind::kNewline;
  return is_blank(c) ? Kind::kBlank : Kind::kOther;
}

/// A number takes no letters: 1X stays two tokens, as the controller's loader reads b1r. $ takes hex digits.
std::size_t end_of_token(std::string_view text, std::size_t at) {
  std::size_t end = at + 1;
  const auto run = [&](auto accepts) { while (end < text.size() && accepts(text[end])) ++end; };
  switch (kind_at(text[at])) {
    case Kind::kIdentifier: run(is_name_part); break;
    case Kind::kNumber: run(is_digit); break;
    case Kind::kBlank: run(is_blank); break;
    case Kind::kString: return end_of_string(text, at);
    default:
      if (text[at] == '$') run([](char c) { return std::isxdigit(static_cast<unsigned char>(c)) != 0; });
      break;
  }
  return end;
}

}  // namespace

std::size_t skip_blanks(const std::vector<Token>& line, std::size_t at) {
  while (at < line.size() && (line[at].kind == Kind::kBlank || line[at].kind == Kind::kNewline)) ++at;
  return at;
}

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

std::vector<Token> split_tokens(std::string_view text, const source::Span& span) {
  std::vector<Token> tokens;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = end_of_token(text, at);
    source::Span place = span;
    place.begin = static_cast<std::uint32_t>(span.begin + at);
    place.end = static_cast<std::uint32_t>(span.begin + end);
    tokens.push_back({kind_at(text[at]), text.substr(at, end - at), place});
    at = end;
  }
  return tokens;
}

Preprocessor::Preprocessor(source::SourceManager& sources, source::Diagnostics& diagnostics, std::vector<std::string> include_dirs)
    : sources_(sources), diagnostics_(diagnostics), include_dirs_(std::move(include_dirs)) {}

ExpandedText Preprocessor::run(std::int32_t file) {
  ExpandedText out;
  out_ = &out;
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
  while (cursor < text.size()) {
    Tokens line = next_line(file, cursor);
    if (!take_directive(line) && is_active()) emit_line(std::move(line), file, cursor);
    else out_->append("\n", {file, static_cast<std::uint32_t>(cursor - 1), static_cast<std::uint32_t>(cursor), -1}, true);
  }
  while (conditionals_.size() > open_conditionals) {
    diagnostics_.error("PM1007", conditionals_.back().span, "#if without #endif");
    conditionals_.pop_back();
  }
  turbo_file_ = turbo_before;
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
      cursor = end_of_string(text, cursor);
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

/// A macro call whose arguments go on over the end of the line.
bool Preprocessor::needs_next_line(const Tokens& line) const {
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i].kind != Kind::kIdentifier) continue;
    const auto macro = macros_.find(line[i].text);
    if (macro == macros_.end() || !macro->second.function_like) continue;
    std::size_t at = skip_blanks(line, i + 1);
    if (at < line.size() && line[at].text == "(" && !read_arguments(line, at)) return true;
  }
  return false;
}

void Preprocessor::emit_line(Tokens line, std::int32_t file, std::size_t& cursor) {
  constexpr int kMaxCallLines = 200;
  const std::size_t end = sources_.file(file).text.size();
  for (int lines = 0; cursor < end && lines < kMaxCallLines && needs_next_line(line); ++lines) {
    const Tokens more = next_line(file, cursor);
    line.insert(line.end(), more.begin(), more.end());
  }
  Tokens expanded;
  std::vector<const Macro*> active;
  produced_ = 0;
  expand(line, active, expanded);
  for (const Token& token : expanded) out_->append(token.text, token.span, token.span.expansion < 0 && token.text.size() == token.span.end - token.span.begin);
}

void Preprocessor::expand(const Tokens& in, std::vector<const Macro*>& active, Tokens& out) {
  for (std::size_t i = 0; i < in.size(); ++i) {
    const Token& token = in[i];
    const auto known = token.kind == Kind::kIdentifier ? macros_.find(token.text) : macros_.end();
    const bool usable = known != macros_.end() && std::find(active.begin(), active.end(), &known->second) == active.end();
    if (!usable || active.size() > kMaxExpansionDepth || produced_ > kMaxProducedTokens) {
      out.push_back(token);
      continue;
    }
    i = expand_call(in, i, known->second, active, out);
    if (produced_ > kMaxProducedTokens) diagnostics_.error("PM1012", token.span, fmt::format("macro '{}' expands to too much text", token.text));
  }
}

PreprocessorToken Preprocessor::from_macro(const Token& token, const Macro& macro, const source::Span& use) {
  Token made = token;
  made.span = use;
  made.span.expansion = sources_.add_expansion(macro.name, token.span);
  ++produced_;
  return made;
}

/// Arguments of a macro call; at stands on the opening parenthesis and ends behind the closing one. nullopt: not closed.
std::optional<std::vector<std::vector<PreprocessorToken>>> Preprocessor::read_arguments(const Tokens& in, std::size_t& at) const {
  std::vector<Tokens> arguments(1);
  int depth = 1;
  for (++at; at < in.size(); ++at) {
    const std::string_view text = in[at].text;
    if (text == "(") ++depth;
    if (text == ")" && --depth == 0) return ++at, arguments;
    if (text == "," && depth == 1) arguments.emplace_back();
    else if (in[at].kind == Kind::kNewline) arguments.back().push_back({Kind::kBlank, " ", in[at].span});
    else arguments.back().push_back(in[at]);
  }
  return std::nullopt;
}

/// Expands the macro at in[at]; returns the index of the last token used up.
std::size_t Preprocessor::expand_call(const Tokens& in, std::size_t at, const Macro& macro, std::vector<const Macro*>& active, Tokens& out) {
  const source::Span use = in[at].span;
  std::size_t next = at + 1;
  std::vector<Tokens> arguments;
  if (macro.function_like) {
    std::size_t open = skip_blanks(in, at + 1);
    if (open >= in.size() || in[open].text != "(") return out.push_back(in[at]), at;
    auto read = read_arguments(in, open);
    const std::size_t wanted = std::max<std::size_t>(1, macro.parameters.size());
    if (!read || read->size() != wanted) {
      diagnostics_.error("PM1013", use, fmt::format("macro '{}' takes {} argument(s)", macro.name, macro.parameters.size())).notes.push_back({macro.name_span, "defined here"});
      return out.push_back(in[at]), at;
    }
    if (argument_depth_ >= kMaxArgumentDepth) {
      diagnostics_.error("PM1012", use, fmt::format("calls of macro '{}' are nested too deep in their arguments", macro.name));
      produced_ = kMaxProducedTokens + 1;
      return next - 1;
    }
    ++argument_depth_;
    for (const Tokens& argument : *read) expand(argument, active, arguments.emplace_back());
    --argument_depth_;
    next = open;
  }
  Tokens replaced;
  for (const Token& token : macro.body) {
    const auto parameter = std::find(macro.parameters.begin(), macro.parameters.end(), token.text);
    if (parameter == macro.parameters.end()) {
      replaced.push_back(from_macro(token, macro, use));
      continue;
    }
    const Tokens& argument = arguments[static_cast<std::size_t>(parameter - macro.parameters.begin())];
    produced_ += argument.size();
    if (produced_ <= kMaxProducedTokens) replaced.insert(replaced.end(), argument.begin(), argument.end());
  }
  const Token blank{Kind::kBlank, " ", use};
  out.push_back(blank);
  active.push_back(&macro);
  expand(replaced, active, out);
  active.pop_back();
  out.push_back(blank);
  return next - 1;
}

}  // namespace pmac::compiler::power_pmac
