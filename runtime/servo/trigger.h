// What a home search or a move until a trigger waits for: a place (Sim.Motor[].TriggerPos), or a flag that is on from Sim.Motor[].FlagPos
// to FlagEnd, of which the on side counts, or with FlagInvert the off side. Positions are raw: motor units from power-on.
#pragma once

#include <limits>
#include <optional>

#include "compiler/bytecode/element.h"
#include "runtime/element_store.h"

namespace pmac::runtime {

struct Trigger {
  double from_mu = 0, to_mu = 0;     // equal: a place
  bool inverted = false;

  bool is_place() const { return from_mu == to_mu; }
  /// The input that stops the search is there.
  bool active(double raw_mu) const { return (raw_mu >= from_mu && raw_mu <= to_mu) != inverted; }
  /// Where the way from one position to another one first meets it; none: it does not.
  std::optional<double> met_between(double before_mu, double after_mu) const {
    if (active(before_mu)) return before_mu;
    const auto lies_between = [&](double edge) { return before_mu < after_mu ? edge > before_mu && edge <= after_mu : edge < before_mu && edge >= after_mu; };
    const bool from = lies_between(from_mu), to = lies_between(to_mu);
    if (from && to) return before_mu < after_mu ? from_mu : to_mu;
    if (from) return from_mu;
    return to ? std::optional(to_mu) : active(after_mu) ? std::optional(after_mu) : std::nullopt;
  }
};

/// None: the motor has none.
inline std::optional<Trigger> trigger_of(const ElementStore& e, int motor) {
  using bytecode::ElementId;
  const auto n = static_cast<unsigned>(motor);
  const bool inverted = e.get(ElementId::kSimMotorFlagInvert, n) != 0;
  if (e.assigned(ElementId::kSimMotorTriggerPos, n)) {
    const double place_mu = e.get(ElementId::kSimMotorTriggerPos, n);
    return Trigger{place_mu, place_mu, false};
  }
  if (!e.assigned(ElementId::kSimMotorFlagPos, n)) return std::nullopt;
  const double end_mu = e.assigned(ElementId::kSimMotorFlagEnd, n) ? e.get(ElementId::kSimMotorFlagEnd, n) : std::numeric_limits<double>::infinity();
  return Trigger{e.get(ElementId::kSimMotorFlagPos, n), end_mu, inverted};
}

}  // namespace pmac::runtime
