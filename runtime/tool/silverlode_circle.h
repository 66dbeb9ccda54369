// pmac-silverlode circle and decode: from the options to the table, its execution, the report and the files.
#pragma once

#include "runtime/tool/silverlode_options.h"

namespace pmac::tool {

/// Builds, executes, reports. Returns an exit code; messages go to standard error. Throws runtime::OutputError.
int run_circle(const SilverlodeOptions& options);

/// One line of meaning for each frame, or what is wrong with it. Returns an exit code.
int run_decode(const SilverlodeOptions& options);

}  // namespace pmac::tool
