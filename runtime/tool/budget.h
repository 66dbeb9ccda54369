// What a run may use up: moves, memory, bytes of output, and the disks that it writes to. Simulated time and instructions are the machine's own limits. At each of
// them the run ends with exit code 4, and everything so far is written.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "runtime/tool/options.h"

namespace pmac::tool {

class Budget {
 public:
  explicit Budget(const RunOptions& options);

  void count_move() { ++moves_; }
  /// Bytes written so far by somebody who writes.
  void add_output(std::function<std::uint64_t()> bytes) { outputs_.push_back(std::move(bytes)); }

  /// The limit that is reached, as a sentence, or empty. Cheap enough for every few hundred events of a run.
  const std::string& reached();

 private:
  struct Disk { std::string folder, output; };

  std::string find();
  std::string find_full_disk() const;

  const RunOptions& options_;
  std::uint64_t moves_ = 0;
  unsigned calls_ = 0;
  std::vector<std::function<std::uint64_t()>> outputs_;
  std::vector<Disk> disks_;  // of the files that grow with the run, and of standard output where it is a file
  std::string reached_;
};

/// Memory that the process has at the moment, in bytes; 0 where the system does not tell.
std::uint64_t memory_in_use();

}  // namespace pmac::tool
