// Runs a command and says what it used up.
#pragma once

#include <string>

namespace pmac::bench {

struct Usage {
  double cpu_s = 0;      // user and system
  double peak_mib = 0;
  bool ran = false;      // it ended by itself with exit code 0, or with one that was allowed
};

/// Runs a shell command with its output thrown away. also_ok: another exit code that counts as success.
Usage measure(const std::string& command, int also_ok = 0);

/// The best (least cpu) of several runs.
Usage best_of(int runs, const std::string& command, int also_ok = 0);

}  // namespace pmac::bench
