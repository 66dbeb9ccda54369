#include "compiler/source/warning_control.h"

#include <fmt/format.h>

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

/// The part of a line before the `//` that the mark follows, or nullopt where the mark is no comment of its own.
std::optional<std::string_view> code_before_mark(std::string_view line, std::size_t mark) {
  const std::string_view before = trim(line.substr(0, mark));
  if (!before.ends_with("//")) return std::nullopt;
  const std::string_view code = trim(before.substr(0, before.size() - 2));
  const bool in_text = std::count(code.begin(), code.end(), '"') % 2 != 0;
  return in_text ? std::nullopt : std::optional(code);
}

/// The first word of a part of text.
Span span_of_word(std::int32_t file, std::string_view text, std::string_view part) {
  const auto begin = static_cast<std::uint32_t>(part.data() - text.data());
  const std::size_t length = std::min(part.find_first_of(" (\t"), part.size());
  return {file, begin, begin + static_cast<std::uint32_t>(length), -1};
}

bool is_comment_line(std::string_view line) { return trim(line).starts_with("//"); }

}  // namespace

std::string WarningOptions::apply(std::string_view option) {
  const bool off = option.starts_with("no-") && !is_warning_group(option);  // no-coord is the name of a group
  std::string_view name = off ? option.substr(3) : option;
  if (name == "all" || name == "extra") {
    (name == "all" ? all_ : extra_) = !off;
    return {};
  }
  if (name == "error") {
    all_are_errors_ = !off;
    if (off) errors_.clear();
    return {};
  }
  const bool as_error = name.starts_with("error=");
  if (as_error) name.remove_prefix(6);
  if (!is_warning_group(name)) {
    const std::string_view near = nearest_word(name, warning_groups());
    return fmt::format("unknown warning option -W{}{}", option, near.empty() ? std::string() : fmt::format("; did you mean -W{}{}{}?", off ? "no-" : "", as_error ? "error=" : "", near));
  }
  if (as_error) errors_[std::string(name)] = !off;
  if (!as_error || !off) on_[std::string(name)] = !off;
  return {};
}

bool WarningOptions::is_on(const MessageInfo& row) const {
  if (silent_) return false;
  if (const auto named = on_.find(row.group); named != on_.end()) return named->second;
  switch (row.level) {
    case MessageLevel::kAll: return all_ || extra_;
    case MessageLevel::kExtra: return extra_;
    default: return true;
  }
}

bool WarningOptions::is_error(const MessageInfo& row) const {
  const auto named = errors_.find(row.group);
  return named != errors_.end() ? named->second : all_are_errors_;
}

bool WarningControl::accept(Diagnostic& diagnostic) {
  if (diagnostic.severity != Severity::kWarning) return true;
  const MessageInfo* row = find_message(diagnostic.code);
  if (!row || row->group.empty()) return true;
  diagnostic.group = row->group;
  if (!options_.is_on(*row) || is_suppressed(row->group, diagnostic.span)) return false;
  if (options_.is_error(*row)) diagnostic.severity = Severity::kError;
  return true;
}

bool WarningControl::is_suppressed(std::string_view group, const Span& span) {
  if (!span.valid()) return false;
  const int line = sources_.line_column(span.file, span.begin).line;
  bool suppressed = false;
  for (Suppression& comment : suppressions_of(span.file)) {
    if (comment.group != group || (!comment.whole_file && comment.line != line)) continue;
    suppressed = comment.used = true;
  }
  return suppressed;
}

std::vector<WarningControl::Suppression>& WarningControl::suppressions_of(std::int32_t file) {
  const auto [entry, fresh] = suppressions_.try_emplace(file);
  if (!fresh) return entry->second;
  const std::string_view text = sources_.file(file).text;
  const int lines = static_cast<int>(sources_.file(file).line_starts.size());
  for (std::size_t at = text.find(kMark); at != std::string_view::npos; at = text.find(kMark, at + 1)) {
    const LineColumn place = sources_.line_column(file, static_cast<std::uint32_t>(at));
    const std::string_view line = sources_.line_text(file, place.line);
    const auto code = code_before_mark(line, static_cast<std::size_t>(place.column - 1));
    if (!code) continue;
    const std::string_view command = trim(line.substr(static_cast<std::size_t>(place.column - 1) + kMark.size()));
    const bool whole_file = command.starts_with("ignore-file(");
    const std::size_t open = command.find('('), close = command.find(')');
    if ((!whole_file && !command.starts_with("ignore(")) || close == std::string_view::npos) {
      if (!command.starts_with("fmt ")) entry->second.push_back({{}, span_of_word(file, text, command), place.line, false, false});
      continue;
    }
    int target = place.line;
    if (code->empty())
      for (++target; target < lines && is_comment_line(sources_.line_text(file, target));) ++target;
    const std::size_t list = static_cast<std::size_t>(command.data() - text.data()) + open + 1;
    for (std::size_t begin = 0, end = 0; begin <= close - open - 1; begin = end + 1) {
      const std::string_view names = command.substr(open + 1, close - open - 1);
      end = std::min(names.find(',', begin), names.size());
      const std::string_view name = trim(names.substr(begin, end - begin));
      const auto offset = static_cast<std::uint32_t>(list + (name.empty() ? 0 : static_cast<std::size_t>(name.data() - names.data())));
      entry->second.push_back({std::string(name), {file, offset, offset + static_cast<std::uint32_t>(name.size()), -1}, target, whole_file, false});
    }
  }
  return entry->second;
}

void WarningControl::report_comments(std::int32_t first_file, bool all_stages_ran, Diagnostics& diagnostics) {
  for (auto file = first_file; file < static_cast<std::int32_t>(sources_.file_count()); ++file) {
    const std::vector<Suppression> comments = suppressions_of(file);  // a copy: reporting looks comments up
    for (const Suppression& comment : comments) {
      if (comment.group.empty()) {
        diagnostics.warning("PM7020", comment.span, "this is no comment for pmacc; there are ignore(name), ignore-file(name), fmt off and fmt on");
      } else if (!is_warning_group(comment.group)) {
        const std::string_view near = nearest_word(comment.group, warning_groups());
        auto& warning = diagnostics.warning("PM7020", comment.span, fmt::format("no warning has the name '{}'{}", comment.group, near.empty() ? std::string() : fmt::format("; did you mean '{}'?", near)));
        if (!near.empty()) warning.fix = FixIt{comment.span, std::string(near), FixSafety::kSuggestion};
      } else if (all_stages_ran && !comment.used) {
        diagnostics.warning("PM7021", comment.span, fmt::format("no warning '{}' is given here", comment.group));
      }
    }
  }
}

}  // namespace pmac::source
