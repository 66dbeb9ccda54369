// The command line of pmacc.
#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "compiler/compiler.h"

namespace pmac::pmacc {

constexpr int kOk = 0, kUserError = 1, kUsage = 2, kInternal = 70;

struct Arguments {
  std::vector<std::string> files, include_dirs, defines, warnings;
  std::string output, emit, format = "text", color = "auto", explain;
  std::size_t error_limit = 100;
  bool check = false, preprocess = false;
};

/// What the person at the command line has to mend: a wrong option, an unreadable file. Ends with exit code 2.
struct UsageError : std::runtime_error { using std::runtime_error::runtime_error; };

/// Reads the command line. exit_code has a value when there is nothing left to do (--help, --version, a wrong option).
Arguments parse_command_line(int argc, char** argv, std::optional<int>& exit_code);

/// What the compiler needs to know of it.
compiler::Options compiler_options(const Arguments& arguments);

}  // namespace pmac::pmacc
