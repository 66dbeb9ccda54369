// Help for the tests of the trajectory runtime: programs as lists of commands, run through a pipeline and sampled.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "runtime/motion/curve.h"
#include "runtime/motion/path.h"
#include "runtime/motion/pipeline.h"
#include "runtime/motion/segment.h"

namespace pmac::motion::test {

inline constexpr double kServoPeriod_ms = 0.44274211;
inline constexpr std::size_t kX = kAxisX, kY = kAxisX + 1, kZ = kAxisX + 2, kC = 2;

/// Motors 1.. = scale * X, Y, Z ... (mu per uu).
inline PipelineConfig config_xy(double scale = 1000, std::size_t motors = 2) {
  PipelineConfig config;
  config.limits.resize(motors);
  config.map.matrix_mu_uu.assign(motors * kAxisCount, 0.0);
  config.map.offset_mu.assign(motors, 0.0);
  for (std::size_t m = 0; m < motors; ++m) {
    config.map.motors.push_back(static_cast<int>(m) + 1);
    config.map.matrix_mu_uu[m * kAxisCount + kX + m] = scale;
  }
  return config;
}

inline void set_limits(PipelineConfig& config, double max_speed_mu_ms, double accel_mu_ms2) {
  for (MotorLimits& limits : config.limits) limits = {max_speed_mu_ms, 1 / accel_mu_ms2, 1 / accel_mu_ms2, 0};
}

/// Modal words and commands of a program, as the interpreter would fill them.
class Program {
 public:
  Program& feed(double f) { modal_.feed_uu = f; return *this; }
  Program& tm(double t) { modal_.feed_uu = 0; modal_.move_time_ms = t; return *this; }
  Program& ta(double t) { modal_.ta_ms = modal_.td_ms = t; return *this; }
  Program& ts(double t) { modal_.ts_ms = modal_.tsd_ms = t; return *this; }
  Program& td(double t) { modal_.td_ms = t; return *this; }
  Program& xy(double x, double y) { return target({{kX, x}, {kY, y}}); }
  Program& target(std::initializer_list<std::pair<std::size_t, double>> words) {
    MotionCommand command = next(CommandKind::kLinear);
    for (const auto& [axis, value] : words) put(command, axis, value);
    commands.push_back(command);
    return *this;
  }
  Program& arc_ij(bool clockwise, double x, double y, double i, double j) {
    MotionCommand command = arc(clockwise, x, y);
    command.has_center = true;
    command.center_uu = {i, j, 0};
    commands.push_back(command);
    return *this;
  }
  Program& arc_r(bool clockwise, double x, double y, double r) {
    MotionCommand command = arc(clockwise, x, y);
    command.has_radius = true;
    command.radius_uu = r;
    commands.push_back(command);
    return *this;
  }
  Program& delay(double t) {
    MotionCommand command = next(CommandKind::kDelay);
    command.move_time_ms = t;
    commands.push_back(command);
    return *this;
  }
  std::vector<MotionCommand> commands;

 private:
  static void put(MotionCommand& command, std::size_t axis, double value) {
    command.axes |= 1u << axis;
    command.target_uu[axis] = value;
  }
  MotionCommand next(CommandKind kind) {
    MotionCommand command = modal_;
    command.kind = kind;
    command.id = commands.size() + 1;
    command.source.line = static_cast<int>(commands.size()) + 1;
    command.feed_axes = 7u << kX;
    return command;
  }
  MotionCommand arc(bool clockwise, double x, double y) {
    MotionCommand command = next(CommandKind::kCircle);
    command.clockwise = clockwise;
    put(command, kX, x);
    put(command, kY, y);
    return command;
  }
  MotionCommand modal_;
};

/// What a run gave: positions [motor][sample] every period from t = 0 to the first tick at or after the end.
struct Run {
  double period_ms = 0, end_ms = 0;
  std::vector<std::vector<double>> position, velocity;
  std::vector<MoveTiming> timings;
  std::vector<PathPiece> pieces;
  std::vector<Segment> segments;
  std::vector<TimedSegment> timed;
  std::optional<runtime::Fault> fault;

  double max_speed(std::size_t motor) const {
    double result = 0;
    for (std::size_t k = 1; k < position[motor].size(); ++k)
      result = std::max(result, std::abs(position[motor][k] - position[motor][k - 1]) / period_ms);
    return result;
  }
  /// Second differences, with rest before the first and after the last sample.
  double max_accel(std::size_t motor) const {
    const auto& p = position[motor];
    const auto at = [&](std::ptrdiff_t k) { return p[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(k, 0, std::ssize(p) - 1))]; };
    double result = 0;
    for (std::ptrdiff_t k = -1; k <= std::ssize(p); ++k)
      result = std::max(result, std::abs(at(k + 1) - 2 * at(k) + at(k - 1)) / (period_ms * period_ms));
    return result;
  }
};

/// start, start + period, ...
inline std::vector<double> times(double start_ms, double period_ms, int count) {
  std::vector<double> t;
  for (int k = 0; k < count; ++k) t.push_back(start_ms + k * period_ms);
  return t;
}

/// Adds everything, ends the sequence, samples it all.
inline Run run(const PipelineConfig& config, const Program& program, const AxisVector& start = {}, double period_ms = kServoPeriod_ms) {
  Run result;
  result.period_ms = period_ms;
  Pipeline pipeline;
  pipeline.observe({[&](const PathPiece& piece) { result.pieces.push_back(piece); },
                    [&](const Segment& segment) { result.segments.push_back(segment); },
                    [&](const TimedSegment& segment) { result.timed.push_back(segment); }});
  pipeline.reset(config, start, 0);
  for (const MotionCommand& command : program.commands)
    if ((result.fault = pipeline.add(command))) break;
  if (!result.fault) result.fault = pipeline.end_sequence();
  result.end_ms = pipeline.end_ms();
  const int count = static_cast<int>(std::ceil(result.end_ms / period_ms)) + 1;
  const std::size_t motors = config.map.motors.size();
  std::vector<double> position(motors * static_cast<std::size_t>(count)), velocity(position.size());
  pipeline.sample(times(0, period_ms, count), position, velocity);
  for (std::size_t m = 0; m < motors; ++m) {
    const auto row = static_cast<std::ptrdiff_t>(m) * count;
    result.position.emplace_back(position.begin() + row, position.begin() + row + count);
    result.velocity.emplace_back(velocity.begin() + row, velocity.begin() + row + count);
  }
  pipeline.take_timings(result.timings);
  return result;
}

inline AxisVector at_xy(double x, double y) {
  AxisVector position{};
  position[kX] = x;
  position[kY] = y;
  return position;
}

/// The oval of the vendor's examples: F200 ta25 ts0, from (0,0).
inline Program oval() {
  Program p;
  p.feed(200).ta(25).ts(0);
  p.xy(60, 0).arc_r(false, 60, 20, 10).xy(-60, 20).arc_r(false, -60, 0, 10).xy(0, 0);
  return p;
}

/// The blended contour of the vendor's examples, from (1,4).
inline Program contour(double feed = 50, double ta = 100, double ts = 50) {
  Program p;
  p.feed(feed).ta(ta).ts(ts);
  p.xy(1, 13).arc_ij(true, 2, 14, 1, 0).xy(3, 14).arc_ij(true, 4, 13, 0, -1).xy(4, 7).arc_ij(false, 7, 4, 3, 0);
  p.xy(13, 4).arc_ij(true, 14, 3, 0, -1).xy(14, 2).arc_ij(true, 13, 1, -1, 0).xy(4, 1).arc_ij(true, 1, 4, 0, 3);
  return p;
}

}  // namespace pmac::motion::test
