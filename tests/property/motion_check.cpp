#include "tests/property/motion_check.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace pmac::test {
namespace {

constexpr double kMuPerMm = 1000;

double at(const MotionRun& run, std::ptrdiff_t k, std::size_t motor) {
  return run.position_mu[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(k, 0, std::ssize(run.position_mu) - 1))][motor];
}

struct Largest { double speed = 0, change = 0; };  // mu/ms: of the first difference, and of its change from one sample to the next

Largest largest(const MotionRun& run, std::size_t motor) {
  Largest result;
  for (std::ptrdiff_t k = -1; k <= std::ssize(run.position_mu); ++k) {
    const double speed = (at(run, k + 1, motor) - at(run, k, motor)) / run.period_ms, before = (at(run, k, motor) - at(run, k - 1, motor)) / run.period_ms;
    result.speed = std::max(result.speed, std::abs(speed));
    result.change = std::max(result.change, std::abs(speed - before));
  }
  return result;
}

std::string away_from(const std::array<double, 3>& position_mu, const std::array<double, 3>& point_uu, const char* what) {
  for (std::size_t m = 0; m < 3; ++m)
    if (const double off = position_mu[m] - kMuPerMm * point_uu[m]; !(std::abs(off) < 1e-6)) return fmt::format("{}: motor {} is {} mu off", what, m + 1, off);
  return {};
}

}  // namespace

MotionRun run_motion(const std::string& text, const std::string& set_up, const std::string& commands, CommandObserver observer) {
  ProgramBench bench("random.pmc", set_up + "\n" + text, motion::FineInterpolation::kThrough, false, std::move(observer));
  bench.run(commands);
  MotionRun run;
  run.period_ms = bench.machine->servo_period_ms();
  for (const auto& row : bench.motor_mu) run.position_mu.push_back({row[1], row[2], row[3]});
  run.moves = bench.moves;
  std::stable_sort(run.moves.begin(), run.moves.end(), [](const auto& a, const auto& b) { return a.start_ms < b.start_ms; });
  if (!bench.faults.empty()) run.fault = bench.faults[0].fault.detail;
  if (!bench.refusals.empty()) run.fault = bench.refusals[0];
  return run;
}

std::string wrong_end(const reference::RandomMotion& motion, const MotionRun& run) {
  if (run.position_mu.empty()) return "no samples";
  return away_from(run.position_mu.back(), motion.end_uu, "end");
}

std::string wrong_dwell(const reference::RandomMotion& motion, const MotionRun& run) {
  std::size_t dwell = 0;
  for (const runtime::MoveRecord& move : run.moves) {
    if (move.mode != "dwell") continue;
    if (dwell == motion.dwells_uu.size()) return "more dwells than programmed";
    for (const double part : {0.01, 0.5, 0.99}) {
      const auto k = static_cast<std::ptrdiff_t>(std::ceil((move.start_ms + part * (move.end_ms - move.start_ms)) / run.period_ms));
      if (static_cast<double>(k) * run.period_ms > move.end_ms) continue;
      const std::array<double, 3> here{at(run, k, 0), at(run, k, 1), at(run, k, 2)};
      if (std::string wrong = away_from(here, motion.dwells_uu[dwell], "dwell"); !wrong.empty()) return wrong;
    }
    ++dwell;
  }
  return dwell == motion.dwells_uu.size() ? "" : "fewer dwells than programmed";
}

std::string wrong_lengths(const reference::RandomMotion& motion, const MotionRun& run) {
  double sum = 0;
  for (const runtime::MoveRecord& move : run.moves)
    if (move.mode == "linear" || move.mode.starts_with("circle")) sum += move.length;
  const double off = sum - motion.line_length_uu;
  return std::abs(off) <= 1e-7 * (1 + motion.line_length_uu) ? "" : fmt::format("lines and arcs are {} mm long, {} too many", sum, off);
}

std::string wrong_times(const MotionRun& run) {
  double last_ms = 0;
  for (const runtime::MoveRecord& move : run.moves) {
    if (move.end_ms < move.start_ms) return fmt::format("a {} move ends before it starts", move.mode);
    if (move.start_ms < last_ms - 1e-6) return fmt::format("a {} move starts at {} ms, before the end of the one before, {} ms", move.mode, move.start_ms, last_ms);
    last_ms = move.end_ms;
  }
  return {};
}

std::string wrong_pvt_times(const reference::RandomMotion& motion, const MotionRun& run) {
  std::size_t block = 0;
  for (const runtime::MoveRecord& move : run.moves) {
    if (move.mode != "pvt") continue;
    if (block == motion.pvt_ms.size()) return "more pvt blocks than programmed";
    const double time_ms = motion.pvt_ms[block++];
    if (!(std::abs(move.end_ms - move.start_ms - time_ms) < 1e-6)) return fmt::format("pvt block {} takes {} ms of {}", block, move.end_ms - move.start_ms, time_ms);
  }
  return block == motion.pvt_ms.size() ? "" : "fewer pvt blocks than programmed";
}

std::string broken_limit(const reference::MotionSetUp& set_up, const MotionRun& run) {
  for (std::size_t m = 0; m < 3; ++m) {
    const Largest found = largest(run, m);
    const double accel = found.change / run.period_ms, max_accel = 0.1 * set_up.accel;
    if (found.speed > 1.001 * set_up.max_speed) return fmt::format("motor {}: {} mu/ms, limit {}", m + 1, found.speed, set_up.max_speed);
    if (accel > 1.001 * max_accel) return fmt::format("motor {}: {} mu/ms^2, limit {}", m + 1, accel, max_accel);
  }
  return {};
}

std::string step_in_motion(const MotionRun& coarse, const MotionRun& fine) {
  constexpr double kNothing = 1e-3;  // mu/ms: 1 um/s
  const double periods = coarse.period_ms / fine.period_ms;
  for (std::size_t m = 0; m < 3; ++m) {
    const Largest far = largest(coarse, m), near = largest(fine, m);
    if (near.speed > 2 * far.speed + kNothing * periods) return fmt::format("motor {}: position steps by {} mu", m + 1, near.speed * fine.period_ms);
    if (near.change > std::max(0.6 * far.change, kNothing)) return fmt::format("motor {}: speed steps by {} mu/ms", m + 1, near.change);
  }
  return {};
}

std::string difference(const MotionRun& a, const MotionRun& b) {
  if (a.position_mu.size() != b.position_mu.size()) return fmt::format("{} and {} samples", a.position_mu.size(), b.position_mu.size());
  const auto at = std::mismatch(a.position_mu.begin(), a.position_mu.end(), b.position_mu.begin()).first;
  return at == a.position_mu.end() ? "" : fmt::format("samples differ from number {}", at - a.position_mu.begin());
}

}  // namespace pmac::test
