// Diagnostics as text for people and as JSON for tools.
#pragma once

#include <string>

#include "compiler/source/source.h"

namespace pmac::source {

/// file:line:col: error: message [PM1203], the source line with caret and range, the repair, the notes.
std::string format_text(const SourceManager& sources, const Diagnostic& diagnostic, bool color);

/// One JSON object: {"diagnostics": [{severity, code, message, file, line, column, end_line, end_column, notes, fix}]}.
std::string format_json(const SourceManager& sources, const std::vector<Diagnostic>& diagnostics);

/// "file:line:col" of the begin of a span, or "<no source>".
std::string place_of(const SourceManager& sources, const Span& span);

}  // namespace pmac::source
