// pmac-run --console --dialect=acr1000: one card, typed at. Command mode and program mode over the card's line store, fast move blocks and
// ctrl-L; answers are the bytes that the card sends. docs/acr1000_language.md describes it.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/compiler.h"
#include "runtime/acr1000/card_system.h"
#include "runtime/acr1000/port.h"
#include "runtime/acr1000/processor.h"

namespace pmac::tool {

struct CardConsoleOptions {
  std::vector<std::string> settings;   // KEY=VALUE of the system
  double step_s = 0.01;                // simulated time that passes after a line
  double max_time_s = 3600;
};

/// A card with what it keeps between lines. Bytes in, bytes out; nothing that comes in can stop it.
class CardConsole : private acr1000::ProgramMemory {
 public:
  /// send: what the card answers.
  CardConsole(CardConsoleOptions options, std::function<void(std::string_view)> send);
  ~CardConsole();

  /// False: the time limit is reached, and the console is over.
  bool receive(std::span<const std::uint8_t> bytes) { return perform(port_.receive(bytes)); }
  /// The host pauses, or is gone: what is not complete is given up.
  bool pause() { return perform(port_.pause()); }
  bool in_block() const { return port_.in_block(); }

  double time_s() const { return system_->time_s(); }
  std::uint64_t errors() const { return errors_; }

 private:
  using Program = runtime::ProgramHandle;

  Program program() override;
  std::string listing() override;
  void erase() override;
  std::string renumber() override;

  bool perform(const std::vector<acr1000::PortEvent>& events);
  bool perform(const acr1000::PortEvent& event);
  bool line(const std::string& text);
  bool command(const std::string& text);
  bool block(const acr1000::MoveBlock& block);
  bool hex_line(const std::string& text);
  bool wait_line(const std::string& text, bool& going);
  void store(const std::string& text);
  bool pass(double time_s);
  bool settle();
  void answer_error(std::string_view id, std::string_view text);
  void tell(compiler::Session& session);
  compiler::Session new_session() const;

  CardConsoleOptions options_;
  std::function<void(std::string_view)> send_;
  std::unique_ptr<acr1000::CardSystem> system_;
  acr1000::Card* card_ = nullptr;
  acr1000::CardProcessor* processor_ = nullptr;
  acr1000::Port port_;
  std::map<std::int64_t, std::string> lines_;
  Program compiled_;                   // of lines_, until they change
  bool changed_ = true;
  std::uint64_t errors_ = 0;
};

/// Standard input to standard output until its end. Answers the exit code.
int run_card_console(const CardConsoleOptions& options);

}  // namespace pmac::tool
