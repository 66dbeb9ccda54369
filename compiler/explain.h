// What stands behind each code of a message, for --explain.
#pragma once

#include <string>
#include <string_view>

namespace pmac::compiler {

/// A few sentences with a wrong and a right example, or empty for an unknown code.
std::string explain(std::string_view code);

}  // namespace pmac::compiler
