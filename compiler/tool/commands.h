// What pmacc can be asked to do. Each returns the exit code.
#pragma once

#include "compiler/tool/options.h"

namespace pmac::pmacc {

/// Does what the command line says.
int run(const Arguments& arguments);

}  // namespace pmac::pmacc
