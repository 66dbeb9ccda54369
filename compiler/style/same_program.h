// The safety net of the formatter: what it made, read again, must be the program that it read.
#pragma once

#include <optional>
#include <string>

#include "compiler/style/source_text.h"

namespace pmac::style {

struct Difference {
  std::size_t offset = 0;  // of the text before
  std::string what;
};

/// Compares words, line ends between words, comments and directives, and the words that the compiler reads behind the
/// preprocessor. Only letter case that has no meaning, blanks and blank lines may differ. nullopt: the same program.
std::optional<Difference> find_difference(const SourceText& before, std::string_view after, const std::string& file_name, const Names& names);

}  // namespace pmac::style
