// Simulated time: from event to event, with runs of servo samples between. At one instant the order is: servo samples, synchronous
// assignments and programs of the coordinate systems, commands given for this time, foreground PLCs, background PLCs.
#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "compiler/bytecode/element.h"
#include "runtime/free_run.h"
#include "runtime/interruption.h"
#include "runtime/motor_faults.h"
#include "runtime/motor_moves.h"
#include "runtime/servo/servo_cycle.h"
#include "runtime/state.h"

namespace pmac::runtime {
namespace {

using bytecode::ElementId;

constexpr int kBlockTicks = 256;                 // samples of one block
constexpr std::uint64_t kPlcBudget = 1'000'000;  // instructions of one scan
constexpr double kDefaultBackgroundMs = 1.0;
constexpr double kProgressMs = 1000.0;

double background_period_ms(const Machine::State& s) {
  const double sleep_us = s.elements.get(ElementId::kSysBgSleepTime);
  return std::max(sleep_us / 1000.0, kDefaultBackgroundMs);
}

/// Rows of `wide` values become rows of `narrow`.
void shorten_rows(std::vector<double>& rows, std::size_t count, std::size_t wide, std::size_t narrow) {
  for (std::size_t u = 1; u < count; ++u)
    std::copy_n(rows.begin() + static_cast<std::ptrdiff_t>(u * wide), narrow, rows.begin() + static_cast<std::ptrdiff_t>(u * narrow));
}

/// Servo ticks after the last sampled one up to time_ms, where there is one; at most `most` of them.
int ticks_up_to(const Machine::State& s, double time_ms, int most) {
  auto count = static_cast<int>(std::clamp((time_ms - s.tick_ms(s.tick)) / s.period_ms(), 1.0, static_cast<double>(most)));
  while (count > 1 && s.tick_ms(s.tick + count) > time_ms) --count;
  while (count < most && s.tick_ms(s.tick + count + 1) <= time_ms) ++count;
  return count;
}

/// Nobody looks at the samples up to the last two before time_ms: only where the motors are then, and how fast, counts.
std::int64_t tick_before_seen(const Machine::State& s, double time_ms) {
  const bool seen = !s.sinks.empty() || s.gather.enabled() || any_watched(s, s.block_motors);
  auto last = static_cast<std::int64_t>(std::floor(time_ms / s.period_ms())) + 1;
  while (s.tick_ms(last) > time_ms) --last;
  return seen ? s.tick : std::max(s.tick, last - 2);
}

bool is_foreground(const Machine::State& s, int plc) { return plc <= s.elements.get(ElementId::kSysMaxRtPlc); }

/// Simulated time until something of RunEnd.
RunEnd run_events(Machine::State& s, const RunLimits& limits) {
  const double stop_ms = std::min(limits.until_ms.value_or(limits.max_ms), limits.max_ms);
  double next_progress_ms = kProgressMs;
  s.sample_to(s.now_ms);
  for (std::uint64_t event = 0;; ++event) {
    s.service(s.now_ms);
    event = run_free(s, std::min(stop_ms, next_progress_ms), event);
    s.update_idle(s.now_ms);
    const double idle_end_ms = s.is_idle && !limits.until_ms ? s.idle_since_ms + limits.idle_ms : kNever;
    if (s.now_ms >= idle_end_ms) return RunEnd::kIdle;
    if (s.now_ms >= stop_ms) return limits.until_ms && *limits.until_ms <= limits.max_ms ? RunEnd::kUntil : RunEnd::kTimeLimit;
    if (s.instructions > s.options.max_instructions) return RunEnd::kBudget;
    if (interruption_wanted()) return RunEnd::kInterrupted;
    if (limits.over_budget && event % kEventsPerLook == 0 && limits.over_budget()) return RunEnd::kBudget;
    if (s.now_ms >= next_progress_ms) {
      if (s.options.observers.progress) s.options.observers.progress(s.now_ms);
      next_progress_ms = s.now_ms + kProgressMs;
    }
    s.now_ms = s.sample_to(s.next_event_ms(std::min({stop_ms, idle_end_ms, next_progress_ms})));
  }
}

}  // namespace

double Machine::State::next_rti_ms(double time_ms) const {
  if (time_ms == rti_asked_ms && rti_cycles == rti_asked_cycles) return rti_answer_ms;
  const std::int64_t every = rti_cycles;
  auto n = static_cast<std::int64_t>(time_ms / rti_period_ms());   // at most one too high, by rounding; then it is the answer
  while (tick_ms(n * every) <= time_ms) ++n;
  rti_asked_ms = time_ms;
  rti_asked_cycles = rti_cycles;
  return rti_answer_ms = tick_ms(n * every);
}

double Machine::State::rti_at_or_after_ms(double time_ms) const {
  const std::int64_t every = rti_cycles;
  auto n = static_cast<std::int64_t>(time_ms / rti_period_ms());
  while (tick_ms(n * every) < time_ms) ++n;
  return tick_ms(n * every);
}

/// A program that is paused, held or at 0 % waits for a command; it keeps the run alive while a PLC program may give one.
bool Machine::State::anything_runs() const {
  const auto proceeds = [this](const auto& c) { return c->proceeding(now_ms); };
  const auto moves = [this](const Motor& m) { return (m.source == Motor::Source::kProfile && !(m.clock && m.clock->stands(now_ms))) || m.kill_ms < kNever; };
  if (!timed.empty() || std::any_of(coords.begin(), coords.end(), proceeds) || std::any_of(motors.begin(), motors.end(), moves)) return true;
  const bool waits = std::any_of(coords.begin(), coords.end(), [](const auto& c) { return c->program_active(); }) ||
                     std::any_of(motors.begin(), motors.end(), [](const Motor& m) { return m.moving(); });
  return waits && std::any_of(plcs.begin(), plcs.end(), [](const Plc& plc) { return plc.running; });
}

void Machine::State::update_idle(double time_ms) {
  const bool idle = !anything_runs();
  if (idle && !is_idle) idle_since_ms = time_ms;
  is_idle = idle;
}

double Machine::State::next_event_ms(double limit_ms) {
  double next = limit_ms;
  for (const auto& c : coords) next = std::min(next, c->next_event_ms());
  for (const Motor& m : motors) next = std::min(next, next_motor_event_ms(m));
  if (!timed.empty()) next = std::min(next, timed.front().time_ms);
  bool foreground = false, background = false;
  for (const Plc& plc : plcs) {
    if (!plc.running) continue;
    (is_foreground(*this, plc.runner->number) ? foreground : background) = true;
  }
  if (foreground) next = std::min(next, next_rti_ms(now_ms));
  if (background) next = std::min(next, last_background_ms + background_period_ms(*this));
  return std::max(next, now_ms);
}

/// Commanded positions of block_motors at block_times, into block_rows.
void Machine::State::command_rows() {
  const std::size_t n = block_times.size();
  for (std::size_t u = 0; u < block_motors.size(); ++u) {
    const Motor& m = motors[static_cast<std::size_t>(block_motors[u])];
    double* row = block_rows.data() + u * n;
    if (m.source != Motor::Source::kProfile) std::fill_n(row, n, m.position_mu);   // of those on a path what comes below stays
    else std::transform(block_times.begin(), block_times.end(), row, [&m](double t) { return m.position_at(t); });
  }
  for (const auto& c : coords) {
    if (!c->on_path()) continue;
    const std::vector<int>& path_motors = c->path_motors();
    if (path_motors == block_motors) {
      c->sample(block_times, std::span<double>(block_rows.data(), path_motors.size() * n));
      continue;
    }
    c->sample(block_times, std::span<double>(block_path.data(), path_motors.size() * n));
    for (std::size_t i = 0; i < path_motors.size(); ++i) {
      const auto at = static_cast<std::size_t>(std::find(block_motors.begin(), block_motors.end(), path_motors[i]) - block_motors.begin());
      std::copy_n(block_path.begin() + static_cast<std::ptrdiff_t>(i * n), n, block_rows.begin() + static_cast<std::ptrdiff_t>(at * n));
    }
  }
}

/// The servos follow block_rows; answers how many interrupts count, to which the rows are shortened. actual: block_rows or block_actual.
int Machine::State::follow_rows(std::vector<double>& actual) {
  const auto count = static_cast<int>(block_times.size());
  const int reached = run_servos(*this, block_motors, count, block_rows, actual);
  if (reached < count) {
    shorten_rows(block_rows, block_motors.size(), static_cast<std::size_t>(count), static_cast<std::size_t>(reached));
    if (&actual != &block_rows) shorten_rows(actual, block_motors.size(), static_cast<std::size_t>(count), static_cast<std::size_t>(reached));
  }
  for (const auto& c : coords)
    if (c->on_path()) c->follow_samples(block_times, reached, block_motors, block_rows);
  return reached;
}

void Machine::State::deliver(const SampleBlock& block) {
  for (SampleSink* sink : sinks) sink->take(block);
  if (gather.enabled())
    gather.take(block, static_cast<int>(elements.get(ElementId::kGatherPeriod)),
                static_cast<std::int64_t>(elements.get(ElementId::kGatherMaxSamples)),
                [this](const ElementAddress& a) { return read_element_value(*this, *online, a); });
}

double Machine::State::sample_to(double time_ms) {
  if (tick_ms(tick + 1) > time_ms) return time_ms;
  block_motors.clear();
  for (const Motor& m : motors)
    if (m.in_use) block_motors.push_back(m.number);
  block_home.clear();
  for (int motor : block_motors) block_home.push_back(motors[static_cast<std::size_t>(motor)].home_position_mu);
  const bool plants = any_plant(*this, block_motors), single = gather.enabled() && gather.needs_single_ticks();
  block_rows.resize(bytecode::kMaxMotors * kBlockTicks);
  block_path.resize(bytecode::kMaxMotors * kBlockTicks);
  if (plants) block_actual.resize(block_rows.size());
  std::vector<double>& actual = plants ? block_actual : block_rows;
  tick = tick_before_seen(*this, time_ms);
  while (tick_ms(tick + 1) <= time_ms) {
    block_times.resize(static_cast<std::size_t>(ticks_up_to(*this, time_ms, single ? 1 : kBlockTicks)));
    for (std::size_t k = 0; k < block_times.size(); ++k) block_times[k] = tick_ms(tick + 1 + static_cast<std::int64_t>(k));
    command_rows();
    const int kept = follow_rows(actual);
    const std::size_t values = block_motors.size() * static_cast<std::size_t>(kept);
    const SampleBlock block{tick + 1, period_ms(), kept, block_motors, {block_rows.data(), values}, {actual.data(), values}, block_home};
    tick += kept;
    now_ms = std::max(now_ms, tick_ms(tick));
    deliver(block);
    if (!trips.empty() || interruption_wanted()) return now_ms;
  }
  return time_ms;
}

void Machine::State::scan(int number, double) {
  Thread& thread = plcs[static_cast<std::size_t>(number)].runner->thread;
  thread.reset_jump_backs();
  finish_scan(number, thread.run(*host, kPlcBudget, 1));
  execute_queued_commands();
}

void Machine::State::step_plc(int number) { finish_scan(number, plcs[static_cast<std::size_t>(number)].runner->thread.run_line(*host, kPlcBudget)); }

void Machine::State::finish_scan(int number, const RunResult& result) {
  instructions += result.instructions;
  Plc& plc = plcs[static_cast<std::size_t>(number)];
  switch (result.stop) {
    case RunStop::kEnded: plc.runner->thread.restart(); break;
    case RunStop::kBudget:
    case RunStop::kJumpBack:
    case RunStop::kSuspended: break;
    case RunStop::kFault:
      plc.active = plc.running = false;
      report_fault({now_ms, -1, number, *result.fault});
      break;
  }
}

void Machine::State::scan_plcs(double time_ms) {
  if (std::none_of(plcs.begin(), plcs.end(), [](const Plc& plc) { return plc.running; })) return;
  const bool at_rti = rti_at_or_after_ms(time_ms) == time_ms;
  const bool at_background = time_ms >= last_background_ms + background_period_ms(*this);
  for (int n = 0; n < bytecode::kMaxPlcs; ++n) {
    if (!plcs[static_cast<std::size_t>(n)].running) continue;
    if (is_foreground(*this, n) ? at_rti : at_background) scan(n, time_ms);
  }
  if (at_background) last_background_ms = time_ms;
}

void Machine::State::service(double time_ms) {
  react_to_trips(*this);
  for (Motor& m : motors) service_motor(*this, m);
  service_from(0, time_ms);
}

void Machine::State::service_from(int first, double time_ms) {
  programs_execute = true;
  std::for_each(coords.begin() + first, coords.end(), [time_ms](const auto& c) { c->service(time_ms); });
  execute_queued_commands();
  while (!timed.empty() && timed.front().time_ms <= time_ms) {
    const std::string text = timed.front().text;
    timed.erase(timed.begin());
    command(text, "--at");
  }
  scan_plcs(time_ms);
  programs_execute = false;
  reset_now();
}

RunOutcome Machine::State::run(const RunLimits& limits) {
  RunOutcome outcome;
  bool broken_off = false;   // in the middle of planning: what has been sampled is all there is
  try {
    const InterruptionScope scope(limits.interrupted);
    outcome.end = run_events(*this, limits);
  } catch (const Interrupted&) {
    outcome.end = RunEnd::kInterrupted;
    broken_off = true;
    catch_up();
  }
  outcome.time_ms = now_ms;
  outcome.ticks = tick;
  outcome.instructions = instructions;
  if (limits.more_follows) return outcome;
  for (const auto& c : coords)
    if (c->program_active()) outcome.running.push_back(fmt::format("prog {} at {}", c->runner().thread.top_program().program->number, place(c->line_at(now_ms))));
  if (broken_off) return outcome;
  for (const auto& c : coords) c->report_unfinished(now_ms, true);
  sample_to(tick_ms(tick) >= now_ms ? now_ms : tick_ms(tick + 1));
  outcome.ticks = tick;
  return outcome;
}

}  // namespace pmac::runtime
