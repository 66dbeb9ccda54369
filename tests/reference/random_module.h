// Random modules that verify() accepts: every opcode, every operand format, every table.
#pragma once

#include <random>

#include "compiler/bytecode/bytecode.h"

namespace pmac::reference {

/// Same seed, same module.
bytecode::Module random_module(std::uint32_t seed);

/// Changes one random field of the module somewhere, in range or not.
void damage(bytecode::Module& module, std::mt19937& random);

}  // namespace pmac::reference
