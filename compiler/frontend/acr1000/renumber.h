// RENUMBER: the stored lines get the numbers 10, 20, 30, ... and their branches follow.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "compiler/source/source.h"

namespace pmac::compiler::acr1000 {

/// Lines by number; each span is a whole line with its number, and correct.
using StoredLines = std::map<std::int64_t, source::Span>;

/// The lines with their new numbers, in order. Branches to lines that are not stored stay as they are and are reported. Nothing where
/// the numbers would go beyond the last one, which is reported too. span: of the command.
std::vector<std::string> renumber(const source::SourceManager& sources, const StoredLines& lines, const source::Span& span, source::Diagnostics& diagnostics);

}  // namespace pmac::compiler::acr1000
