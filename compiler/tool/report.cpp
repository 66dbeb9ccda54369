#include "compiler/tool/report.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>

#include "compiler/source/format.h"

namespace pmac::pmacc {
namespace {

bool use_color(const Arguments& arguments) {
  if (arguments.color != "auto") return arguments.color == "always";
  return std::getenv("NO_COLOR") == nullptr && ::isatty(STDERR_FILENO) != 0;
}

}  // namespace

bool report(compiler::Session& session, const Arguments& arguments) {
  const std::size_t dropped = session.diagnostics().dropped_count();
  const std::vector<source::Diagnostic> found = session.diagnostics().take();
  const auto count = [&](source::Severity severity) { return std::count_if(found.begin(), found.end(), [&](const auto& d) { return d.severity == severity; }); };
  if (arguments.format == "json") {
    std::cerr << source::format_json(session.sources(), found);
    return count(source::Severity::kError) > 0;
  }
  for (const source::Diagnostic& diagnostic : found) std::cerr << source::format_text(session.sources(), diagnostic, use_color(arguments));
  if (dropped) std::cerr << fmt::format("{} more error(s) are not shown\n", dropped);
  const auto errors = static_cast<std::size_t>(count(source::Severity::kError)) + dropped;
  const auto warnings = count(source::Severity::kWarning);
  if (errors || warnings) std::cerr << fmt::format("{} error(s), {} warning(s)\n", errors, warnings);
  return errors > 0;
}

}  // namespace pmac::pmacc
