#include "tests/fuzz/small_machine.h"

namespace pmac::fuzz {

SmallMachine::SmallMachine(const Bounds& bounds, runtime::OnlineCompiler compile_online)
    : bounds_(bounds), machine_(options(std::move(compile_online))) {}

runtime::MachineOptions SmallMachine::options(runtime::OnlineCompiler compile_online) {
  runtime::MachineOptions options;
  options.max_instructions = bounds_.instructions;
  options.compile_online = std::move(compile_online);
  options.observers.move = [this](const runtime::MoveRecord&) { ++moves_; };
  options.observers.fault = [](const runtime::FaultRecord&) {};
  options.observers.answer = [](const std::string&) {};
  options.observers.refused = [](const std::string&, const std::string&) {};
  return options;
}

runtime::RunLimits SmallMachine::limits() {
  runtime::RunLimits limits;
  limits.max_ms = bounds_.time_ms;
  limits.over_budget = [this] { return moves_ > bounds_.moves; };
  limits.interrupted = [this] { return ++polls_ > bounds_.polls; };
  return limits;
}

}  // namespace pmac::fuzz
