// A #define as it stands in the load stream, for listings.
#pragma once

#include <string>

#include "compiler/source/source.h"

namespace pmac::compiler::power_pmac {

/// parameters: "(a, b)" or empty. active: not in a group that a conditional leaves out.
struct MacroDefinition { std::string name; std::string parameters; std::string text; source::Span span; bool active = true; };

}  // namespace pmac::compiler::power_pmac
