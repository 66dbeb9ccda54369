// The comments that keep warnings quiet: // pmacc: ignore(name, name) and // pmacc: ignore-file(name).
#pragma once

#include <string>
#include <vector>

#include "compiler/source/source.h"

namespace pmac::source {

/// One name of such a comment; an empty group: a comment for pmacc that is none of its own.
struct SuppressionComment { std::string group; Span span; int line = 0; bool whole_file = false; };  // line: the one that it counts for

/// All of a file, in their order. Each line is looked at once, whatever stands on it.
std::vector<SuppressionComment> read_suppressions(const SourceManager& sources, std::int32_t file);

}  // namespace pmac::source
