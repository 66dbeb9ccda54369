// Diagnostics as a SARIF 2.1.0 log (OASIS Static Analysis Results Interchange Format), which code scanning services and editors read.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "compiler/source/characters.h"
#include "compiler/source/format.h"
#include "compiler/source/message.h"

namespace pmac::source {
namespace {

using nlohmann::ordered_json;

/// A path as a URI reference: relative where it is relative, else file:///...
std::string uri_of(std::string_view path) {
  constexpr std::string_view kPlain = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-._~/";
  std::string uri = path.starts_with('/') ? "file://" : "";
  for (const char c : to_utf8(path)) {
    if (c == '\\') uri += '/';
    else if (kPlain.find(c) != std::string_view::npos) uri += c;
    else uri += fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return uri;
}

/// Column from 1 in UTF-16 code units of a byte column from 1.
std::size_t utf16_column(const SourceManager& sources, std::int32_t file, const LineColumn& at) {
  const std::string_view line = sources.line_text(file, at.line);
  const auto bytes = std::min(static_cast<std::size_t>(at.column - 1), line.size());
  return utf16_length(line.substr(0, bytes)) + 1;
}

ordered_json region_json(const SourceManager& sources, const Span& span) {
  const LineColumn begin = sources.line_column(span.file, span.begin);
  const LineColumn end = sources.line_column(span.file, std::max(span.begin, span.end));
  return {{"startLine", begin.line}, {"startColumn", utf16_column(sources, span.file, begin)}, {"endLine", end.line}, {"endColumn", utf16_column(sources, span.file, end)}};
}

ordered_json artifact_json(const SourceManager& sources, std::int32_t file) { return {{"uri", uri_of(sources.file(file).name)}}; }

ordered_json location_json(const SourceManager& sources, const Span& span) {
  ordered_json place;
  place["artifactLocation"] = artifact_json(sources, span.file);
  place["region"] = region_json(sources, span);
  return {{"physicalLocation", std::move(place)}};
}

/// Places of notes, of the macros whose text is meant, and of the #include lines on the way.
ordered_json related_json(const SourceManager& sources, const Diagnostic& diagnostic) {
  ordered_json list = ordered_json::array();
  const auto add = [&](const Span& span, std::string_view text) {
    if (!span.valid()) return;
    ordered_json location = location_json(sources, span);
    location["id"] = list.size();
    location["message"]["text"] = to_utf8(text);
    list.push_back(std::move(location));
  };
  for (const Note& note : diagnostic.notes) add(note.span, note.message);
  for (std::int32_t index = diagnostic.span.expansion; index >= 0; index = sources.expansion(index).parent)
    add(sources.expansion(index).definition, fmt::format("in the expansion of macro '{}'", sources.expansion(index).macro));
  if (diagnostic.span.valid())
    for (Span from = sources.file(diagnostic.span.file).included_from; from.valid(); from = sources.file(from.file).included_from) add(from, "included from here");
  return list;
}

std::vector<Edit> edits_of(const FixIt& fix) {
  std::vector<Edit> edits{{fix.span, fix.replacement}};
  edits.insert(edits.end(), fix.also.begin(), fix.also.end());
  return edits;
}

/// One change for each file, or null where an edit lies in the text of a macro.
ordered_json fix_json(const SourceManager& sources, const FixIt& fix) {
  std::map<std::int32_t, ordered_json> replacements;
  for (const Edit& edit : edits_of(fix)) {
    if (!edit.span.valid() || edit.span.expansion >= 0) return nullptr;
    ordered_json replacement;
    replacement["deletedRegion"] = region_json(sources, edit.span);
    replacement["insertedContent"]["text"] = to_utf8(edit.replacement);
    replacements[edit.span.file].push_back(std::move(replacement));
  }
  ordered_json changes = ordered_json::array();
  for (auto& [file, list] : replacements) changes.push_back({{"artifactLocation", artifact_json(sources, file)}, {"replacements", std::move(list)}});
  ordered_json object;
  object["description"]["text"] = fix.safety == FixSafety::kSafe ? "repair" : "suggestion: look at it before it is applied";
  object["artifactChanges"] = std::move(changes);
  return object;
}

ordered_json result_json(const SourceManager& sources, const Diagnostic& diagnostic, std::size_t rule) {
  ordered_json result;
  result["ruleId"] = diagnostic.code;
  result["ruleIndex"] = rule;
  result["level"] = severity_name(diagnostic.severity);
  result["message"]["text"] = to_utf8(diagnostic.message);
  if (diagnostic.span.valid()) result["locations"].push_back(location_json(sources, diagnostic.span));
  if (ordered_json related = related_json(sources, diagnostic); !related.empty()) result["relatedLocations"] = std::move(related);
  if (!diagnostic.fix) return result;
  if (ordered_json fix = fix_json(sources, *diagnostic.fix); !fix.is_null()) result["fixes"].push_back(std::move(fix));
  return result;
}

ordered_json rule_json(const std::string& code) {
  ordered_json rule{{"id", code}};
  const MessageInfo* row = find_message(code);
  if (!row) return rule;
  if (!row->group.empty()) rule["name"] = row->group;
  rule["shortDescription"]["text"] = row->title;
  rule["fullDescription"]["text"] = row->explanation;
  rule["help"]["text"] = explain(code);
  rule["defaultConfiguration"] = {{"enabled", row->level == MessageLevel::kError || row->level == MessageLevel::kDefault}, {"level", row->level == MessageLevel::kError ? "error" : "warning"}};
  return rule;
}

}  // namespace

std::string format_sarif(const SourceManager& sources, const std::vector<Diagnostic>& diagnostics) {
  std::map<std::string, std::size_t> rule_of;
  ordered_json rules = ordered_json::array();
  ordered_json results = ordered_json::array();
  for (const Diagnostic& diagnostic : diagnostics) {
    const auto [rule, fresh] = rule_of.try_emplace(diagnostic.code, rules.size());
    if (fresh) rules.push_back(rule_json(diagnostic.code));
    results.push_back(result_json(sources, diagnostic, rule->second));
  }
  ordered_json run;
  run["tool"]["driver"] = {{"name", "pmacc"}, {"version", "0.1.0"}, {"rules", std::move(rules)}};
  run["columnKind"] = "utf16CodeUnits";
  run["results"] = std::move(results);
  ordered_json log;
  log["$schema"] = "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json";
  log["version"] = "2.1.0";
  log["runs"].push_back(std::move(run));
  return log.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace pmac::source
