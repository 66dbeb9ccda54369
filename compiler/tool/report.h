// What was found, printed on standard error in the wanted format.
#pragma once

#include "compiler/compiler.h"
#include "compiler/tool/options.h"

namespace pmac::pmacc {

void set_error_limit(compiler::Session& session, const Arguments& arguments);

/// Takes the diagnostics out of the session and prints them; true if there are errors. The formats of tools stand alone on the stream.
bool report(compiler::Session& session, const Arguments& arguments);

}  // namespace pmac::pmacc
