// Diagnostics as JSON of our own, and as workflow commands of GitHub Actions.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "compiler/source/characters.h"
#include "compiler/source/format.h"

namespace pmac::source {
namespace {

using nlohmann::json;

json place_json(const SourceManager& sources, const Span& span) {
  if (!span.valid()) return json::object();
  const Place begin = sources.place(span);
  const LineColumn first = sources.line_column(span.file, span.begin);
  const LineColumn end = sources.line_column(span.file, span.end);
  return {{"file", to_utf8(begin.file)}, {"line", begin.line}, {"column", begin.column}, {"end_line", begin.line + end.line - first.line}, {"end_column", end.column}};
}

json edit_json(const SourceManager& sources, const Span& span, const std::string& replacement) {
  json edit = place_json(sources, span);
  edit["replacement"] = to_utf8(replacement);
  return edit;
}

json fix_json(const SourceManager& sources, const FixIt& fix) {
  json object = edit_json(sources, fix.span, fix.replacement);
  object["safe"] = fix.safety == FixSafety::kSafe;
  if (!fix.also.empty()) object["also"] = json::array();
  for (const Edit& edit : fix.also) object["also"].push_back(edit_json(sources, edit.span, edit.replacement));
  return object;
}

/// Files that lead to a place by #include, nearest first.
json include_json(const SourceManager& sources, const Span& span) {
  json list = json::array();
  for (Span from = sources.file(span.file).included_from; from.valid(); from = sources.file(from.file).included_from) list.push_back(place_json(sources, from));
  return list;
}

json expansion_json(const SourceManager& sources, const Span& span) {
  json list = json::array();
  for (std::int32_t index = span.expansion; index >= 0; index = sources.expansion(index).parent) {
    json entry = place_json(sources, sources.expansion(index).definition);
    entry["macro"] = sources.expansion(index).macro;
    list.push_back(std::move(entry));
  }
  return list;
}

json diagnostic_json(const SourceManager& sources, const Diagnostic& diagnostic) {
  json object = place_json(sources, diagnostic.span);
  object["severity"] = severity_name(diagnostic.severity);
  object["code"] = diagnostic.code;
  if (!diagnostic.group.empty()) object["group"] = diagnostic.group;
  object["message"] = to_utf8(diagnostic.message);
  object["notes"] = json::array();
  for (const Note& note : diagnostic.notes) {
    json entry = place_json(sources, note.span);
    entry["message"] = to_utf8(note.message);
    object["notes"].push_back(std::move(entry));
  }
  if (diagnostic.fix) object["fix"] = fix_json(sources, *diagnostic.fix);
  if (!diagnostic.span.valid()) return object;
  if (json stack = include_json(sources, diagnostic.span); !stack.empty()) object["included_from"] = std::move(stack);
  if (json macros = expansion_json(sources, diagnostic.span); !macros.empty()) object["expansion"] = std::move(macros);
  return object;
}

/// Text of a workflow command: line ends and % are escaped; in a property also , and :.
std::string escaped(std::string_view text, bool property) {
  std::string result;
  for (const char c : to_utf8(text)) {
    if (c == '%') result += "%25";
    else if (c == '\r') result += "%0D";
    else if (c == '\n') result += "%0A";
    else if (property && c == ':') result += "%3A";
    else if (property && c == ',') result += "%2C";
    else result += c;
  }
  return result;
}

std::string github_place(const SourceManager& sources, const Span& span) {
  if (!span.valid()) return {};
  const Place begin = sources.place(span);
  const LineColumn first = sources.line_column(span.file, span.begin);
  const LineColumn end = sources.line_column(span.file, span.end);
  std::string place = fmt::format("file={},line={},col={}", escaped(begin.file, true), begin.line, begin.column);
  // columns of a range are known to the service only where it stays on one line
  if (end.line > first.line) place += fmt::format(",endLine={}", begin.line + end.line - first.line);
  else place += fmt::format(",endColumn={}", std::max(end.column, begin.column));
  return place + ",";
}

std::string github_line(const SourceManager& sources, const Diagnostic& diagnostic) {
  std::string message = diagnostic.message;
  for (const Note& note : diagnostic.notes) message += fmt::format("\nnote: {}{}", note.span.valid() ? place_of(sources, note.span) + ": " : std::string(), note.message);
  const std::string title = diagnostic.group.empty() ? diagnostic.code : fmt::format("{} -W{}", diagnostic.code, diagnostic.group);
  const std::string_view command = diagnostic.severity == Severity::kNote ? "notice" : severity_name(diagnostic.severity);
  return fmt::format("::{} {}title={}::{}\n", command, github_place(sources, diagnostic.span), escaped(title, true), escaped(message, false));
}

}  // namespace

std::string format_json(const SourceManager& sources, const std::vector<Diagnostic>& diagnostics) {
  json list = json::array();
  for (const Diagnostic& diagnostic : diagnostics) list.push_back(diagnostic_json(sources, diagnostic));
  return json{{"diagnostics", std::move(list)}}.dump(2) + "\n";
}

std::string format_github(const SourceManager& sources, const std::vector<Diagnostic>& diagnostics) {
  std::string text;
  for (const Diagnostic& diagnostic : diagnostics) text += github_line(sources, diagnostic);
  return text;
}

}  // namespace pmac::source
