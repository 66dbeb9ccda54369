// ACR1000 cards as pmac-run has them: each with its processor, what -e and --at send to it, and a file of fast move blocks behind it.
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <variant>

#include "runtime/acr1000/acr1000.h"
#include "runtime/acr1000/block_stream.h"
#include "runtime/acr1000/processor.h"

namespace pmac::tool {

/// A card's command line, compiled, or why it is refused.
using CardLineCompiler = std::function<std::variant<runtime::ProgramHandle, std::string>(const std::string& line)>;

/// Executes the script of the card's file first, then the lines that are sent, one after the other, then the stream.
class CardStation : public acr1000::CardDriver {
 public:
  CardStation(acr1000::Card& card, std::function<void(std::string_view)> print, CardLineCompiler compiler)
      : card_(card), print_(std::move(print)), compiler_(std::move(compiler)), processor_(card, print_) {}

  void start(runtime::ProgramHandle script) { processor_.start(std::move(script)); }
  /// A line of the host: executed after those before it; at once where the card waits for a motion to begin. Refused: the reason.
  std::optional<std::string> send(const std::string& line);
  void read_stream(acr1000::ByteSource source, acr1000::Place place);

  acr1000::DriverStep step(std::uint64_t command_budget) override;
  acr1000::Place place() const override { return streams_ ? stream_->place() : processor_.place(); }
  bool program_runs() const override { return processor_.program_runs(); }
  void halt() override { processor_.halt(); }
  void abandon() override;
  std::span<const double> parameters() const override { return card_.parameters(); }
  int nesting() const override { return processor_.nesting(); }
  std::uint64_t position() const override { return processor_.position(); }
  std::uint64_t outputs() const override { return processor_.outputs() + (stream_ ? stream_->outputs() : 0); }

 private:
  std::optional<acr1000::DriverFault> execute_streamed(const std::string& line);

  acr1000::Card& card_;
  std::function<void(std::string_view)> print_;
  CardLineCompiler compiler_;
  acr1000::CardProcessor processor_;
  std::deque<runtime::ProgramHandle> lines_;
  std::unique_ptr<acr1000::BlockStreamDriver> stream_;
  bool streams_ = false;    // the stream is what was stepped last
};

/// "contour.x.bin" -> "X": the axis that a file is for, or empty.
std::string axis_of_file(const std::string& name);

/// A file as a source of bytes, read in pieces; null where it cannot be opened.
acr1000::ByteSource open_stream(const std::string& name);

/// "X> SET 5" -> "X" and "SET 5"; no axis: for every card.
struct AddressedLine { std::string axis, line; };
AddressedLine split_address(const std::string& text);

/// HALT or HAL, in either case.
bool is_halt(const std::string& line);

}  // namespace pmac::tool
