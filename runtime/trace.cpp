#include "runtime/trace.h"

#include <fmt/format.h>

namespace pmac::runtime {
namespace {

std::string name_of(const Runner& runner) {
  if (runner.kind == RunnerKind::kPlc) return fmt::format("plc {}", runner.number);
  return fmt::format("&{} prog {}", runner.number, runner.thread.top_program().program->number);
}

}  // namespace

RunResult run_program(Machine::State& state, Runner& runner, std::uint64_t instruction_budget, std::int64_t jump_back_limit) {
  Thread& thread = runner.thread;
  if (!state.options.observers.line) return thread.run(*state.host, instruction_budget, jump_back_limit);
  RunResult result{RunStop::kBudget, 0, {}};
  bytecode::SourceLine last;
  while (result.stop == RunStop::kBudget && result.instructions < instruction_budget && thread.active()) {
    const bytecode::SourceLine here = thread.source();
    if (here.line > 0 && (here.file != last.file || here.line != last.line)) state.options.observers.line(state.now_ms, name_of(runner), here);
    last = here;
    const std::uint64_t before = result.instructions;
    result = thread.run(*state.host, 1, jump_back_limit);
    result.instructions += before;
  }
  return result;
}

}  // namespace pmac::runtime
