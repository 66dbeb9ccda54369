// A simulated controller that ends soon whatever it is told: bounded simulated time, instructions, moves and polls.
#pragma once

#include "runtime/machine.h"

namespace pmac::fuzz {

/// Everything that a run may use up. Counters, so that the same input does the same.
struct Bounds {
  double time_ms = 200;
  std::uint64_t instructions = 100'000;
  int moves = 500;
  int polls = 20'000;    // times that the machine asks whether it is to go on
};

class SmallMachine {
 public:
  explicit SmallMachine(const Bounds& bounds, runtime::OnlineCompiler compile_online);

  runtime::Machine& machine() { return machine_; }
  /// Until idle, or one of the bounds.
  runtime::RunOutcome run() { return machine_.run(limits()); }
  runtime::RunLimits limits();

 private:
  runtime::MachineOptions options(runtime::OnlineCompiler compile_online);

  Bounds bounds_;
  int moves_ = 0, polls_ = 0;
  runtime::Machine machine_;
};

}  // namespace pmac::fuzz
