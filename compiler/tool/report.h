// What was found, printed on standard error in the wanted format.
#pragma once

#include "compiler/compiler.h"
#include "compiler/tool/options.h"

namespace pmac::pmacc {

/// Takes the diagnostics out of the session and prints them; true if there are errors.
bool report(compiler::Session& session, const Arguments& arguments);

}  // namespace pmac::pmacc
