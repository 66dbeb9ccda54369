#include "compiler/source/format.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace pmac::source {
namespace {

constexpr std::size_t kMaxShownColumns = 160;

struct Paint {
  bool on;
  std::string operator()(std::string_view code, std::string_view text) const {
    return on ? fmt::format("\x1b[{}m{}\x1b[0m", code, text) : std::string(text);
  }
};

std::string_view severity_name(Severity severity) {
  switch (severity) {
    case Severity::kNote: return "note";
    case Severity::kWarning: return "warning";
    case Severity::kError: return "error";
  }
  return "";
}

std::string_view severity_color(Severity severity) {
  switch (severity) {
    case Severity::kNote: return "1;36";
    case Severity::kWarning: return "1;35";
    case Severity::kError: return "1;31";
  }
  return "0";
}

/// Tabs and other control characters as one blank each, so that the caret stands below its character.
std::string printable(std::string_view line) {
  std::string shown(line);
  for (char& c : shown)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  return shown;
}

/// Display column of a byte column: continuation bytes of UTF-8 take no room.
std::size_t display_width(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
}

std::string snippet(const SourceManager& sources, const Span& span, const Paint& paint) {
  const LineColumn begin = sources.line_column(span.file, span.begin);
  const std::string_view whole = sources.line_text(span.file, begin.line);
  const auto column = static_cast<std::size_t>(begin.column - 1);
  if (column > kMaxShownColumns) return {};
  const std::string_view line = whole.substr(0, kMaxShownColumns);
  const std::size_t length = std::min<std::size_t>(span.end > span.begin ? span.end - span.begin : 1, std::max(line.size(), column + 1) - column);
  std::string mark(display_width(line.substr(0, column)), ' ');
  const std::size_t marked = column < line.size() ? std::max<std::size_t>(1, display_width(line.substr(column, length))) : 1;
  return fmt::format("    {}\n    {}{}\n", printable(line), mark, paint("1;32", "^" + std::string(marked - 1, '~')));
}

std::string include_stack(const SourceManager& sources, const Span& span) {
  std::string text;
  Span from = sources.file(span.file).included_from;
  for (const char* lead = "In file included from "; from.valid(); from = sources.file(from.file).included_from) {
    const Place place = sources.place(from);
    text += fmt::format("{}{}:{}:\n", lead, place.file, place.line);
    lead = "                 from ";
  }
  return text;
}

std::string message_line(const SourceManager& sources, Severity severity, const Span& span, std::string_view message, std::string_view code, const Paint& paint) {
  const std::string place = span.valid() ? place_of(sources, span) + ": " : std::string();
  const std::string suffix = code.empty() ? std::string() : fmt::format(" [{}]", code);
  return paint("1", place) + paint(severity_color(severity), fmt::format("{}: ", severity_name(severity))) + paint("1", message) + suffix + "\n";
}

/// The macros that the text came through, from the inside out.
std::string expansion_notes(const SourceManager& sources, const Span& span, const Paint& paint) {
  constexpr int kMaxNotes = 8;
  std::string text;
  int shown = 0;
  for (std::int32_t index = span.expansion; index >= 0 && shown < kMaxNotes; ++shown) {
    const Expansion& expansion = sources.expansion(index);
    text += message_line(sources, Severity::kNote, expansion.definition, fmt::format("in the expansion of macro '{}'", expansion.macro), "", paint);
    if (expansion.definition.valid()) text += snippet(sources, expansion.definition, paint);
    index = expansion.parent;
  }
  return text;
}

std::string fix_line(const SourceManager& sources, const FixIt& fix) {
  const std::string_view old_text = sources.text(fix.span);
  if (old_text.empty()) return fmt::format("    fix: insert `{}`\n", fix.replacement);
  if (fix.replacement.empty()) return fmt::format("    fix: remove `{}`\n", old_text);
  return fmt::format("    fix: write `{}`\n", fix.replacement);
}

nlohmann::json place_json(const SourceManager& sources, const Span& span) {
  if (!span.valid()) return nlohmann::json::object();
  const Place begin = sources.place(span);
  const LineColumn first = sources.line_column(span.file, span.begin);
  const LineColumn end = sources.line_column(span.file, span.end);
  return {{"file", begin.file}, {"line", begin.line}, {"column", begin.column}, {"end_line", begin.line + end.line - first.line}, {"end_column", end.column}};
}

nlohmann::json diagnostic_json(const SourceManager& sources, const Diagnostic& diagnostic) {
  nlohmann::json object = place_json(sources, diagnostic.span);
  object["severity"] = severity_name(diagnostic.severity);
  object["code"] = diagnostic.code;
  object["message"] = diagnostic.message;
  object["notes"] = nlohmann::json::array();
  for (const Note& note : diagnostic.notes) {
    nlohmann::json entry = place_json(sources, note.span);
    entry["message"] = note.message;
    object["notes"].push_back(std::move(entry));
  }
  if (diagnostic.fix) {
    object["fix"] = place_json(sources, diagnostic.fix->span);
    object["fix"]["replacement"] = diagnostic.fix->replacement;
  }
  return object;
}

}  // namespace

std::string place_of(const SourceManager& sources, const Span& span) {
  if (!span.valid()) return "<no source>";
  const Place at = sources.place(span);
  return fmt::format("{}:{}:{}", at.file, at.line, at.column);
}

std::string format_text(const SourceManager& sources, const Diagnostic& diagnostic, bool color) {
  const Paint paint{color};
  std::string text;
  if (diagnostic.span.valid()) text += include_stack(sources, diagnostic.span);
  text += message_line(sources, diagnostic.severity, diagnostic.span, diagnostic.message, diagnostic.code, paint);
  if (diagnostic.span.valid()) text += snippet(sources, diagnostic.span, paint);
  if (diagnostic.fix) text += fix_line(sources, *diagnostic.fix);
  text += expansion_notes(sources, diagnostic.span, paint);
  for (const Note& note : diagnostic.notes) {
    text += message_line(sources, Severity::kNote, note.span, note.message, "", paint);
    if (note.span.valid()) text += snippet(sources, note.span, paint);
  }
  return text;
}

std::string format_json(const SourceManager& sources, const std::vector<Diagnostic>& diagnostics) {
  nlohmann::json list = nlohmann::json::array();
  for (const Diagnostic& diagnostic : diagnostics) list.push_back(diagnostic_json(sources, diagnostic));
  const nlohmann::json document{{"diagnostics", std::move(list)}};
  return document.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace pmac::source
