// Which warnings are given, and which of them count as errors: the -W options, and the comments in the sources
//     Table(10) = 1   // pmacc: ignore(array-bounds)          this line
//     // pmacc: ignore(array-bounds, redeclared)               alone on its line: the next line
//     // pmacc: ignore-file(unused-local)                      the whole file
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/source/message.h"
#include "compiler/source/source.h"

namespace pmac::source {

/// The -W options of a command line.
class WarningOptions {
 public:
  /// Takes one option without its -W: all, extra, name, no-name, error, no-error, error=name, no-error=name.
  /// Later options win. Returns what is wrong with it, with a suggestion, or empty.
  std::string apply(std::string_view option);
  /// -w: no warnings at all.
  void silence() { silent_ = true; }

  bool is_on(const MessageInfo& row) const;
  bool is_error(const MessageInfo& row) const;

 private:
  bool silent_ = false, all_ = false, extra_ = false, all_are_errors_ = false;
  std::map<std::string, bool, std::less<>> on_;       // by name, where an option named it
  std::map<std::string, bool, std::less<>> errors_;
};

/// Decides for each diagnostic whether it is given, and how.
class WarningControl : public DiagnosticFilter {
 public:
  explicit WarningControl(const SourceManager& sources, WarningOptions options = {}) : sources_(sources), options_(std::move(options)) {}

  /// False: not given. Changes a warning into an error where the options ask for it.
  bool accept(Diagnostic& diagnostic) override;

  /// Reports names in suppression comments that no warning has, and, where all stages have run, comments that kept nothing quiet.
  /// Looks at files from `first_file` on.
  void report_comments(std::int32_t first_file, bool all_stages_ran, Diagnostics& diagnostics);

 private:
  struct Suppression { std::string group; Span span; int line; bool whole_file; bool used; };

  std::vector<Suppression>& suppressions_of(std::int32_t file);
  bool is_suppressed(std::string_view group, const Span& span);

  const SourceManager& sources_;
  WarningOptions options_;
  std::map<std::int32_t, std::vector<Suppression>> suppressions_;
};

}  // namespace pmac::source
