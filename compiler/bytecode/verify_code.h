// The part of verify() that looks at one program.
#pragma once

#include <string>

#include "compiler/bytecode/bytecode.h"

namespace pmac::bytecode {

/// First reason why the program is not safe to execute, or empty. The tables of the module have been verified.
std::string verify_program(const Module& module, const Program& program);

}  // namespace pmac::bytecode
