// Move runs written out: the same module with an instruction a word, as the compiler writes moves that are computed.
#pragma once

#include "compiler/bytecode/bytecode.h"

namespace pmac::reference {

/// Every row of every move run as the words and the block end that it stands for, with its place.
bytecode::Module unrolled(const bytecode::Module& module);

}  // namespace pmac::reference
