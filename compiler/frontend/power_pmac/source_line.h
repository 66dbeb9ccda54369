// The lines of the load stream as the preprocessor met them, for pmacc -E.
#pragma once

#include "compiler/frontend/power_pmac/macros.h"

namespace pmac::compiler::power_pmac {

/// Text and directives that count, and where files begin and end.
struct SourceLine {
  enum class Kind : std::uint8_t { kText, kDefinition, kFileBegins, kFileEnds };
  Kind kind = Kind::kText;
  PreprocessorTokens tokens;   // without comments, macros not expanded; #define and #undef of kDefinition
  std::int32_t file = -1;
};

}  // namespace pmac::compiler::power_pmac
