// What a card is driven by: its language's processor, or a host that streams blocks. A driver acts on its card as it is stepped and
// takes no simulated time.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "runtime/acr1000/diagnostic.h"

namespace pmac::acr1000 {

enum class DriverStop : std::uint8_t {
  kWaits,      // a motion command has been taken and has to begin first
  kIdle,       // nothing left to do
  kFault,      // the program has stopped with an error
  kBudget,     // the budget is used up; step again
  kJumpedBack, // a program went back to an earlier line: a pass of a loop is over
};

/// The id and text of an error of the language come from the driver.
struct DriverFault { std::string id; std::string detail; Place place; };

struct DriverStep {
  DriverStop stop = DriverStop::kIdle;
  std::uint64_t commands = 0;
  std::optional<DriverFault> fault;
};

class CardDriver {
 public:
  virtual ~CardDriver() = default;
  /// Executes up to so many commands. Not called while the card waits.
  virtual DriverStep step(std::uint64_t command_budget) = 0;
  /// Of the command at work, the one that waits, or the last one.
  virtual Place place() const = 0;
  /// A stored program runs.
  virtual bool program_runs() const = 0;
  /// Stops the program and forgets a motion command that waits; what the host has still to send goes on.
  virtual void halt() = 0;
  /// Stops everything that it has still to do.
  virtual void abandon() = 0;
  /// Everything that the program's further way depends on, besides the card: parameters.
  virtual std::span<const double> parameters() const = 0;
  /// Depth of subroutines.
  virtual int nesting() const = 0;
  /// Tells places in the program apart, with the places that its subroutines will return to: equal where both are equal.
  virtual std::uint64_t position() const { return 0; }
  /// Grows with every output.
  virtual std::uint64_t outputs() const = 0;
};

}  // namespace pmac::acr1000
