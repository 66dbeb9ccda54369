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

/// Prints what the session has to say on standard error and forgets it. True if there were errors.
bool print_diagnostics(compiler::Session& session);

/// Where the first error of an on-line text stands; line 0: nowhere. before: lines in front of the text.
struct ErrorPlace { int line = 0, column = 0; int before = 0; };

/// The compiler for on-line texts: the module, or the controller's error text. place: filled with the error's place.
runtime::OnlineCompiler online_compiler(compiler::Session& session, ErrorPlace* place = nullptr);

/// Lines of the session's sources by file name; where a name was used more than once, of the last text of that name.
std::function<std::optional<std::string>(const std::string& file, int line)> source_lines(const compiler::Session& session);

inline constexpr std::size_t kLongestInput = std::size_t{1} << 30;   // bytes of one file

/// The file's bytes; false with errno where it cannot be read or is longer than kLongestInput.
bool read_file(const std::string& name, std::string& bytes);

}  // namespace pmac::tool
