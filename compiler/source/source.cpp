#include "compiler/source/source.h"

#include <algorithm>
#include <cctype>

#include "compiler/source/encoding.h"

namespace pmac::source {

Span join(const Span& first, const Span& last) {
  if (!first.valid()) return last;
  if (first.file != last.file || last.end < first.begin) return first;
  Span joined = first;
  joined.end = std::max(first.end, last.end);
  if (first.begin != last.begin) joined.expansion = -1;
  return joined;
}

namespace {

/// Calls back with the offset behind every line end.
template <typename Callback>
void for_each_line_end(const std::string& text, Callback&& behind) {
  for (std::size_t at = text.find('\n'); at != std::string::npos; at = text.find('\n', at + 1)) behind(at + 1);
}

}  // namespace

std::int32_t SourceManager::add_file(std::string name, std::string text, Span included_from) {
  File file{std::move(name), decode_text(std::move(text)), included_from, {0}, {}};
  if (file.text.starts_with("\xef\xbb\xbf")) file.line_starts[0] = 3;
  std::size_t lines = 1;
  for_each_line_end(file.text, [&](std::size_t) { ++lines; });
  file.line_starts.reserve(lines);
  for_each_line_end(file.text, [&](std::size_t begin) { file.line_starts.push_back(static_cast<std::uint32_t>(begin)); });
  files_.push_back(std::move(file));
  return static_cast<std::int32_t>(files_.size() - 1);
}

std::int32_t SourceManager::add_expansion(std::string macro, Span definition, std::int32_t parent) {
  expansions_.push_back({std::move(macro), definition, parent});
  return static_cast<std::int32_t>(expansions_.size() - 1);
}

LineColumn SourceManager::line_column(std::int32_t file_index, std::uint32_t offset) const {
  const auto& starts = file(file_index).line_starts;
  const auto next = std::upper_bound(starts.begin(), starts.end(), offset);
  const auto line = std::max(1, static_cast<int>(next - starts.begin()));
  offset = std::max(offset, starts.front());  // behind a byte-order mark
  return {line, static_cast<int>(offset - starts[static_cast<std::size_t>(line - 1)]) + 1};
}

void SourceManager::add_line_marker(std::int32_t file_index, std::uint32_t offset, int line, const std::string& name) {
  File& changed = files_[static_cast<std::size_t>(file_index)];
  const std::string& before = changed.line_markers.empty() ? changed.name : changed.line_markers.back().name;
  changed.line_markers.push_back({offset, line, name.empty() ? before : name});
}

Place SourceManager::place(const Span& span) const {
  const File& source = file(span.file);
  const LineColumn at = line_column(span.file, span.begin);
  const auto after = std::upper_bound(source.line_markers.begin(), source.line_markers.end(), span.begin, [](std::uint32_t offset, const File::LineMarker& m) { return offset < m.offset; });
  if (after == source.line_markers.begin()) return {source.name, at.line, at.column};
  const File::LineMarker& marker = *std::prev(after);
  return {marker.name, marker.line + at.line - line_column(span.file, marker.offset).line, at.column};
}

std::string_view SourceManager::line_text(std::int32_t file_index, int line) const {
  const File& source = file(file_index);
  const std::uint32_t begin = source.line_starts[static_cast<std::size_t>(line - 1)];
  const auto end = source.text.find_first_of("\r\n", begin);
  return std::string_view(source.text).substr(begin, end == std::string::npos ? end : end - begin);
}

std::string_view SourceManager::text(const Span& span) const {
  if (!span.valid()) return {};
  const std::string_view whole = file(span.file).text;
  if (span.begin > whole.size()) return {};
  return whole.substr(span.begin, span.end - span.begin);
}

Diagnostic& Diagnostics::report(Diagnostic diagnostic) {
  if (filter_ && !filter_->accept(diagnostic)) {
    ignored_ = std::move(diagnostic);
    return ignored_;
  }
  const bool repeated = diagnostic.span.valid() && !seen_.insert({diagnostic.span.file, diagnostic.span.begin, diagnostic.code + diagnostic.message}).second;
  const bool is_error = diagnostic.severity == Severity::kError;
  const bool counts = is_error && !is_repetitive(diagnostic.code);
  const bool over_limit = counts && limited_count_ >= error_limit_;
  if (repeated || over_limit) {
    dropped_count_ += over_limit && !repeated;
    ignored_ = std::move(diagnostic);
    return ignored_;
  }
  error_count_ += is_error;
  limited_count_ += counts;
  warning_count_ += diagnostic.severity == Severity::kWarning;
  all_.push_back(std::move(diagnostic));
  return all_.back();
}

Diagnostic& Diagnostics::error(std::string code, Span span, std::string message) {
  return report({Severity::kError, std::move(code), span, std::move(message), {}, {}});
}

Diagnostic& Diagnostics::warning(std::string code, Span span, std::string message) {
  return report({Severity::kWarning, std::move(code), span, std::move(message), {}, {}});
}

std::vector<Diagnostic> Diagnostics::take() {
  std::vector<Diagnostic> taken(std::make_move_iterator(all_.begin()), std::make_move_iterator(all_.end()));
  all_.clear();
  seen_.clear();
  error_count_ = warning_count_ = dropped_count_ = limited_count_ = 0;
  return taken;
}

bool is_repetitive(std::string_view code) { return code.starts_with("PM202") || code == "PM2011" || code == "PM7001"; }

namespace {

char lower(char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); }

/// Levenshtein distance with swapped neighbours as one step, case ignored.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before, last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const bool same = lower(a[i - 1]) == lower(b[j - 1]);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (same ? 0u : 1u)});
      const bool swapped = i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1]);
      if (swapped) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    before = last;
    last = row;
  }
  return last[b.size()];
}

}  // namespace

std::string_view nearest_word(std::string_view word, const std::vector<std::string_view>& candidates) {
  std::string_view best;
  if (word.size() > 100) return best;
  std::size_t best_distance = std::max<std::size_t>(1, word.size() / 3) + 1;
  for (const std::string_view candidate : candidates) {
    if (candidate.size() + best_distance < word.size() || word.size() + best_distance < candidate.size()) continue;
    const std::size_t distance = edit_distance(word, candidate);
    if (distance < best_distance) best_distance = distance, best = candidate;
  }
  return best;
}

Guess guess_word(std::string_view word, const std::vector<std::string_view>& candidates) {
  Guess guess{nearest_word(word, candidates), false};
  if (guess.word.empty() || word.size() < 4 || edit_distance(word, guess.word) > 1) return guess;
  guess.certain = std::none_of(candidates.begin(), candidates.end(), [&](std::string_view other) { return other != guess.word && edit_distance(word, other) <= 1; });
  return guess;
}

}  // namespace pmac::source
