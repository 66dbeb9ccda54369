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
  std::vector<std::string> card_settings;
  std::string dialect;
  int max_include_depth = 64;
  std::string output, emit, format = "text", color = "auto", explain;
  std::size_t error_limit = 100;
  std::size_t repeat_limit = 2;
  bool check = false, preprocess = false, no_warnings = false, help_warnings = false, fix = false, fix_dry_run = false;
};

/// What the person at the command line has to mend: a wrong option, an unreadable file. Ends with exit code 2.
struct UsageError : std::runtime_error { using std::runtime_error::runtime_error; };

/// Reads the command line. exit_code has a value when there is nothing left to do (--help, --version, a wrong option).
Arguments parse_command_line(int argc, char** argv, std::optional<int>& exit_code);

/// What the compiler needs to know of it. Unknown -W names are named on standard error.
compiler::Options compiler_options(const Arguments& arguments);

}  // namespace pmac::pmacc
