#include "runtime/acr1000/card_system.h"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

namespace pmac::acr1000 {
namespace {

/// Simulated time of a pass of a loop that neither moves nor repeats itself [assumed].
constexpr double kPassS = 1e-3;
/// Commands of one card between looks at limits.
constexpr std::uint64_t kStepBudget = 10'000;
constexpr double kNever = std::numeric_limits<double>::infinity();

}  // namespace

Card& CardSystem::add(CardConfig config) {
  if (seats_.size() == kMaxCards) throw std::invalid_argument("a system has at most 16 cards");
  seats_.push_back({});
  seats_.back().card = std::make_unique<Card>(std::move(config));
  return *seats_.back().card;
}

SystemOutcome CardSystem::run(const SystemLimits& limits) {
  max_commands_ = limits.max_commands;
  interrupted_ = limits.interrupted;
  const double last_s = std::min(limits.max_s, limits.until_s);
  SystemEnd end = SystemEnd::kIdle;
  for (;;) {
    step_cards();
    if (commands_ >= max_commands_) { end = SystemEnd::kBudget; break; }
    if (is_interrupted()) { end = SystemEnd::kInterrupted; break; }
    if (begin_moves() || report_deadlocks()) continue;
    const double next_s = next_event_s();
    if (next_s == kNever && !limits.has_until) break;
    if (next_s > last_s) {
      go_to(last_s);
      end = limits.has_until && limits.until_s <= limits.max_s ? SystemEnd::kUntil : SystemEnd::kTimeLimit;
      break;
    }
    go_to(next_s);
    end_moves();
  }
  if (end == SystemEnd::kTimeLimit) explain_limit("the time limit");
  if (end == SystemEnd::kBudget) explain_limit("the limit of commands");
  for (std::size_t k = 0; k < seats_.size(); ++k)
    if (seats_[k].card->moves()) finish_move(seats_[k], k);
  return {end, time_s_, commands_};
}

void CardSystem::wake(std::size_t index) {
  Seat& seat = seats_[index];
  seat.watch.forget();
  seat.jumped_back_s = -1;
  seat.activity = Activity::kRuns;
}

void CardSystem::halt(std::size_t index) {
  Seat& seat = seats_[index];
  seat.card->driver->halt();
  seat.card->drop_waiting();
  wake(index);
}

void CardSystem::abandon(std::size_t index) {
  seats_[index].card->driver->abandon();
  seats_[index].card->drop_waiting();
  wake(index);
}

/// The card's driver stops for good; its move comes to its end.
void CardSystem::give_up(Seat& seat, std::string_view id, const Place& place) {
  seat.card->driver->abandon();
  seat.card->drop_waiting();
  seat.activity = Activity::kFailed;
  seat.failed_id = id;
  seat.failed_at = place;
}

// --- 1: programs ----------------------------------------------------------------------------------------------------------

void CardSystem::step_cards() {
  for (std::size_t k = 0; k < seats_.size(); ++k) {
    if (seats_[k].activity == Activity::kPauses && seats_[k].resume_s <= time_s_) seats_[k].activity = Activity::kRuns;
    while (seats_[k].activity == Activity::kRuns && !seats_[k].card->waits() && commands_ < max_commands_ && !is_interrupted()) step(k);
  }
}

void CardSystem::step(std::size_t index) {
  Seat& seat = seats_[index];
  const DriverStep step = seat.card->driver->step(std::min(kStepBudget, max_commands_ - commands_));
  commands_ += step.commands;
  switch (step.stop) {
    case DriverStop::kWaits: return seat.failed_id.clear();
    case DriverStop::kBudget: return;
    case DriverStop::kIdle: seat.activity = Activity::kIdle; return;
    case DriverStop::kJumpedBack: return jumped_back(seat);
    case DriverStop::kFault:
      seat.activity = Activity::kRuns;   // what the host sends next is still executed
      seat.failed_at = step.fault->place;
      seat.failed_id = step.fault->id;
      return note({index, step.fault->id, true, time_s_, step.fault->place, step.fault->detail});
  }
}

/// A pass in which time has gone on goes straight into the next one. Further passes at one instant take kPassS each; a program that
/// can only repeat itself is left alone until something happens to its card.
void CardSystem::jumped_back(Seat& seat) {
  const bool first_at_this_instant = seat.jumped_back_s < time_s_;
  seat.jumped_back_s = time_s_;
  if (seat.watch.repeats(state_of(seat))) {
    seat.activity = Activity::kLoops;
  } else if (!first_at_this_instant) {
    seat.activity = Activity::kPauses;
    seat.resume_s = time_s_ + kPassS;
  }
}

ProgramState CardSystem::state_of(const Seat& seat) const {
  const Card& card = *seat.card;
  const CardDriver& driver = *card.driver;
  const std::span<const double> parameters = driver.parameters();
  return {driver.place(), driver.position(), driver.nesting(), driver.outputs(), card.rates, {parameters.begin(), parameters.end()}, card.relays(), card.moves(), driver.program_runs()};
}

std::vector<std::size_t> CardSystem::endless_loops() const {
  std::vector<std::size_t> cards;
  for (std::size_t k = 0; k < seats_.size(); ++k)
    if (seats_[k].activity == Activity::kLoops) cards.push_back(k);
  return cards;
}

// --- 2: beginnings --------------------------------------------------------------------------------------------------------

bool CardSystem::begin_moves() {
  bool any = false;
  for (std::size_t k = 0; k < seats_.size(); ++k) {
    const Card& card = *seats_[k].card;
    if (!card.waits() || card.moves() || card.waiting().is_coordinated()) continue;
    begin(k, 0);
    any = true;
  }
  if (!all_at_barrier()) return any;
  ++coordinated_moves_;
  compare_cards();
  compare_circles();
  for (std::size_t k = 0; k < seats_.size(); ++k) begin(k, coordinated_moves_);
  return true;
}

bool CardSystem::all_at_barrier() const {
  return !seats_.empty() && std::all_of(seats_.begin(), seats_.end(), [](const Seat& seat) {
    return seat.card->waits() && seat.card->waiting().is_coordinated() && !seat.card->moves();
  });
}

void CardSystem::begin(std::size_t index, std::uint64_t coordinated) {
  Seat& seat = seats_[index];
  const std::vector<Finding> oddities = seat.card->begin(time_s_);
  seat.coordinated = coordinated;
  if (seat.card->active().profile.duration_s > 0) seat.watch.forget();
  for (const Finding& finding : oddities) report(index, finding, seat.card->active().request.place);
  if (observers_.begun) observers_.begun(seat.card->active(), index, coordinated);
  if (seat.card->active().profile.duration_s <= 0) finish_move(seat, index);
}

// --- 3: time --------------------------------------------------------------------------------------------------------------

double CardSystem::next_event_s() const {
  double next_s = timed_.empty() ? kNever : std::max(time_s_, timed_.begin()->first);
  for (const Seat& seat : seats_) {
    if (seat.card->moves()) next_s = std::min(next_s, seat.card->active().end_s());
    if (seat.activity == Activity::kPauses) next_s = std::min(next_s, seat.resume_s);
  }
  return next_s;
}

void CardSystem::go_to(double time_s) {
  if (time_s > time_s_ && observers_.stretch) observers_.stretch(time_s_, time_s);
  time_s_ = std::max(time_s_, time_s);
  while (!timed_.empty() && timed_.begin()->first <= time_s_) {
    const auto action = std::move(timed_.begin()->second);
    timed_.erase(timed_.begin());
    action();
  }
}

void CardSystem::end_moves() {
  for (std::size_t k = 0; k < seats_.size(); ++k) {
    Seat& seat = seats_[k];
    if (!seat.card->moves() || seat.card->active().end_s() > time_s_) continue;
    finish_move(seat, k);
    if (seat.activity == Activity::kLoops || seat.activity == Activity::kPauses) wake(k);
  }
}

void CardSystem::finish_move(Seat& seat, std::size_t index) {
  const PlannedMove& move = seat.card->active();
  if (observers_.move)
    observers_.move({index, move.request.place, move.law.is_circle, seat.card->memory().move_counter(), seat.coordinated, move.start_s,
                     std::min(move.end_s(), time_s_), move.own_length_pulses, move.profile.length_pulses, move.law.start_pulses,
                     move.end_s() <= time_s_ ? move.law.end_pulses : seat.card->at(time_s_).position_pulses,
                     move.profile.phase[0].start_speed_pulses_s, move.profile.exit_speed_pulses_s});
  if (move.end_s() > time_s_) return;
  if (move.profile.duration_s > 0) seat.watch.forget();
  seat.card->end();
}

// --- notices --------------------------------------------------------------------------------------------------------------

void CardSystem::note(CardNotice notice) {
  any_error_ = any_error_ || notice.is_error;
  if (observers_.notice) observers_.notice(notice);
}

void CardSystem::report(std::size_t card, const Finding& finding, const Place& place) {
  const DiagnosticRow& row = row_of(finding.id);
  note({card, std::string(row.id), row.is_error, time_s_, place, finding.detail});
}

void CardSystem::explain_limit(const char* what) {
  for (std::size_t k = 0; k < seats_.size(); ++k) {
    const Card& card = *seats_[k].card;
    if (card.waits() && !card.moves() && card.waiting().is_coordinated())
      report(k, {DiagnosticId::kLimitReached, fmt::format("{} is reached while the axis waits for the other cards to begin a coordinated move", what)}, card.waiting().place);
    else if (card.driver->program_runs() && seats_[k].activity != Activity::kLoops)
      report(k, {DiagnosticId::kLimitReached, fmt::format("{} is reached while the program runs", what)}, card.driver->place());
  }
}

}  // namespace pmac::acr1000
