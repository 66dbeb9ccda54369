#include "runtime/free_run.h"

#include <algorithm>
#include <vector>

#include "runtime/interruption.h"
#include "runtime/motor_moves.h"
#include "runtime/servo/servo_cycle.h"
#include "runtime/trace.h"

namespace pmac::runtime {
namespace {

constexpr int kLeftOutTicks = 256;   // most servo samples that wait

double left_out_ms(const Machine::State& s) { return (kLeftOutTicks + 2) * s.period_ms(); }

/// Between its services nothing happens to the motor but samples.
bool is_quiet(const Motor& m) {
  return m.source != Motor::Source::kProfile && next_motor_event_ms(m) == kNever && !m.seeks_trigger() && !m.kill_at_rest && !m.jogging;
}

bool is_watched_from_outside(const Machine::State& s) {
  const bool asks = std::any_of(s.sinks.begin(), s.sinks.end(), [](const SampleSink* sink) { return !sink->takes_late(); });
  return asks || s.gather.enabled() || (s.tracer && s.tracer->open());
}

bool waits_for_anything(const Machine::State& s) {
  const bool scans = std::any_of(s.plcs.begin(), s.plcs.end(), [](const Plc& plc) { return plc.running; });
  return scans || !s.queued.empty() || !s.trips.empty() || s.pending_reset != Machine::State::Reset::kNone;
}

bool motors_are_ideal(const Machine::State& s) {
  if (!std::all_of(s.motors.begin(), s.motors.end(), is_quiet)) return false;
  std::vector<int> used;
  for (const Motor& m : s.motors)
    if (m.in_use) used.push_back(m.number);
  return !any_watched(s, used);
}

/// The coordinate systems that calculate on while all others sleep; none where one of them does anything else, or has routines that could.
std::vector<CoordSystem*> running_along(const Machine::State& s) {
  std::vector<CoordSystem*> running;
  for (const auto& c : s.coords) {
    if (c->inverse || c->has_forward()) return {};
    if (c->sleeps()) continue;
    if (!c->runs_along() || !c->may_pass_samples(left_out_ms(s))) return {};
    running.push_back(c.get());
  }
  return running;
}

double next_event_ms(const std::vector<CoordSystem*>& running) {
  double next = kNever;
  for (const CoordSystem* c : running) next = std::min(next, c->next_event_ms());
  return next;
}

/// The last servo tick up to now.
double last_tick_ms(const Machine::State& s) {
  std::int64_t tick = s.tick + static_cast<std::int64_t>((s.now_ms - s.tick_ms(s.tick)) / s.period_ms());
  while (s.tick_ms(tick) > s.now_ms) --tick;
  while (s.tick_ms(tick + 1) <= s.now_ms) ++tick;
  return s.tick_ms(tick);
}

/// One event. False where something has caught up, so that the rest of the machine had to be serviced as well.
bool service_event(Machine::State& s, const std::vector<CoordSystem*>& running) {
  const double tick_ms = last_tick_ms(s);
  for (CoordSystem* c : running) {
    c->pass_samples(tick_ms);
    c->service(s.now_ms);
    if (s.runs_free) continue;
    s.service_from(c->number() + 1, s.now_ms);
    return false;
  }
  return std::all_of(running.begin(), running.end(), [](const CoordSystem* c) { return c->runs_along(); });
}

/// The samples up to now_ms = next_ms where there is a block of them. False: interrupted before.
bool pass_to(Machine::State& s, double next_ms) {
  const bool block_is_full = s.tick_ms(s.tick + kLeftOutTicks) <= next_ms;
  s.now_ms = block_is_full ? s.sample_to(next_ms) : next_ms;
  return s.now_ms >= next_ms;
}

/// As the loop of run_free() while one coordinate system alone runs along plain lines, which it has begun.
std::uint64_t run_lines(Machine::State& s, CoordSystem& running, double limit_ms, std::uint64_t event) {
  while (s.instructions <= s.options.max_instructions && !interruption_wanted()) {
    const double next_ms = std::max(s.now_ms, running.next_lines_ms());
    if (!(next_ms < limit_ms) || !pass_to(s, next_ms)) break;
    running.pass_samples(last_tick_ms(s));
    if (!running.service_lines(s.now_ms) || ++event % kEventsPerLook == 0) break;
  }
  running.end_lines();
  return event;
}

}  // namespace

void Machine::State::end_free_run() {
  runs_free = false;
  sample_to(now_ms);
}

std::uint64_t run_free(Machine::State& s, double limit_ms, std::uint64_t event) {
  if (!s.options.free_runs || waits_for_anything(s)) return event;
  const std::vector<CoordSystem*> running = running_along(s);
  if (running.empty() || is_watched_from_outside(s) || !motors_are_ideal(s)) return event;
  if (!s.timed.empty()) limit_ms = std::min(limit_ms, s.timed.front().time_ms);
  s.runs_free = s.programs_execute = true;
  s.update_idle(s.now_ms);
  for (bool goes_on = true; goes_on && s.instructions <= s.options.max_instructions && !interruption_wanted();) {
    const double next_ms = std::max(s.now_ms, next_event_ms(running));
    if (!(next_ms < limit_ms)) break;
    if (running.size() == 1 && running[0]->begin_lines()) {
      event = run_lines(s, *running[0], limit_ms, event);
      goes_on = event % kEventsPerLook != 0;
      continue;
    }
    if (!pass_to(s, next_ms)) break;
    goes_on = service_event(s, running);
    goes_on = ++event % kEventsPerLook != 0 && goes_on;
  }
  s.programs_execute = false;
  s.catch_up();
  return event;
}

}  // namespace pmac::runtime
