// A run of a program that names every source line as it begins to execute it. One instruction at a time: only who asks for it pays.
#pragma once

#include "runtime/interpreter/interpreter.h"
#include "runtime/state.h"

namespace pmac::runtime {

/// As runner.thread.run(), and tells the machine's line observer, where there is one, of every line.
RunResult run_program(Machine::State& state, Runner& runner, std::uint64_t instruction_budget, std::int64_t jump_back_limit);

}  // namespace pmac::runtime
