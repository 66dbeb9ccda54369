#include "compiler/source/fix.h"

#include <fmt/format.h>

#include <algorithm>

namespace pmac::source {
namespace {

bool same_edit(const Edit& a, const Edit& b) { return a.span.begin == b.span.begin && a.span.end == b.span.end && a.replacement == b.replacement; }

/// Two insertions at one place have no certain order; an insertion at the edge of a replaced text has.
bool overlap(const Edit& a, const Edit& b) {
  const bool a_inserts = a.span.begin == a.span.end, b_inserts = b.span.begin == b.span.end;
  if (a_inserts && b_inserts) return a.span.begin == b.span.begin;
  return a.span.begin < b.span.end && b.span.begin < a.span.end;
}

class Planner {
 public:
  Planner(const SourceManager& sources, const std::function<bool(const std::string&)>& may_change) : sources_(sources), may_change_(may_change) {}

  void take(const Diagnostic& diagnostic) {
    if (!diagnostic.fix || diagnostic.fix->safety != FixSafety::kSafe) return;
    std::vector<Edit> edits{{diagnostic.fix->span, diagnostic.fix->replacement}};
    edits.insert(edits.end(), diagnostic.fix->also.begin(), diagnostic.fix->also.end());
    if (!std::all_of(edits.begin(), edits.end(), [&](const Edit& edit) { return can_change(edit.span); })) return;
    if (!std::all_of(edits.begin(), edits.end(), [&](const Edit& edit) { return fits(edit); })) return plan_.conflicting.push_back(&diagnostic);
    for (Edit& edit : edits) add(std::move(edit));
    plan_.applied.push_back(&diagnostic);
  }

  FixPlan finish() {
    for (auto& [name, file] : plan_.files)
      std::sort(file.edits.begin(), file.edits.end(), [](const Edit& a, const Edit& b) { return std::pair(a.span.begin, a.span.end) < std::pair(b.span.begin, b.span.end); });
    return std::move(plan_);
  }

 private:
  bool can_change(const Span& span) const { return span.valid() && span.expansion < 0 && span.begin <= span.end && span.end <= sources_.file(span.file).text.size() && may_change_(sources_.file(span.file).name); }

  bool fits(const Edit& edit) const {
    const auto file = plan_.files.find(sources_.file(edit.span.file).name);
    if (file == plan_.files.end()) return true;
    return std::none_of(file->second.edits.begin(), file->second.edits.end(), [&](const Edit& other) { return overlap(edit, other) && !same_edit(edit, other); });
  }

  void add(Edit edit) {
    const File& source = sources_.file(edit.span.file);
    FixPlan::FileEdits& file = plan_.files.try_emplace(source.name, FixPlan::FileEdits{source.text, {}}).first->second;
    const bool known = std::any_of(file.edits.begin(), file.edits.end(), [&](const Edit& other) { return same_edit(edit, other); });
    if (!known) file.edits.push_back(std::move(edit));
  }

  const SourceManager& sources_;
  const std::function<bool(const std::string&)>& may_change_;
  FixPlan plan_;
};

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size() - 1);
    lines.push_back(text.substr(at, end + 1 - at));
    at = end + 1;
  }
  return lines;
}

void append_line(std::string& out, char mark, std::string_view line) {
  out += mark;
  out += line;
  if (!line.ends_with('\n')) out += "\n\\ No newline at end of file\n";
}

/// A run of old lines [first, last) that edits touch, and the lines that come instead.
struct Change { std::size_t first, last; std::string new_text; };

std::size_t line_at(std::string_view text, std::size_t offset) { return static_cast<std::size_t>(std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(std::min(offset, text.size())), '\n')); }

std::vector<Change> changes_of(const FixPlan::FileEdits& file) {
  const auto lines = lines_of(file.old_text);
  std::vector<Change> changes;
  for (std::size_t i = 0; i < file.edits.size();) {
    std::size_t first = line_at(file.old_text, file.edits[i].span.begin), last = line_at(file.old_text, file.edits[i].span.end) + 1;
    FixPlan::FileEdits part;
    std::size_t next = i;
    for (; next < file.edits.size() && line_at(file.old_text, file.edits[next].span.begin) < last; ++next) last = std::max(last, line_at(file.old_text, file.edits[next].span.end) + 1);
    last = std::min(last, lines.size());
    const auto begin = first < lines.size() ? static_cast<std::size_t>(lines[first].data() - file.old_text.data()) : file.old_text.size();
    const auto end = last < lines.size() ? static_cast<std::size_t>(lines[last].data() - file.old_text.data()) : file.old_text.size();
    part.old_text = file.old_text.substr(begin, end - begin);
    for (; i < next; ++i) {
      Edit edit = file.edits[i];
      edit.span.begin -= static_cast<std::uint32_t>(begin);
      edit.span.end -= static_cast<std::uint32_t>(begin);
      part.edits.push_back(std::move(edit));
    }
    changes.push_back({first, last, apply_edits(part)});
  }
  return changes;
}

}  // namespace

FixPlan plan_fixes(const SourceManager& sources, const std::vector<Diagnostic>& diagnostics, const std::function<bool(const std::string&)>& may_change) {
  Planner planner(sources, may_change);
  for (const Diagnostic& diagnostic : diagnostics) planner.take(diagnostic);
  return planner.finish();
}

std::string apply_edits(const FixPlan::FileEdits& file) {
  std::string text;
  std::size_t at = 0;
  for (const Edit& edit : file.edits) {
    text.append(file.old_text, at, edit.span.begin - at);
    text += edit.replacement;
    at = edit.span.end;
  }
  return text.append(file.old_text, at);
}

std::string unified_diff(const std::string& name, const FixPlan::FileEdits& file) {
  constexpr std::size_t kContext = 3;
  const auto lines = lines_of(file.old_text);
  const auto changes = changes_of(file);
  std::string out = fmt::format("--- {}\n+++ {}\n", name, name);
  std::ptrdiff_t shift = 0;  // new line number minus old one
  for (std::size_t i = 0; i < changes.size();) {
    std::size_t end = i + 1;
    while (end < changes.size() && changes[end].first <= changes[end - 1].last + 2 * kContext) ++end;
    const std::size_t from = changes[i].first > kContext ? changes[i].first - kContext : 0;
    const std::size_t to = std::min(changes[end - 1].last + kContext, lines.size());
    std::string body;
    std::size_t at = from, added = 0, removed = 0;
    for (; i < end; ++i) {
      for (; at < changes[i].first; ++at) append_line(body, ' ', lines[at]);
      for (; at < changes[i].last; ++at, ++removed) append_line(body, '-', lines[at]);
      for (const std::string_view line : lines_of(changes[i].new_text)) append_line(body, '+', line), ++added;
    }
    for (; at < to; ++at) append_line(body, ' ', lines[at]);
    const auto new_from = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(from) + shift);
    out += fmt::format("@@ -{},{} +{},{} @@\n{}", from + 1, to - from, new_from + 1, to - from - removed + added, body);
    shift += static_cast<std::ptrdiff_t>(added) - static_cast<std::ptrdiff_t>(removed);
  }
  return out;
}

}  // namespace pmac::source
