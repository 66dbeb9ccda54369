// The processor of a card: executes what its host sends, line by line, and the stored program. A command line and the program are a
// thread each; the line goes first, and one that has started the program waits for its end. Commands take no simulated time.
#pragma once

#include <functional>
#include <string_view>
#include <vector>

#include "runtime/acr1000/card_driver.h"
#include "runtime/acr1000/card_host.h"

namespace pmac::acr1000 {

class CardProcessor : public CardDriver {
 public:
  /// print: what the card sends to its host, with CR LF. memory: where the program is kept while it is typed, or null; both outlive this.
  CardProcessor(Card& card, std::function<void(std::string_view)> print, ProgramMemory* memory = nullptr);

  /// A command line, or the script of a file: executed from its beginning. A line that waits for the program's end is given up for it.
  void start(runtime::ProgramHandle commands);
  /// A command line at once, while the program waits for its motion to begin. A motion command, RUN or NEW in it is refused.
  std::optional<DriverFault> execute_now(runtime::ProgramHandle commands);
  /// A command line is not done yet, other than waiting for the program's end.
  bool executes_line() const { return line_.active() && !line_waits_; }

  DriverStep step(std::uint64_t command_budget) override;
  Place place() const override { return host_.place; }
  bool program_runs() const override { return program_.active(); }
  void halt() override;
  void abandon() override;
  std::span<const double> parameters() const override { return card_.parameters(); }
  int nesting() const override { return static_cast<int>(program_.call_depth()); }
  std::uint64_t position() const override;
  std::uint64_t outputs() const override { return host_.outputs(); }

 private:
  bool answer_peek();
  bool obey(bool from_program);
  void end_program();
  DriverStep fail(const runtime::RunResult& result, std::uint64_t commands, bool in_program);

  Card& card_;
  std::vector<double> p_, q_;
  CardHost host_;
  runtime::Thread line_, program_, aside_;
  bool line_waits_ = false;             // for the end of the program
};

}  // namespace pmac::acr1000
