// Diagnostics as text for people and in the formats of tools.
#pragma once

#include <string>

#include "compiler/source/source.h"

namespace pmac::source {

/// file:line:col: error: message [PM2011], the source lines with the range marked, the repair, the notes; the include stack before it.
std::string format_text(const SourceManager& sources, const Diagnostic& diagnostic, bool color);

/// One JSON object: {"diagnostics": [{severity, code, group, message, file, line, column, end_line, end_column, included_from,
/// expansion, notes, fix}]}. Columns count bytes from 1.
std::string format_json(const SourceManager& sources, const std::vector<Diagnostic>& diagnostics);

/// A SARIF 2.1.0 log with one run. Columns count UTF-16 code units.
std::string format_sarif(const SourceManager& sources, const std::vector<Diagnostic>& diagnostics);

/// Workflow commands of GitHub Actions, one line for each diagnostic: ::error file=a.pmc,line=3,col=5,...::message.
std::string format_github(const SourceManager& sources, const std::vector<Diagnostic>& diagnostics);

/// "file:line:col" of the begin of a span, or "<no source>".
std::string place_of(const SourceManager& sources, const Span& span);

std::string_view severity_name(Severity severity);

}  // namespace pmac::source
