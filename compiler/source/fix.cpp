#include "compiler/source/fix.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <tuple>

namespace pmac::source {
namespace {

struct ByPlace {
  bool operator()(const Edit& a, const Edit& b) const { return std::tie(a.span.begin, a.span.end, a.replacement) < std::tie(b.span.begin, b.span.end, b.replacement); }
};
using EditSet = std::set<Edit, ByPlace>;

bool same_edit(const Edit& a, const Edit& b) { return !ByPlace()(a, b) && !ByPlace()(b, a); }

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
    for (auto& [name, taken] : taken_) {
      std::vector<Edit>& edits = plan_.files[name].edits;
      while (!taken.empty()) edits.push_back(std::move(taken.extract(taken.begin()).value()));
    }
    return std::move(plan_);
  }

 private:
  bool can_change(const Span& span) const { return span.valid() && span.expansion < 0 && span.begin <= span.end && span.end <= sources_.file(span.file).text.size() && may_change_(sources_.file(span.file).name); }

  /// Those taken do not overlap, so only its neighbours can be in the way: of those that begin before it, a replacement and perhaps
  /// an insertion at the same place.
  bool fits(const Edit& edit) const {
    const auto file = taken_.find(sources_.file(edit.span.file).name);
    if (file == taken_.end()) return true;
    const EditSet& taken = file->second;
    auto other = taken.lower_bound(Edit{edit.span, {}});
    for (int i = 0; i < 2 && other != taken.begin(); ++i) --other;
    for (; other != taken.end() && other->span.begin <= edit.span.end; ++other)
      if (overlap(edit, *other) && !same_edit(edit, *other)) return false;
    return true;
  }

  void add(Edit edit) {
    const File& source = sources_.file(edit.span.file);
    plan_.files.try_emplace(source.name, FixPlan::FileEdits{source.text, {}});
    taken_[source.name].insert(std::move(edit));
  }

  const SourceManager& sources_;
  const std::function<bool(const std::string&)>& may_change_;
  FixPlan plan_;
  std::map<std::string, EditSet> taken_;  // by file, in order of place
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

/// Finds the line of an offset, counted from 0.
class LineFinder {
 public:
  explicit LineFinder(std::string_view text) {
    for (std::size_t at = text.find('\n'); at != std::string_view::npos; at = text.find('\n', at + 1)) ends_.push_back(at);
  }
  std::size_t line_at(std::size_t offset) const { return static_cast<std::size_t>(std::lower_bound(ends_.begin(), ends_.end(), offset) - ends_.begin()); }

 private:
  std::vector<std::size_t> ends_;
};

std::vector<Change> changes_of(const FixPlan::FileEdits& file) {
  const auto lines = lines_of(file.old_text);
  const LineFinder finder(file.old_text);
  std::vector<Change> changes;
  for (std::size_t i = 0; i < file.edits.size();) {
    std::size_t first = finder.line_at(file.edits[i].span.begin), last = finder.line_at(file.edits[i].span.end) + 1;
    FixPlan::FileEdits part;
    std::size_t next = i;
    for (; next < file.edits.size() && finder.line_at(file.edits[next].span.begin) < last; ++next) last = std::max(last, finder.line_at(file.edits[next].span.end) + 1);
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
