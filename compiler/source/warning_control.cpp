#include "compiler/source/warning_control.h"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

#include "compiler/source/suppression.h"

namespace pmac::source {
namespace {

constexpr int kWholeFile = 0;  // in place of a line

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

/// Comments of equal groups that count for equal lines stand together; the first of them says for all whether they are used.
bool WarningControl::is_suppressed(std::string_view group, const Span& span) {
  if (!span.valid()) return false;
  std::vector<Suppression>& comments = suppressions_of(span.file);
  bool found = false;
  for (const int line : {kWholeFile, sources_.line_column(span.file, span.begin).line}) {
    const auto first = std::lower_bound(comments.begin(), comments.end(), std::pair(group, line), [](const Suppression& a, const auto& wanted) { return std::pair(std::string_view(a.group), a.line) < wanted; });
    if (first != comments.end() && first->group == group && first->line == line) found = first->used = true;
  }
  return found;
}

/// Sorted by group and line.
std::vector<WarningControl::Suppression>& WarningControl::suppressions_of(std::int32_t file) {
  const auto [entry, fresh] = suppressions_.try_emplace(file);
  if (!fresh) return entry->second;
  for (SuppressionComment& comment : read_suppressions(sources_, file))
    entry->second.push_back({std::move(comment.group), comment.span, comment.whole_file ? kWholeFile : comment.line, comment.whole_file, false});
  std::stable_sort(entry->second.begin(), entry->second.end(), [](const Suppression& a, const Suppression& b) { return std::tie(a.group, a.line) < std::tie(b.group, b.line); });
  return entry->second;
}

void WarningControl::report_comments(std::int32_t first_file, bool all_stages_ran, Diagnostics& diagnostics) {
  for (auto file = first_file; file < static_cast<std::int32_t>(sources_.file_count()); ++file) {
    std::vector<Suppression> comments = suppressions_of(file);  // a copy: reporting looks comments up
    for (std::size_t i = 1; i < comments.size(); ++i)
      if (comments[i].group == comments[i - 1].group && comments[i].line == comments[i - 1].line) comments[i].used = comments[i - 1].used;
    std::sort(comments.begin(), comments.end(), [](const Suppression& a, const Suppression& b) { return a.span.begin < b.span.begin; });
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
