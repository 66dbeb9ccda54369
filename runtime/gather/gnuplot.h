// Runs gnuplot as a child process: script in, picture out.
#pragma once

#include <string>

namespace pmac::runtime {

/// What gnuplot writes to its standard output for the script. Throws OutputError if gnuplot is not installed or refuses the
/// script (with its message).
std::string run_gnuplot(const std::string& script);

}  // namespace pmac::runtime
