// Runs a program of one coordinate system and one sequence of moves and says how its motion compares with the dense solver of
// tests/reference: time, limits at servo rate, distance from the path of hop 6.
#pragma once

#include "runtime/motion/pipeline.h"
#include "runtime/motion/segment.h"
#include "tests/reference/dense_path.h"
#include "tests/unit/programs/bench.h"

namespace pmac::test {

struct LookaheadCase {
  double time_ms = 0, optimum_ms = 0;
  double segment_ms = 0;
  double speed_share = 0, accel_share = 0;   // worst over the motors, in parts of the limit
  double away_mu = 0;                        // from the path at the same programmed time
  std::size_t samples = 0;
};

inline double element(ProgramBench& bench, const std::string& name) {
  bench.answers.clear();
  bench.machine->command(name);
  REQUIRE(bench.answers.size() == 1);
  return std::stod(bench.answers[0].substr(bench.answers[0].find('=') + 1));
}

/// Rows of the linear map of coordinate system 1, by its motors.
inline reference::LinearMap linear_map(ProgramBench& bench, const std::vector<int>& motors) {
  reference::LinearMap map;
  map.motors = motors.size();
  map.matrix_mu_uu.assign(motors.size() * bytecode::kAxisCount, 0.0);
  std::array<double, bytecode::kMaxMotors> zero{}, one{};
  motion::AxisVector axis{};
  bench.machine->motors_from_axes(1, axis, zero);
  for (std::size_t a = 0; a < axis.size(); ++a) {
    axis = {};
    axis[a] = 1;
    bench.machine->motors_from_axes(1, axis, one);
    for (std::size_t m = 0; m < motors.size(); ++m)
      map.matrix_mu_uu[m * axis.size() + a] = one[static_cast<std::size_t>(motors[m])] - zero[static_cast<std::size_t>(motors[m])];
  }
  return map;
}

/// Worst first and second differences of one motor against its limits (0: off), at rest before and after.
inline void add_shares(const std::vector<std::array<double, bytecode::kMaxMotors>>& rows, int motor, double period_ms, double max_speed,
                       double inv_accel, LookaheadCase& result) {
  const auto at = [&](std::ptrdiff_t k) {
    return rows[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(k, 0, std::ssize(rows) - 1))][static_cast<std::size_t>(motor)];
  };
  for (std::ptrdiff_t k = -1; k <= std::ssize(rows); ++k) {
    const double speed = std::abs(at(k + 1) - at(k)) / period_ms;
    const double accel = std::abs(at(k + 1) - 2 * at(k) + at(k - 1)) / (period_ms * period_ms);
    if (max_speed > 0) result.speed_share = std::max(result.speed_share, speed / max_speed);
    result.accel_share = std::max(result.accel_share, accel * inv_accel);
  }
}

/// Largest distance of a motor from the path of hop 6 at the same programmed time.
inline double largest_distance(const std::vector<motion::PathPiece>& pieces, const std::vector<motion::TimedSegment>& segments,
                               const reference::LinearMap& map, const std::vector<double>& offset) {
  double worst = 0;
  std::size_t at = 0;
  double last_ms = -1;
  for (const motion::TimedSegment& timed : segments) {
    const motion::Segment& s = timed.segment;
    if (s.start_ms < last_ms) while (at + 1 < pieces.size() && !pieces[at + 1].starts_at_rest) ++at;   // the next sequence
    if (s.start_ms < last_ms && at + 1 < pieces.size()) ++at;
    last_ms = s.start_ms;
    for (const double part : {0.0, 0.21, 0.5, 0.79}) {
      const double time_ms = s.start_ms + part * s.duration_ms;
      while (at + 1 < pieces.size() && pieces[at + 1].start_ms >= pieces[at].start_ms && time_ms >= pieces[at + 1].start_ms) ++at;
      const double local = std::clamp(time_ms - pieces[at].start_ms, 0.0, pieces[at].duration_ms);
      const std::vector<double> q = map(evaluate(pieces[at], local).position);
      for (std::size_t m = 0; m < q.size(); ++m) worst = std::max(worst, std::abs(q[m] + offset[m] - s.motor[m].position(part * s.duration_ms)));
    }
  }
  return worst;
}

/// The program is started with `command`. points: of the dense solver in each piece of the path; 0: no optimum.
inline LookaheadCase run_lookahead_case(const std::string& text, const std::string& command = "&1 b1r", int points = 400) {
  ProgramBench bench("case.pmc", text);
  std::vector<motion::PathPiece> pieces;
  std::vector<motion::TimedSegment> timed;
  motion::StageObservers observers;
  observers.path = [&](const motion::PathPiece& piece) { pieces.push_back(piece); };
  observers.timed_segment = [&](const motion::TimedSegment& segment) { timed.push_back(segment); };
  bench.machine->observe_stages(1, observers);
  bench.run(command);
  INFO((bench.faults.empty() ? std::string() : bench.faults[0].fault.detail));
  REQUIRE(bench.faults.empty());
  REQUIRE(bench.refusals.empty());
  LookaheadCase result;
  result.segment_ms = element(bench, "Coord[1].SegMoveTime");
  result.samples = bench.motor_mu.size();
  const std::vector<int> motors = bench.machine->motors_in_use();
  const reference::LinearMap map = linear_map(bench, motors);
  std::vector<double> weight, offset;
  std::array<double, bytecode::kMaxMotors> zero{};
  bench.machine->motors_from_axes(1, {}, zero);
  reference::DenseLimits limits;
  constexpr double kOff = std::numeric_limits<double>::infinity();
  for (const int motor : motors) {
    const std::string prefix = "Motor[" + std::to_string(motor) + "].";
    const double speed = element(bench, prefix + "MaxSpeed"), inv_accel = element(bench, prefix + "InvAmax");
    add_shares(bench.motor_mu, motor, bench.machine->servo_period_ms(), speed, inv_accel, result);
    limits.speed.push_back(speed > 0 ? speed : kOff);
    limits.accel.push_back(inv_accel > 0 ? 1 / inv_accel : kOff);
    weight.push_back(inv_accel > 0 ? inv_accel : 1);
    offset.push_back(zero[static_cast<std::size_t>(motor)]);
  }
  for (const auto& segment : timed) result.time_ms += segment.duration_ms;
  result.away_mu = largest_distance(pieces, timed, map, offset);
  if (points == 0) return result;
  reference::DensePath path(map, weight, points);
  for (const auto& piece : pieces) path.add(piece);
  result.optimum_ms = reference::DenseTimeOptimal(path.finish(), limits).solve();
  return result;
}

}  // namespace pmac::test
