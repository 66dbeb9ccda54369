#include "compiler/tool/report.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <limits>
#include <map>
#include <set>

#include "compiler/source/format.h"
#include "compiler/source/message.h"

namespace pmac::pmacc {
namespace {

using Found = std::vector<source::Diagnostic>;

bool use_color(const Arguments& arguments) {
  if (arguments.color != "auto") return arguments.color == "always";
  const char* no_color = std::getenv("NO_COLOR");
  return (no_color == nullptr || *no_color == '\0') && ::isatty(STDERR_FILENO) != 0;
}

/// The order of the text, whatever stage found it.
bool stands_before(const source::Diagnostic& a, const source::Diagnostic& b) { return std::pair(a.span.file, a.span.begin) < std::pair(b.span.file, b.span.begin); }

std::size_t count(const Found& found, source::Severity severity) {
  return static_cast<std::size_t>(std::count_if(found.begin(), found.end(), [&](const auto& d) { return d.severity == severity; }));
}

bool is_turbo(const source::Diagnostic& diagnostic) { return diagnostic.span.valid() && diagnostic.code.starts_with("PM202"); }

/// Messages of one kind in one file that are counted and no longer shown.
class Repetitions {
 public:
  Repetitions(const source::SourceManager& sources, const Found& found, std::size_t limit) : sources_(sources), limit_(limit) {
    for (const source::Diagnostic& diagnostic : found)
      if (is_turbo(diagnostic)) turbo_files_.insert(diagnostic.span.file);
  }

  /// True: show this one too.
  bool show(const source::Diagnostic& diagnostic) {
    if (limit_ == 0 || !source::is_repetitive(diagnostic.code) || !turbo_files_.contains(diagnostic.span.file)) return true;
    Kind& kind = kinds_[{diagnostic.span.file, diagnostic.code}];
    if (kind.shown < limit_) return ++kind.shown, true;
    const int line = sources_.line_column(diagnostic.span.file, diagnostic.span.begin).line;
    if (kind.lines.empty() || kind.lines.back() != line) kind.lines.push_back(line);
    ++kind.hidden;
    return false;
  }

  std::string summary() const {
    std::string text;
    for (const auto& [key, kind] : kinds_) {
      if (kind.hidden == 0) continue;
      const source::MessageInfo* row = source::find_message(key.second);
      text += fmt::format("{}: note: {} more [{}] ({}) in line {}\n", sources_.file(key.first).name, kind.hidden, key.second, row ? row->title : "", lines_text(kind.lines));
    }
    return text;
  }

 private:
  struct Kind { std::size_t shown = 0, hidden = 0; std::vector<int> lines; };

  static std::string lines_text(const std::vector<int>& lines) {
    constexpr std::size_t kListed = 12;
    const auto end = lines.begin() + static_cast<std::ptrdiff_t>(std::min(kListed, lines.size()));
    const std::string text = fmt::format("{}", fmt::join(lines.begin(), end, ", "));
    return lines.size() > kListed ? fmt::format("{} ... {}", text, lines.back()) : text;
  }

  const source::SourceManager& sources_;
  std::size_t limit_;
  std::set<std::int32_t> turbo_files_;
  std::map<std::pair<std::int32_t, std::string>, Kind> kinds_;
};

/// What a person can do next about files in the language of the older controller.
std::string advice(const Found& found, const Arguments& arguments) {
  const bool turbo = std::any_of(found.begin(), found.end(), is_turbo);
  if (!turbo) return {};
  std::string text = "note: this is written in the language of Turbo PMAC";
  if (!arguments.fix) text += "; pmacc --fix rewrites the spellings that have one translation";
  return text + "; --repeat-limit=0 shows every place\n";
}

void print_text(compiler::Session& session, const Found& found, std::size_t dropped, const Arguments& arguments) {
  const bool color = use_color(arguments);
  Repetitions repetitions(session.sources(), found, arguments.repeat_limit);
  for (const source::Diagnostic& diagnostic : found)
    if (repetitions.show(diagnostic)) std::cerr << source::format_text(session.sources(), diagnostic, color);
  std::cerr << repetitions.summary() << advice(found, arguments);
  if (dropped) std::cerr << fmt::format("{} more error(s) are not shown\n", dropped);
  const std::size_t errors = count(found, source::Severity::kError) + dropped;
  const std::size_t warnings = count(found, source::Severity::kWarning);
  if (errors || warnings) std::cerr << fmt::format("{} error(s), {} warning(s)\n", errors, warnings);
}

}  // namespace

void set_error_limit(compiler::Session& session, const Arguments& arguments) {
  session.diagnostics().set_error_limit(arguments.error_limit ? arguments.error_limit : std::numeric_limits<std::size_t>::max());
}

bool report(compiler::Session& session, const Arguments& arguments) {
  const std::size_t dropped = session.diagnostics().dropped_count();
  Found found = session.diagnostics().take();
  std::stable_sort(found.begin(), found.end(), stands_before);
  if (arguments.format == "json") std::cerr << source::format_json(session.sources(), found);
  else if (arguments.format == "sarif") std::cerr << source::format_sarif(session.sources(), found);
  else if (arguments.format == "github") std::cerr << source::format_github(session.sources(), found);
  else print_text(session, found, dropped, arguments);
  return count(found, source::Severity::kError) > 0 || dropped > 0;
}

}  // namespace pmac::pmacc
