// The synchronisation cable: what cards should agree on when they begin a coordinated move together, and which of them wait for nothing.
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include <fmt/format.h>

#include "runtime/acr1000/card_system.h"

namespace pmac::acr1000 {
namespace {

struct Shared { const char* name; std::int64_t value; };

/// What has to be equal on all cards of a coordinated move.
std::vector<Shared> shared_of(const MoveRequest& request) {
  const RateSettings& r = request.rates;
  return {{"P28", request.master_length}, {"VEL", r.vel}, {"ACC", r.acc}, {"DEC", r.dec}, {"STP", r.stp}};
}

/// Equal turn, radius and arc: two cards that could make a circle together.
bool turn_alike(const CircleArguments& a, const CircleArguments& b) { return a.rot == b.rot && a.radius == b.radius && a.distance == b.distance; }

/// Rounding of whole pulses lets I and J of two cards differ so much [assumed].
bool nearly(std::int64_t a, std::int64_t b) { return std::abs(static_cast<double>(a) - static_cast<double>(b)) <= kRadiusTolerancePulses; }

/// YI = XJ and YJ = -XI.
bool are_x_and_y(const CircleArguments& x, const CircleArguments& y) { return nearly(y.i, x.j) && nearly(y.j, -x.i); }
bool make_circle(const CircleArguments& a, const CircleArguments& b) { return are_x_and_y(a, b) || are_x_and_y(b, a); }

}  // namespace

/// ACR-W04, once for each thing that differs, against the first card.
void CardSystem::compare_cards() {
  const std::vector<Shared> first = shared_of(seats_[0].card->waiting());
  for (std::size_t k = 1; k < seats_.size(); ++k) {
    const std::vector<Shared> other = shared_of(seats_[k].card->waiting());
    for (std::size_t n = 0; n < first.size(); ++n)
      if (first[n].value != other[n].value)
        report(k, {DiagnosticId::kCardsDiffer, fmt::format("coordinated move {}: {} is {} on axis {} and {} on axis {}; each card keeps its own time, and the next move waits for the slowest",
                                                           coordinated_moves_, first[n].name, first[n].value, seats_[0].card->name(), other[n].value, seats_[k].card->name())},
               seats_[k].card->waiting().place);
  }
}

/// ACR-W09 for a card whose CIRCLE has companions of the same turn but none a quarter turn from it.
void CardSystem::compare_circles() {
  for (std::size_t k = 1; k < seats_.size(); ++k) {
    const MoveRequest& own = seats_[k].card->waiting();
    if (own.kind != MoveKind::kCircle) continue;
    const Card* companion = nullptr;
    bool fits = false;
    for (std::size_t n = 0; n < seats_.size(); ++n) {
      const MoveRequest& other = seats_[n].card->waiting();
      if (n == k || other.kind != MoveKind::kCircle || !turn_alike(own.circle, other.circle)) continue;
      if (companion == nullptr) companion = seats_[n].card.get();
      fits = fits || make_circle(own.circle, other.circle);
    }
    if (companion == nullptr || fits) continue;
    const CircleArguments& other = companion->waiting().circle;
    report(k, {DiagnosticId::kNoCircle, fmt::format("axes {} and {} turn alike but draw no circle: I,J are {},{} and {},{}; YI = XJ and YJ = -XI do",
                                                    companion->name(), seats_[k].card->name(), other.i, other.j, own.circle.i, own.circle.j)},
           own.place);
  }
}

std::string CardSystem::reason_not_to_come(const Seat& seat) const {
  const std::string place = text_of(seat.card->driver->place());
  switch (seat.activity) {
    case Activity::kLoops: return fmt::format("axis {} loops at {} without a motion command", seat.card->name(), place);
    default: break;
  }
  if (!seat.failed_id.empty()) return fmt::format("axis {} was stopped by {} at {}", seat.card->name(), seat.failed_id, text_of(seat.failed_at));
  return seat.card->memory().move_counter() == 0 ? fmt::format("axis {} has ended without a move", seat.card->name())
                                                 : fmt::format("axis {} has ended (last at {})", seat.card->name(), place);
}

/// A card at the barrier while another one will never come to it: its program stops with ACR-E13. True: any was found.
bool CardSystem::report_deadlocks() {
  if (!timed_.empty()) return false;   // a timed command may still bring it there
  std::string absent;
  for (const Seat& seat : seats_) {
    const bool will_change = seat.card->waits() || (seat.card->moves() && seat.activity == Activity::kLoops) || !is_over(seat);
    if (!will_change) absent += (absent.empty() ? "" : "; ") + reason_not_to_come(seat);
  }
  if (absent.empty()) return false;
  bool any = false;
  for (std::size_t k = 0; k < seats_.size(); ++k) {
    const Card& card = *seats_[k].card;
    if (!card.waits() || card.moves() || !card.waiting().is_coordinated()) continue;
    const Place place = card.waiting().place;
    report(k, {DiagnosticId::kDeadlock, fmt::format("axis {} waits at {} for coordinated move {}, which never begins: {}. Give every card as many moves with P28 set, or set P28 = 0 on all",
                                                    card.name(), text_of(place), coordinated_moves_ + 1, absent)},
           place);
    give_up(seats_[k], row_of(DiagnosticId::kDeadlock).id, place);
    any = true;
  }
  return any;
}

}  // namespace pmac::acr1000
