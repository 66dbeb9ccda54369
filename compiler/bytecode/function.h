// The functions of script expressions, made from the rows of function.def.
#pragma once

#include "compiler/bytecode/bytecode.h"

namespace pmac::bytecode {

enum class Function : std::uint16_t {
#define FUNCTION(Name, name, signature, meaning) k##Name,
#include "compiler/bytecode/function.def"
#undef FUNCTION
  kCount
};

/// argument_count: without the values of a format. uses_memory: some argument is an address, so that it is called by MemoryFunction.
struct FunctionInfo { std::string_view name, signature; int argument_count; bool uses_memory; std::string_view meaning; };
const FunctionInfo& function_info(Function function);

}  // namespace pmac::bytecode
