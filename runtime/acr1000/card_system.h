// Up to 16 cards on one synchronisation cable, in simulated time. Commands take no time; what takes time is moves. The system
//
//   1 lets every card execute until it waits for a move to begin, ends, or only loops
//   2 begins moves: P28 = 0 by itself, P28 != 0 when every card of the system is ready for one (the cable is a barrier)
//   3 goes to the next instant at which something happens: a move ends, a timed command is due, a polling loop looks again
//
// and ends when nothing can happen any more. A card that waits at the barrier for a card that will never come is an error that
// names both (ACR-E13), so nothing hangs. Source: ACR1000 manual, chapter 8.
#pragma once

#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "runtime/acr1000/card.h"
#include "runtime/acr1000/loop_watch.h"

namespace pmac::acr1000 {

inline constexpr std::size_t kMaxCards = 16;

/// A move that is over, or was under way at the end of the run.
struct CardMoveRecord {
  std::size_t card = 0;
  Place place;
  bool is_circle = false;
  std::uint32_t counter = 0;              // the card's move counter while it ran
  std::uint64_t coordinated = 0;          // 1, 2, ... of the system's coordinated moves; 0: moved by itself
  double start_s = 0, end_s = 0;
  double length_pulses = 0;               // of the axis' own way
  double master_pulses = 0;               // length of the master
  double from_pulses = 0, to_pulses = 0;
  double entry_speed_pulses_s = 0, exit_speed_pulses_s = 0;  // of the master
};

struct CardNotice {
  std::size_t card = 0;
  std::string id;                         // "ACR-E13"
  bool is_error = false;
  double time_s = 0;
  Place place;
  std::string text;
};

struct SystemObservers {
  std::function<void(const PlannedMove&, std::size_t card, std::uint64_t coordinated)> begun;
  std::function<void(const CardMoveRecord&)> move;
  std::function<void(const CardNotice&)> notice;
  /// Time will go from one instant to the other without anything beginning or ending in between. Card::at() holds for all of it.
  std::function<void(double from_s, double to_s)> stretch;
};

struct SystemLimits {
  double until_s = std::numeric_limits<double>::infinity();  // go on to here, even where nothing happens any more
  bool has_until = false;
  double max_s = 3600;
  std::uint64_t max_commands = 20'000'000'000;
  std::function<bool()> interrupted;
};

enum class SystemEnd : std::uint8_t { kIdle, kUntil, kTimeLimit, kBudget, kInterrupted };

struct SystemOutcome {
  SystemEnd end = SystemEnd::kIdle;
  double time_s = 0;
  std::uint64_t commands = 0;
};

class CardSystem {
 public:
  explicit CardSystem(SystemObservers observers) : observers_(std::move(observers)) {}

  /// At most kMaxCards, each with its driver set before run().
  Card& add(CardConfig config);
  std::size_t size() const { return seats_.size(); }
  Card& card(std::size_t index) { return *seats_[index].card; }
  const Card& card(std::size_t index) const { return *seats_[index].card; }

  /// What a host does at a simulated second, in order of time. Cards that it touches are awake afterwards.
  void at(double time_s, std::function<void()> action) { timed_.emplace(time_s, std::move(action)); }

  /// The card looks again whether there is something to do: its driver, parameters or relays were changed from outside.
  void wake(std::size_t card);
  /// Stops a card's program; its move comes to its end, what waits is dropped.
  void halt(std::size_t card);
  /// Stops everything that the card has still to do, its program and what its host has still to send; its move comes to its end.
  void abandon(std::size_t card);

  SystemOutcome run(const SystemLimits& limits);
  double time_s() const { return time_s_; }
  bool any_error() const { return any_error_; }

  void report(std::size_t card, const Finding& finding, const Place& place);

  /// The cards that only loop and cannot do anything else any more.
  std::vector<std::size_t> endless_loops() const;

 private:
  enum class Activity : std::uint8_t { kRuns, kPauses, kLoops, kIdle, kFailed };
  struct Seat {
    std::unique_ptr<Card> card;
    Activity activity = Activity::kRuns;
    LoopWatch watch;
    double jumped_back_s = -1;            // when its program went back last
    double resume_s = 0;                  // of kPauses
    std::uint64_t coordinated = 0;        // index of its active move
    Place failed_at;
    std::string failed_id;
  };

  void step_cards();
  void step(std::size_t index);
  void jumped_back(Seat& seat);
  bool begin_moves();
  void begin(std::size_t index, std::uint64_t coordinated);
  bool all_at_barrier() const;
  void compare_cards();
  void compare_circles();
  bool report_deadlocks();
  std::string reason_not_to_come(const Seat& seat) const;
  double next_event_s() const;
  void go_to(double time_s);
  void end_moves();
  void finish_move(Seat& seat, std::size_t index);
  void give_up(Seat& seat, std::string_view id, const Place& place);
  void note(CardNotice notice);
  void explain_limit(const char* what);
  ProgramState state_of(const Seat& seat) const;
  bool is_interrupted() const { return interrupted_ && interrupted_(); }
  bool is_over(const Seat& seat) const { return seat.activity == Activity::kIdle || seat.activity == Activity::kFailed || seat.activity == Activity::kLoops; }

  SystemObservers observers_;
  std::vector<Seat> seats_;
  std::multimap<double, std::function<void()>> timed_;
  double time_s_ = 0;
  std::uint64_t coordinated_moves_ = 0;
  std::uint64_t commands_ = 0, max_commands_ = 0;
  std::function<bool()> interrupted_;
  bool any_error_ = false;
};

}  // namespace pmac::acr1000
