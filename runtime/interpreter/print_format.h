// Fills printf formats in.
#pragma once

#include <string>

#include "compiler/bytecode/format_text.h"

namespace pmac::runtime {

/// The value as an integer or number conversion prints it. Integers are truncated toward zero; nan and infinities are printed
/// as words under every conversion.
std::string print_value(const bytecode::Conversion& conversion, double value);
std::string print_text(const bytecode::Conversion& conversion, const std::string& text);

}  // namespace pmac::runtime
