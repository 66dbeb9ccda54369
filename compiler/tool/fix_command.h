// --fix: the safe repairs, done in the files.
#pragma once

#include "compiler/tool/options.h"

namespace pmac::pmacc {

/// Repairs the files of the command line, and those that they include from their own folders, until no safe repair is left; every
/// file is whole at any moment. Says on standard error what was done. With --fix-dry-run: prints one round as a unified diff and
/// changes nothing.
int fix(const Arguments& arguments, const compiler::Options& options);

}  // namespace pmac::pmacc
