// Drives a card by a list of steps, as a program would.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "runtime/acr1000/card_system.h"

namespace pmac::acr1000 {

/// A step acts on the card and says how the driver goes on; `next` may be set to go to another step.
struct ScriptedDriver : CardDriver {
  using Step = std::function<DriverStop(ScriptedDriver&)>;
  ScriptedDriver(Card& c, std::vector<Step> s) : card(c), steps(std::move(s)) {}

  DriverStep step(std::uint64_t) override {
    if (next >= steps.size()) return {DriverStop::kIdle, 0, {}};
    at = next++;
    const DriverStop stop = steps[at](*this);
    return {stop, 1, stop == DriverStop::kFault ? std::optional(fault) : std::nullopt};
  }
  Place place() const override { return {{}, static_cast<int>(10 * (at + 1))}; }
  bool program_runs() const override { return next < steps.size(); }
  void halt() override { next = steps.size(); }
  void abandon() override { next = steps.size(); }
  std::span<const double> parameters() const override { return values; }
  int nesting() const override { return 0; }
  std::uint64_t outputs() const override { return 0; }

  /// A motion command; its refusal is a fault of the program.
  DriverStop move(MoveRequest request) {
    request.rates = card.rates;
    request.place = place();
    if (const auto refusal = card.request(request)) {
      fault = {std::string(row_of(refusal->id).id), refusal->detail, place()};
      next = steps.size();
      return DriverStop::kFault;
    }
    return DriverStop::kWaits;
  }

  Card& card;
  std::vector<Step> steps;
  std::size_t at = 0, next = 0;
  std::vector<double> values;
  DriverFault fault;
};

inline ScriptedDriver::Step rates(RateSettings settings) {
  return [=](ScriptedDriver& d) { d.card.rates = settings; return DriverStop::kBudget; };
}
inline ScriptedDriver::Step mov(std::int64_t p28, std::int64_t target) {
  return [=](ScriptedDriver& d) {
    MoveRequest request;
    request.distance = target;
    request.master_length = p28;
    return d.move(request);
  };
}
inline ScriptedDriver::Step circle(std::int64_t p28, std::int64_t p29, CircleArguments arguments) {
  return [=](ScriptedDriver& d) {
    MoveRequest request;
    request.kind = MoveKind::kCircle;
    request.circle = arguments;
    request.end_point = p29;
    request.master_length = p28;
    return d.move(request);
  };
}
/// GOTO line, a step counted from 0.
inline ScriptedDriver::Step go_to(std::size_t line) {
  return [=](ScriptedDriver& d) { d.next = line; return line <= d.at ? DriverStop::kJumpedBack : DriverStop::kBudget; };
}
/// IF relay THEN line.
inline ScriptedDriver::Step if_relay(int relay, std::size_t line) {
  return [=](ScriptedDriver& d) {
    if (!d.card.relay(relay)) return DriverStop::kBudget;
    d.next = line;
    return line <= d.at ? DriverStop::kJumpedBack : DriverStop::kBudget;
  };
}

/// A system that remembers what it reports.
struct Scene {
  std::vector<CardMoveRecord> moves;
  std::vector<CardNotice> notices;
  CardSystem system{{{}, [this](const CardMoveRecord& move) { moves.push_back(move); }, [this](const CardNotice& notice) { notices.push_back(notice); }, {}}};

  Card& add(const std::string& name, std::vector<ScriptedDriver::Step> steps, CardConfig config = {}) {
    config.name = name;
    Card& card = system.add(config);
    card.driver = std::make_unique<ScriptedDriver>(card, std::move(steps));
    return card;
  }
  SystemOutcome run(SystemLimits limits = {}) { return system.run(limits); }
  std::string ids() const {
    std::string text;
    for (const CardNotice& notice : notices) text += (text.empty() ? "" : " ") + notice.id;
    return text;
  }
};

}  // namespace pmac::acr1000
