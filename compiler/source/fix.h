// Repairs put together: which of the safe ones can be done at once, and the texts that come out.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "compiler/source/source.h"

namespace pmac::source {

struct FixPlan {
  struct FileEdits { std::string old_text; std::vector<Edit> edits; };  // edits in order of place, none overlaps another
  std::map<std::string, FileEdits> files;                              // by name
  std::vector<const Diagnostic*> applied;                              // repairs that are in it
  std::vector<const Diagnostic*> conflicting;                          // safe ones that overlap those; another round may do them
};

/// Takes the safe repairs of the diagnostics, in their order, that lie in files `may_change` allows, outside of macro expansions, and
/// that overlap no repair taken before. A repair is taken with all its edits or not at all.
FixPlan plan_fixes(const SourceManager& sources, const std::vector<Diagnostic>& diagnostics, const std::function<bool(const std::string&)>& may_change);

std::string apply_edits(const FixPlan::FileEdits& file);

/// The changes as a unified diff with three lines of context.
std::string unified_diff(const std::string& name, const FixPlan::FileEdits& file);

}  // namespace pmac::source
