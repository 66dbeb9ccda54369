#include "compiler/source/format.h"

#include <fmt/format.h>

#include <algorithm>

#include "compiler/source/characters.h"
#include "compiler/source/snippet.h"

namespace pmac::source {
namespace {

struct Paint {
  bool on;
  std::string operator()(std::string_view code, std::string_view text) const {
    return on && !text.empty() ? fmt::format("\x1b[{}m{}\x1b[0m", code, text) : std::string(text);
  }
};

std::string_view severity_color(Severity severity) {
  switch (severity) {
    case Severity::kNote: return "1;36";
    case Severity::kWarning: return "1;35";
    case Severity::kError: return "1;31";
  }
  return "0";
}

std::string marked_lines(const SourceManager& sources, const Span& span, const Paint& paint) {
  return span.valid() ? snippet(sources, span, [&](std::string_view mark) { return paint("1;32", mark); }) : std::string();
}

std::string include_stack(const SourceManager& sources, const Span& span) {
  std::string text;
  if (!span.valid()) return text;
  Span from = sources.file(span.file).included_from;
  for (const char* lead = "In file included from "; from.valid(); from = sources.file(from.file).included_from) {
    const Place place = sources.place(from);
    text += fmt::format("{}{}:{}:\n", lead, place.file, place.line);
    lead = "                 from ";
  }
  return text;
}

std::string message_line(const SourceManager& sources, Severity severity, const Span& span, std::string_view message, const std::string& suffix, const Paint& paint) {
  const std::string place = span.valid() ? place_of(sources, span) + ": " : std::string();
  return paint("1", place) + paint(severity_color(severity), fmt::format("{}: ", severity_name(severity))) + paint("1", to_utf8(message)) + suffix + "\n";
}

/// [PM6003] [-Wunserved-axis]
std::string suffix_of(const Diagnostic& diagnostic) {
  std::string suffix;
  if (!diagnostic.code.empty()) suffix += fmt::format(" [{}]", diagnostic.code);
  if (!diagnostic.group.empty()) suffix += fmt::format(" [-W{}{}]", diagnostic.severity == Severity::kError ? "error=" : "", diagnostic.group);
  return suffix;
}

/// The macros that the text came through, from the inside out.
std::string expansion_notes(const SourceManager& sources, const Span& span, const Paint& paint) {
  constexpr int kMaxNotes = 8;
  std::string text;
  int shown = 0;
  for (std::int32_t index = span.expansion; index >= 0 && shown < kMaxNotes; index = sources.expansion(index).parent, ++shown) {
    const Expansion& expansion = sources.expansion(index);
    text += message_line(sources, Severity::kNote, expansion.definition, fmt::format("in the expansion of macro '{}'", expansion.macro), "", paint);
    text += marked_lines(sources, expansion.definition, paint);
  }
  return text;
}

std::string edit_text(const SourceManager& sources, const Span& span, std::string_view replacement) {
  const std::string_view old_text = sources.text(span);
  if (old_text.empty()) return fmt::format("insert `{}`", replacement);
  return replacement.empty() ? fmt::format("remove `{}`", old_text) : fmt::format("write `{}`", replacement);
}

std::string fix_line(const SourceManager& sources, const FixIt& fix) {
  std::string text = to_utf8(edit_text(sources, fix.span, fix.replacement));
  for (const Edit& edit : fix.also)
    if (edit.span.valid()) text += fmt::format(", {} in line {}", to_utf8(edit_text(sources, edit.span, edit.replacement)), sources.line_column(edit.span.file, edit.span.begin).line);
  return fmt::format("    {}: {}\n", fix.safety == FixSafety::kSafe ? "fix" : "suggestion", text);
}

}  // namespace

std::string_view severity_name(Severity severity) {
  switch (severity) {
    case Severity::kNote: return "note";
    case Severity::kWarning: return "warning";
    case Severity::kError: return "error";
  }
  return "";
}

std::string place_of(const SourceManager& sources, const Span& span) {
  if (!span.valid()) return "<no source>";
  const Place at = sources.place(span);
  return fmt::format("{}:{}:{}", at.file, at.line, at.column);
}

std::string format_text(const SourceManager& sources, const Diagnostic& diagnostic, bool color) {
  const Paint paint{color};
  std::string text = include_stack(sources, diagnostic.span);
  text += message_line(sources, diagnostic.severity, diagnostic.span, diagnostic.message, suffix_of(diagnostic), paint);
  text += marked_lines(sources, diagnostic.span, paint);
  if (diagnostic.fix) text += fix_line(sources, *diagnostic.fix);
  text += expansion_notes(sources, diagnostic.span, paint);
  for (const Note& note : diagnostic.notes) {
    text += message_line(sources, Severity::kNote, note.span, note.message, "", paint);
    text += marked_lines(sources, note.span, paint);
  }
  return text;
}

}  // namespace pmac::source
