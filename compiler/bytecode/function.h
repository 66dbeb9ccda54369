// The functions of script expressions, made from the rows of function.def.
#pragma once

#include "compiler/bytecode/bytecode.h"

namespace pmac::bytecode {

enum class Function : std::uint16_t {
#define FUNCTION(Name, name, argument_count, meaning) k##Name,
#include "compiler/bytecode/function.def"
#undef FUNCTION
  kCount
};

struct FunctionInfo { std::string_view name; int argument_count; std::string_view meaning; };
const FunctionInfo& function_info(Function function);

}  // namespace pmac::bytecode
