// The change as a unified diff. The formatter keeps every line in its place and only leaves blank lines out, so no search for the
// shortest change is needed: the lines of both texts are paired from the front.
#include <fmt/format.h>

#include <algorithm>

#include "compiler/style/source_text.h"
#include "compiler/style/style.h"

namespace pmac::style {
namespace {

constexpr std::size_t kContext = 3;  // unchanged lines around a change

using Lines = std::vector<std::string_view>;

/// Lines with their line ends.
Lines lines_of(std::string_view text) {
  Lines lines;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size() - 1) + 1;
    lines.push_back(text.substr(at, end - at));
    at = end;
  }
  return lines;
}

bool is_empty(std::string_view line) {
  return std::all_of(line.begin(), line.end(), [](char c) { return is_blank(c) || c == '\n'; });
}

/// A line of the old text and what became of it.
struct Pair { std::size_t before, after; bool deleted; bool changed; };

std::vector<Pair> pair_lines(const Lines& before, const Lines& after) {
  std::vector<Pair> pairs;
  std::size_t j = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const bool deleted = j == after.size() || (is_empty(before[i]) && !is_empty(after[j]));
    pairs.push_back({i, j, deleted, deleted || before[i] != after[j]});
    if (!deleted) ++j;
  }
  return pairs;
}

void append_line(std::string& out, char mark, std::string_view line) {
  out += mark;
  out += line;
  if (!line.ends_with('\n')) out += "\n\\ No newline at end of file\n";
}

/// Changed lines in a row: the old ones first, then the new ones.
void append_changes(std::string& out, const std::vector<Pair>& pairs, std::size_t first, std::size_t last, const Lines& before, const Lines& after) {
  for (std::size_t i = first; i < last; ++i) append_line(out, '-', before[pairs[i].before]);
  for (std::size_t i = first; i < last; ++i)
    if (!pairs[i].deleted) append_line(out, '+', after[pairs[i].after]);
}

void append_hunk(std::string& out, const std::vector<Pair>& pairs, std::size_t first, std::size_t last, const Lines& before, const Lines& after) {
  const auto kept = std::count_if(pairs.begin() + static_cast<std::ptrdiff_t>(first), pairs.begin() + static_cast<std::ptrdiff_t>(last), [](const Pair& pair) { return !pair.deleted; });
  const std::size_t new_begin = pairs[first].after + (kept > 0 ? 1 : 0);
  out += fmt::format("@@ -{},{} +{},{} @@\n", pairs[first].before + 1, last - first, new_begin, kept);
  for (std::size_t i = first; i < last;) {
    if (!pairs[i].changed) {
      append_line(out, ' ', before[pairs[i++].before]);
      continue;
    }
    std::size_t end = i;
    while (end < last && pairs[end].changed) ++end;
    append_changes(out, pairs, i, end, before, after);
    i = end;
  }
}

/// Index behind the last change whose context touches the one before it.
std::size_t end_of_hunk(const std::vector<Pair>& pairs, std::size_t first_change) {
  std::size_t last_change = first_change;
  for (std::size_t i = first_change + 1; i < pairs.size() && i <= last_change + 2 * kContext + 1; ++i)
    if (pairs[i].changed) last_change = i;
  return last_change + 1;
}

}  // namespace

std::string unified_diff(const std::string& file_name, std::string_view before, std::string_view after) {
  if (before == after) return {};
  const Lines old_lines = lines_of(before), new_lines = lines_of(after);
  const std::vector<Pair> pairs = pair_lines(old_lines, new_lines);
  std::string out = fmt::format("--- {0}\n+++ {0}\n", file_name);
  for (std::size_t i = 0; i < pairs.size();) {
    if (!pairs[i].changed) {
      ++i;
      continue;
    }
    const std::size_t end = end_of_hunk(pairs, i);
    append_hunk(out, pairs, i - std::min(i, kContext), std::min(end + kContext, pairs.size()), old_lines, new_lines);
    i = end;
  }
  return out;
}

}  // namespace pmac::style
