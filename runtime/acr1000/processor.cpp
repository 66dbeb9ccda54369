#include "runtime/acr1000/processor.h"

#include <utility>

#include <fmt/format.h>

namespace pmac::acr1000 {

using runtime::RunStop;

CardProcessor::CardProcessor(Card& card, std::function<void(std::string_view)> print, ProgramMemory* memory)
    : card_(card), p_(bytecode::kPCount), q_(bytecode::kQCount), host_(card, std::move(print)), line_(p_.data(), q_.data()), program_(p_.data(), q_.data()) {
  host_.memory = memory;
  card_.bind_parameters(std::span(p_).first(card.config().parameter_count));
}

void CardProcessor::start(runtime::ProgramHandle commands) {
  line_waits_ = false;
  line_.begin(std::move(commands));
}

void CardProcessor::end_program() {
  program_.stop();
  host_.program_runs = false;
  line_waits_ = false;
}

void CardProcessor::halt() {
  end_program();
  host_.peek.reset();
}

void CardProcessor::abandon() {
  halt();
  line_.stop();
}

/// True: an answer still has to wait for the end of the motion.
bool CardProcessor::answer_peek() {
  if (!host_.peek) return false;
  if (card_.moves()) return true;
  std::string text;
  for (std::uint32_t i = 0; i < host_.peek->count; ++i) text += fmt::format("{}{:02X}", i ? " " : "", card_.memory().peek(static_cast<std::uint16_t>(host_.peek->address + i)));
  host_.peek.reset();
  host_.print(text + "\r\n");
  return false;
}

/// RUN, HALT, NEW. True: the program begins anew, which is a way back.
bool CardProcessor::obey(bool from_program) {
  const ProgramRequest request = std::exchange(host_.request, {});
  if (request.kind == ProgramRequest::Kind::kNone) return false;
  const bool line_waited = line_waits_;
  end_program();
  if (request.kind == ProgramRequest::Kind::kErase) {
    host_.stored = {};
    if (host_.memory) host_.memory->erase();
  }
  if (request.kind != ProgramRequest::Kind::kRun || !host_.stored) return false;
  program_.begin(host_.stored, request.line);
  host_.program_runs = true;
  line_waits_ = !from_program || line_waited;
  return from_program;
}

DriverStep CardProcessor::fail(const runtime::RunResult& result, std::uint64_t commands, bool in_program) {
  DriverStep step;
  step.stop = DriverStop::kFault;
  step.commands = commands;
  step.fault = DriverFault{host_.fault_id.empty() ? "ACR-E02" : std::exchange(host_.fault_id, {}), result.fault->detail, host_.place};
  if (in_program) end_program();
  return step;
}

DriverStep CardProcessor::step(std::uint64_t command_budget) {
  DriverStep step;
  for (;;) {
    if (answer_peek()) {
      step.stop = DriverStop::kJumpedBack;
      return step;
    }
    const bool line_first = executes_line();
    if (!line_first && !program_.active()) return step;  // kIdle
    if (step.commands >= command_budget) {
      step.stop = DriverStop::kBudget;
      return step;
    }
    runtime::Thread& thread = line_first ? line_ : program_;
    thread.reset_jump_backs();
    const runtime::RunResult result = thread.run(host_, command_budget - step.commands, 1);
    step.commands += result.instructions;
    if (result.stop == RunStop::kFault) return fail(result, step.commands, !line_first);
    if (result.stop == RunStop::kEnded && !line_first) end_program();
    const bool begins_anew = result.stop == RunStop::kSuspended && obey(!line_first);
    if (card_.waits()) step.stop = DriverStop::kWaits;
    else if (result.stop == RunStop::kJumpBack || begins_anew) step.stop = DriverStop::kJumpedBack;
    else continue;
    return step;
  }
}

}  // namespace pmac::acr1000
