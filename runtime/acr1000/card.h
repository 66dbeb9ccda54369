// One card: an axis with its rates, relays, memory, and at most one move under way and one that waits for its start. What tells the
// card to move is its driver (card_driver.h); when moves start is the system's decision (card_system.h).
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "runtime/acr1000/card_driver.h"
#include "runtime/acr1000/card_memory.h"
#include "runtime/acr1000/move_block.h"
#include "runtime/acr1000/planned_move.h"

namespace pmac::acr1000 {

/// Set-up of one card; the card's documents leave the numbers open, so all are options.
struct CardConfig {
  std::string name = "X";
  std::int64_t start_pulses = 0;
  RateUnits units;
  int busy_relay = 96;               // reads 1 while a move is in progress
  int run_relay = -1;                // reads 1 while the stored program runs; -1: none
  std::map<int, bool> relays;        // at power-on
  bool wide_velocity = false;        // executive version 4.x: velocities of 24 bits
  std::size_t parameter_count = 50;
};

class Card {
 public:
  explicit Card(CardConfig config);
  Card(const Card&) = delete;
  Card& operator=(const Card&) = delete;

  const std::string& name() const { return config_.name; }
  const CardConfig& config() const { return config_; }
  CardMemory& memory() { return memory_; }
  const CardMemory& memory() const { return memory_; }
  RateSettings rates;

  /// P variables, those of the processor that drives the card once bound. P28 and P29 are what motion commands read.
  std::span<double> parameters() const { return parameters_; }
  void bind_parameters(std::span<double> parameters) { parameters_ = parameters; }
  std::int64_t parameter(std::size_t number) const { return number < parameters_.size() ? static_cast<std::int64_t>(parameters_[number]) : 0; }

  /// Acts like VEL, P28, P29 and the motion command of a fast move block. Refused: the reason (ACR-E12 and those of request()).
  std::optional<Finding> request(const MoveBlock& block, const Place& place);

  /// Relays that stand for the card's own state read that state; set or cleared, they keep it.
  bool relay(int number) const;
  void set_relay(int number, bool on);
  const std::map<int, bool>& relays() const { return relays_; }

  /// Takes a motion command. Refused: the reason, and nothing changes. Nothing may be waiting.
  std::optional<Finding> request(const MoveRequest& request);
  bool waits() const { return waiting_.has_value(); }
  const MoveRequest& waiting() const { return *waiting_; }
  void drop_waiting() { waiting_.reset(); }

  bool moves() const { return active_.has_value(); }
  /// Motion in progress or waiting to begin.
  bool busy() const { return moves() || waits(); }
  const PlannedMove& active() const { return *active_; }

  /// Begins what waits; answers what is odd about it. Nothing may be active.
  std::vector<Finding> begin(double time_s);
  /// Ends what is active, at its end.
  void end();
  /// Ends what is active where it is now.
  void stop_dead(double time_s);

  MotionPoint at(double time_s) const;
  /// As path_at() of the move; while nothing is active, where the axis stands.
  MotionPoint path_at(double time_s) const;
  std::int64_t commanded_pulses() const { return commanded_; }

  /// Speed at which the master was when the last move ended, for the next one that begins at once.
  double entry_speed_pulses_s(double time_s) const { return entry_at(time_s).master_speed_pulses_s; }

  std::unique_ptr<CardDriver> driver;

 private:
  MoveEntry entry_at(double time_s) const;

  CardConfig config_;
  CardMemory memory_;
  std::vector<double> own_parameters_;
  std::span<double> parameters_;
  std::map<int, bool> relays_;
  std::optional<MoveRequest> waiting_;
  std::optional<PlannedMove> active_;
  double position_ = 0;              // where the axis stands while nothing is active
  std::int64_t commanded_ = 0;       // end of the last move that was begun or is waiting
  std::optional<MoveEntry> carried_; // of the move that ended at ended_s_ while the next one waited
  double ended_s_ = 0;
};

}  // namespace pmac::acr1000
