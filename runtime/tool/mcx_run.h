// pmac-run arc.mcx: a register script on a simulated MCX514.
#pragma once

#include <string>

#include "runtime/tool/options.h"

namespace pmac::tool {

/// The files of the command line are register scripts: one of them ends in .mcx.
bool is_register_script(const RunOptions& options);

/// Reads, checks and executes the script and writes what the options ask for. Returns an exit code; messages are on standard error.
int run_register_script(const RunOptions& options);

}  // namespace pmac::tool
