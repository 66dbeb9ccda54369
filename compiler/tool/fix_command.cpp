#include "compiler/tool/fix_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iostream>

#include "compiler/source/fix.h"
#include "compiler/source/format.h"
#include "compiler/tool/inputs.h"
#include "compiler/tool/report.h"

namespace pmac::pmacc {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxRounds = 10;  // a repair may bring the next error to light

bool lies_below(const fs::path& path, const fs::path& folder) {
  const auto [end, ignored] = std::mismatch(folder.begin(), folder.end(), path.begin(), path.end());
  return end == folder.end();
}

fs::path canonical(const fs::path& path) {
  std::error_code error;
  const fs::path result = fs::weakly_canonical(path.empty() ? fs::path(".") : path, error);
  return error ? path : result;
}

/// Files named on the command line, and those below their folders that do not come from a -I folder.
class OwnFiles {
 public:
  explicit OwnFiles(const Arguments& arguments) {
    for (const std::string& file : arguments.files) {
      if (file == "-") continue;
      files_.push_back(canonical(file));
      folders_.push_back(fs::is_directory(files_.back()) ? files_.back() : files_.back().parent_path());
    }
    for (const std::string& dir : arguments.include_dirs) library_.push_back(canonical(dir));
  }

  bool contains(const std::string& name) const {
    if (name.starts_with('<')) return false;
    const fs::path path = canonical(name);
    if (std::find(files_.begin(), files_.end(), path) != files_.end()) return true;
    const bool from_library = std::any_of(library_.begin(), library_.end(), [&](const fs::path& dir) { return lies_below(path, dir); });
    return !from_library && std::any_of(folders_.begin(), folders_.end(), [&](const fs::path& folder) { return lies_below(path, folder); });
  }

 private:
  std::vector<fs::path> files_, folders_, library_;
};

/// What --fix did in one place.
std::string done_line(const source::SourceManager& sources, const source::Diagnostic& diagnostic) {
  return fmt::format("{}: fixed: {} [{}]\n", source::place_of(sources, diagnostic.span), diagnostic.message, diagnostic.code);
}

/// A file in UTF-16 was decoded before it was compiled, and one may have changed since: those are left as they are.
bool is_on_disk(const std::string& name, const source::FixPlan::FileEdits& file) { return read_file(name) == file.old_text; }

/// errors_left: errors that no repair was made for.
struct Round { std::size_t applied = 0, files = 0, errors_left = 0; };

Round run_round(const Arguments& arguments, const compiler::Options& options, const OwnFiles& own) {
  compiler::Session session(options);
  set_error_limit(session, arguments);
  session.compile(read_inputs(arguments.files, session));
  const std::vector<source::Diagnostic> found = session.diagnostics().take();
  const source::FixPlan plan = source::plan_fixes(session.sources(), found, [&](const std::string& name) { return own.contains(name); });
  std::size_t written = 0;
  for (const auto& [name, file] : plan.files) {
    if (!is_on_disk(name, file)) {
      std::cerr << fmt::format("pmacc: warning: {} is not repaired; store it as UTF-8 or Latin-1\n", name);
      continue;
    }
    ++written;
    if (arguments.fix_dry_run) std::cout << source::unified_diff(name, file);
    else write_file(name, source::apply_edits(file));
  }
  if (arguments.format == "text" && !arguments.fix_dry_run)
    for (const source::Diagnostic* diagnostic : plan.applied) std::cerr << done_line(session.sources(), *diagnostic);
  const auto is_error = [](const source::Diagnostic& diagnostic) { return diagnostic.severity == source::Severity::kError; };
  const auto errors = static_cast<std::size_t>(std::count_if(found.begin(), found.end(), is_error));
  const auto mended = static_cast<std::size_t>(std::count_if(plan.applied.begin(), plan.applied.end(), [&](const source::Diagnostic* diagnostic) { return is_error(*diagnostic); }));
  return {written ? plan.applied.size() : 0, written, written ? errors - mended : errors};
}

}  // namespace

int fix(const Arguments& arguments, const compiler::Options& options) {
  const OwnFiles own(arguments);
  std::size_t repairs = 0, errors_left = 0;
  const int rounds = arguments.fix_dry_run ? 1 : kMaxRounds;
  for (int i = 0; i < rounds; ++i) {
    const Round round = run_round(arguments, options, own);
    errors_left = round.errors_left;
    if (round.applied == 0) break;
    repairs += round.applied;
  }
  if (arguments.format == "text" && !arguments.fix_dry_run && repairs) std::cerr << fmt::format("{} repair(s) made\n", repairs);
  std::cout << std::flush;
  if (!std::cout) throw UsageError("cannot write the output");
  if (!arguments.fix_dry_run || errors_left == 0) return kOk;
  std::cerr << fmt::format("{} error(s) would be left; pmacc --check shows them\n", errors_left);
  return kUserError;
}

}  // namespace pmac::pmacc
