#include "runtime/acr1000/processor.h"

#include <utility>

#include <fmt/format.h>

namespace pmac::acr1000 {

using runtime::RunStop;

CardProcessor::CardProcessor(Card& card, std::function<void(std::string_view)> print, ProgramMemory* memory)
    : card_(card), p_(bytecode::kPCount), q_(bytecode::kQCount), host_(card, std::move(print)), line_(p_.data(), q_.data()), program_(p_.data(), q_.data()), aside_(p_.data(), q_.data()) {
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

std::optional<DriverFault> CardProcessor::execute_now(runtime::ProgramHandle commands) {
  constexpr std::uint64_t kBudget = 100'000;   // a line has no loops
  const Place waiting = host_.place;
  aside_.begin(std::move(commands));
  const runtime::RunResult result = aside_.run(host_, kBudget, 1);
  const bool asks = std::exchange(host_.request, {}).kind != ProgramRequest::Kind::kNone;
  aside_.stop();
  const Place own = std::exchange(host_.place, waiting);
  if (result.stop == RunStop::kFault) return DriverFault{host_.fault_id.empty() ? "ACR-E02" : std::exchange(host_.fault_id, {}), result.fault->detail, own};
  if (asks || result.stop != RunStop::kEnded) return DriverFault{"ACR-E09", "the card waits for a motion to begin; HALT first", own};
  return std::nullopt;
}

std::uint64_t CardProcessor::position() const {
  std::uint64_t hash = 14695981039346656037u;   // FNV-1a
  const auto add = [&hash](std::uint32_t value) { hash = (hash ^ value) * 1099511628211u; };
  add(program_.pc());
  add(line_.pc());
  for (const std::uint32_t site : host_.call_sites(program_)) add(site);
  return hash;
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
