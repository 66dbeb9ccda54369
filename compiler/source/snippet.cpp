#include "compiler/source/snippet.h"

#include <fmt/format.h>

#include <algorithm>

#include "compiler/source/characters.h"

namespace pmac::source {
namespace {

constexpr std::size_t kShownColumns = 120;
constexpr std::size_t kTab = 4;
constexpr int kShownLines = 4;  // of a span over several lines
constexpr std::size_t kNearBytes = 2000;  // around a mark: more than can be shown, however many bytes a character has

/// The part of a line that is near its marked bytes [begin, end); the rest of a very long line is not looked at.
struct Near { std::string_view text; std::size_t begin, end; bool cut_before, cut_behind; };

Near near_mark(std::string_view line, std::size_t begin, std::size_t end) {
  std::size_t first = begin > 2 * kNearBytes ? begin - kNearBytes : 0;
  while (first > 0 && first < begin && (static_cast<unsigned char>(line[first]) & 0xc0) == 0x80) ++first;  // inside a character
  const std::size_t last = std::min(line.size(), begin + 2 * kNearBytes);
  return {line.substr(first, last - first), begin - first, std::max(std::min(end, last), first) - first, first > 0, last < line.size()};
}

/// A line as it is shown: cells of one terminal column each, and where its marked bytes lie.
struct Shown {
  std::vector<std::string> cells;   // the second cell of a wide character is empty
  std::size_t mark_begin = 0, mark_end = 0;
};

bool is_control(char32_t code) { return code < 0x20 || (code >= 0x7f && code < 0xa0); }

/// begin, end: marked bytes of the line.
Shown show(std::string_view line, std::size_t begin, std::size_t end) {
  Shown shown;
  bool begun = false;
  for (std::size_t at = 0; at < line.size();) {
    if (!begun && at >= begin) shown.mark_begin = shown.cells.size(), begun = true;
    const Character c = character_at(line, at);
    const int width = terminal_width(c.code);
    if (c.code == '\t') {
      do shown.cells.emplace_back(" ");
      while (shown.cells.size() % kTab != 0);
    } else if (width == 0) {
      if (!shown.cells.empty()) append_utf8(c.code, shown.cells.back());
    } else {
      shown.cells.emplace_back();
      append_utf8(is_control(c.code) ? U' ' : c.code, shown.cells.back());
      if (width == 2) shown.cells.emplace_back();
    }
    at += c.bytes;
    if (at <= end) shown.mark_end = shown.cells.size();
  }
  if (!begun) shown.mark_begin = shown.cells.size();
  shown.mark_end = std::max(shown.mark_end, shown.mark_begin + 1);
  return shown;
}

/// Cuts a long line so that the mark stays in sight.
std::pair<std::string, std::string> cut(const Shown& shown, const Near& near, char head) {
  const std::size_t size = std::max(shown.cells.size(), shown.mark_begin + 1);
  std::size_t first = 0, last = size;
  if (size > kShownColumns) {
    const std::size_t context = kShownColumns / 3;
    first = shown.mark_begin > 2 * context ? shown.mark_begin - context : 0;
    last = std::min(size, first + kShownColumns);
  }
  std::string text = first || near.cut_before ? "..." : "";
  std::string mark(text.size(), ' ');
  for (std::size_t i = first; i < std::min(last, shown.cells.size()); ++i) text += shown.cells[i];
  if (last < size || near.cut_behind) text += "...";
  mark.append(shown.mark_begin - first, ' ');
  mark += head;
  const std::size_t mark_end = std::min(shown.mark_end, last);
  if (mark_end > shown.mark_begin + 1) mark.append(mark_end - shown.mark_begin - 1, '~');
  return {text, mark};
}

}  // namespace

std::string snippet(const SourceManager& sources, const Span& span, const std::function<std::string(std::string_view)>& paint) {
  const LineColumn begin = sources.line_column(span.file, span.begin);
  const LineColumn end = sources.line_column(span.file, std::max(span.begin, span.end));
  const int last = end.line > begin.line && end.column == 1 ? end.line - 1 : end.line;
  std::string text;
  for (int line = begin.line; line <= last; ++line) {
    const bool left_out = last - begin.line >= kShownLines && line > begin.line + 1 && line < last;
    if (left_out) {
      text += "    ...\n";
      line = last - 1;
      continue;
    }
    const std::string_view whole = sources.line_text(span.file, line);
    const std::size_t indent = line == begin.line ? 0 : std::min(whole.find_first_not_of(" \t"), whole.size());
    const std::size_t from = line == begin.line ? static_cast<std::size_t>(begin.column - 1) : indent;
    const std::size_t to = line == end.line ? static_cast<std::size_t>(end.column - 1) : whole.size();
    const Near near = near_mark(whole, std::min(from, whole.size()), to);
    const auto [shown, mark] = cut(show(near.text, near.begin, near.end), near, line == begin.line ? '^' : '~');
    const std::size_t blanks = mark.find_first_not_of(' ');
    text += fmt::format("    {}\n    {}{}\n", shown, mark.substr(0, blanks), paint(mark.substr(blanks)));
  }
  return text;
}

}  // namespace pmac::source
