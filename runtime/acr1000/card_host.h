// What programs and command lines of a card reach: the instructions of the interpreter become requests to the card. Private to the
// processor.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "runtime/acr1000/card.h"
#include "runtime/acr1000/program_memory.h"
#include "runtime/interpreter/interpreter.h"

namespace pmac::acr1000 {

/// What a command asks of the processor that executes it.
struct ProgramRequest {
  enum class Kind : std::uint8_t { kNone, kRun, kHalt, kErase };
  Kind kind = Kind::kNone;
  std::int64_t line = -1;               // of kRun: first line, -1: the lowest
};

/// Bytes that PEEK asks for.
struct PeekRequest { std::uint32_t address = 0, count = 0; };

class CardHost : public runtime::Host {
 public:
  using Flow = runtime::Flow;
  using Thread = runtime::Thread;

  CardHost(Card& card, std::function<void(std::string_view)> print) : card_(card), print_(std::move(print)) {}

  Flow card(Thread&, bytecode::CardVerb, std::span<const double> arguments) override;
  double relay(Thread&, double number) override;
  Flow send(Thread&, int port, std::string_view text) override;
  Flow online(Thread&, const bytecode::Module&, const bytecode::Instruction&, std::span<const double> registers) override;

  double read_m(Thread&, int number) override;
  void write_m(Thread&, int number, double value) override;
  double read_i(Thread&, int number) override;
  void write_i(Thread&, int number, double value) override;
  double read_element(Thread&, const runtime::ElementAddress&) override;
  Flow write_element(Thread&, const runtime::ElementAddress&, double value) override;
  double element_address(Thread&, const runtime::ElementAddress&) override;
  Flow motion(Thread&, const bytecode::Instruction&, std::span<const double> registers) override;
  Flow control(Thread&, bytecode::ControlVerb, std::span<const double> arguments) override;
  Flow queue_assignment(Thread&, const bytecode::SyncTarget&, const runtime::ElementAddress&, double value) override;
  runtime::ProgramHandle find_subprogram(std::uint32_t number) override;
  Flow command(Thread&, std::string_view text) override;
  double random(double range) override;
  void seed_random(double seed) override;

  void print(std::string_view text);
  std::uint64_t outputs() const { return outputs_; }
  /// Where the open GSBs of the program were called, the first one first.
  std::span<const std::uint32_t> call_sites(const Thread& thread) const;

  /// Of the last command that the card was asked for, or that failed.
  Place place;
  std::string fault_id;                 // of the last fault
  ProgramRequest request;               // of the last command, for the processor to take
  std::optional<PeekRequest> peek;      // waits for the end of the motion
  runtime::ProgramHandle stored;        // the program that load scripts install
  ProgramMemory* memory = nullptr;
  bool program_runs = false;

 private:
  Flow fail(Thread& thread, std::string id, std::string detail);
  Flow refuse(Thread& thread) { return fail(thread, "ACR-E01", "this instruction is none of a card"); }
  bool whole(Thread& thread, double value, double least, double most, const char* what);
  Flow set_rate(Thread& thread, bytecode::CardVerb verb, double value);
  Flow move(Thread& thread, bytecode::CardVerb verb, std::span<const double> arguments);
  Flow change_relay(Thread& thread, bool on, double number);
  void note_call(const Thread& thread);
  Flow run(Thread& thread, double line);
  Flow ask_peek(Thread& thread, double address, double count);
  Flow fast_block(Thread& thread, std::string_view digits);
  Flow answer_from_memory(bytecode::CardVerb verb);
  std::int64_t parameter(std::size_t number) const { return card_.parameter(number); }

  Card& card_;
  std::function<void(std::string_view)> print_;
  std::uint64_t outputs_ = 0;
  std::vector<std::uint32_t> call_sites_;
};

}  // namespace pmac::acr1000
