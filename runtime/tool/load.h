// From file names to a loaded machine: sources are compiled together, object files are loaded as they are, in order.
#pragma once

#include <string>
#include <vector>

#include "compiler/compiler.h"
#include "runtime/machine.h"
#include "runtime/tool/options.h"

namespace pmac::tool {

/// Loads the files of the options into the machine. Returns an exit code; messages go to standard error.
int load_files(const RunOptions& options, compiler::Session& session, runtime::Machine& machine);

/// The compiler for on-line texts: the module, or the controller's error text.
runtime::OnlineCompiler online_compiler(compiler::Session& session);

/// The file's bytes; false with errno where it cannot be read.
bool read_file(const std::string& name, std::string& bytes);

}  // namespace pmac::tool
