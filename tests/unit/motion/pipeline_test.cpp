// The whole way: timings, streaming, rest, faults, long programs.
#include "runtime/motion/pipeline.h"

#include <cmath>
#include <random>

#include <catch2/catch.hpp>

#include "tests/unit/motion/scenario.h"

using namespace pmac::motion;
using namespace pmac::motion::test;

namespace {

PipelineConfig variant(int which) {
  PipelineConfig config = config_xy(1000);
  set_limits(config, 500, 1);
  config.segment_time_ms = which == 0 ? 0 : 5;
  config.lookahead = which == 2;
  config.lookahead_segments = 50;
  if (which == 0) config.limits.clear();
  return config;
}

/// Runs like a machine: commands are added only when they are wanted, samples are taken tick by tick.
std::vector<double> run_ticking(const PipelineConfig& config, const Program& program) {
  Pipeline pipeline;
  pipeline.reset(config, {}, 0);
  std::size_t next = 0;
  std::vector<double> x;
  double position[2];
  for (int k = 0;; ++k) {
    const double t = k * kServoPeriod_ms;
    while (next < program.commands.size() &&
           (pipeline.commands_ahead(t) < 2 || pipeline.wants_more_segments(t) || pipeline.horizon_ms() < t))
      REQUIRE_FALSE(pipeline.add(program.commands[next++]));
    if (next == program.commands.size()) REQUIRE_FALSE(pipeline.end_sequence());
    if (!pipeline.at_rest(t)) REQUIRE(pipeline.horizon_ms() >= t);
    pipeline.sample(t, position, {});
    x.push_back(position[0]);
    if (next == program.commands.size() && pipeline.at_rest(t)) return x;
  }
}

}  // namespace

TEST_CASE("pipeline: adding as it goes gives the same samples as adding all", "[motion][pipeline]") {
  Program p;
  p.feed(200).ta(25).ts(10);
  std::mt19937 random(9);
  std::uniform_real_distribution<double> place(-30, 30);
  for (int i = 0; i < 40; ++i) p.xy(place(random), place(random));
  for (int which = 0; which < 3; ++which) {
    const Run all = run(variant(which), p);
    const std::vector<double> ticking = run_ticking(variant(which), p);
    REQUIRE(ticking.size() >= all.position[0].size() - 1);
    double worst = 0;
    for (std::size_t k = 0; k < std::min(ticking.size(), all.position[0].size()); ++k)
      worst = std::max(worst, std::abs(ticking[k] - all.position[0][k]));
    CHECK(worst < 1e-6);
  }
}

TEST_CASE("pipeline: the same input gives the same bytes", "[motion][pipeline]") {
  for (int which = 0; which < 3; ++which) CHECK(run(variant(which), oval()).position == run(variant(which), oval()).position);
}

TEST_CASE("pipeline: position and velocity are continuous at servo rate", "[motion][pipeline]") {
  for (int which = 0; which < 3; ++which) {
    const Run r = run(variant(which), contour(), at_xy(1, 4));
    for (std::size_t m = 0; m < 2; ++m)
      for (std::size_t k = 1; k < r.position[m].size(); ++k) {
        const double mean = (r.velocity[m][k] + r.velocity[m][k - 1]) / 2;
        CHECK(std::abs(r.position[m][k] - r.position[m][k - 1] - mean * r.period_ms) < 0.02);
        CHECK(std::abs(r.velocity[m][k] - r.velocity[m][k - 1]) < 4 * r.period_ms);
      }
  }
}

TEST_CASE("pipeline: timings of a blended sequence", "[motion][pipeline]") {
  Program p;
  p.feed(50).ta(100).ts(0).xy(20, 0).xy(20, 20).delay(200);
  const Run exact = run(variant(0), p);
  REQUIRE(exact.timings.size() == 3);
  // T_a/2 + TM = 50 + 400; blends begin 50 ms before; the delay ends the sequence.
  CHECK(exact.timings[0].start_ms == 0);
  CHECK(exact.timings[0].sync_ms == 0);
  CHECK(exact.timings[0].end_ms == Approx(450));
  CHECK(exact.timings[1].sync_ms == Approx(400));
  CHECK(exact.timings[1].start_ms == Approx(450));
  CHECK(exact.timings[1].end_ms == Approx(850));
  CHECK(exact.timings[1].length_uu == Approx(20));
  CHECK(exact.timings[2].end_ms == Approx(1100));
  CHECK(exact.timings[2].length_uu == 0);
  PipelineConfig config = variant(1);
  config.segment_time_ms = 7;
  const Run segmented = run(config, p);
  CHECK(segmented.timings[1].sync_ms >= 400 - 1e-9);
  CHECK(segmented.timings[1].sync_ms <= 407);
  CHECK(segmented.timings[1].start_ms == Approx(450));
}

TEST_CASE("pipeline: timings under lookahead lie where the motors pass", "[motion][pipeline]") {
  const Run r = run(variant(2), oval());
  REQUIRE(r.timings.size() == 5);
  CHECK(r.timings.back().end_ms == Approx(r.end_ms));
  const std::size_t tick = static_cast<std::size_t>(r.timings[1].start_ms / r.period_ms);
  CHECK(r.position[0][tick] == Approx(60000).margin(100));  // mid-blend of line and arc is their join
  for (std::size_t i = 1; i < 5; ++i) CHECK(r.timings[i].start_ms == Approx(r.timings[i - 1].end_ms));
}

TEST_CASE("pipeline: sequences follow one another, rest lies between", "[motion][pipeline]") {
  Pipeline pipeline;
  pipeline.reset(variant(1), {}, 1000);
  Program p;
  p.feed(50).ta(100).ts(0).xy(20, 0).xy(0, 0);
  CHECK(pipeline.at_rest(1000));
  REQUIRE_FALSE(pipeline.add(p.commands[0]));
  CHECK_FALSE(pipeline.at_rest(1e9));
  CHECK(pipeline.commands_ahead(999) == 1);
  CHECK(pipeline.commands_ahead(1000) == 0);
  REQUIRE_FALSE(pipeline.end_sequence());
  REQUIRE_FALSE(pipeline.end_sequence());
  CHECK(pipeline.end_ms() == Approx(1500));
  CHECK(pipeline.at_rest(1500));
  pipeline.set_earliest_start(1600);
  REQUIRE_FALSE(pipeline.add(p.commands[1]));
  REQUIRE_FALSE(pipeline.end_sequence());
  CHECK(pipeline.end_ms() == Approx(2100));
  std::vector<double> position(2 * 3);
  pipeline.sample(times(1250, 300, 3), position, {});  // cruise, rest, cruise back
  CHECK(position[0] == Approx(10000));
  CHECK(position[1] == Approx(20000));
  CHECK(position[2] == Approx(10000));
  CHECK(pipeline.executing_source(1550) == SourceLine{});
  CHECK(pipeline.executing_source(1850).line == 2);
  pipeline.sample(2100, position, {});
  CHECK(position[0] == Approx(0).margin(1e-9));
}

TEST_CASE("pipeline: a rapid move in between moves the start of the next sequence", "[motion][pipeline]") {
  Pipeline pipeline;
  pipeline.reset(variant(0), {}, 0);
  pipeline.set_position(at_xy(5, 7));
  REQUIRE_FALSE(pipeline.add(Program().feed(50).ta(100).xy(5, 10).commands[0]));
  REQUIRE_FALSE(pipeline.end_sequence());
  std::vector<double> position(2);
  pipeline.sample(0, position, {});
  CHECK(position[0] == 5000);
  CHECK(position[1] == 7000);
}

TEST_CASE("pipeline: moves without length and time only have timings", "[motion][pipeline]") {
  const Run r = run(variant(1), Program().feed(50).ta(0).xy(0, 0).xy(10, 0).xy(10, 0).xy(20, 0));
  CHECK(r.end_ms == Approx(400));
  REQUIRE(r.timings.size() == 4);
  CHECK(r.timings[2].start_ms == Approx(200));
  CHECK(r.timings[2].end_ms == Approx(200));
}

TEST_CASE("pipeline: a long program of short lines keeps its memory and precision", "[motion][pipeline]") {
  Pipeline pipeline;
  PipelineConfig config = variant(2);
  pipeline.reset(config, {}, 0);
  Program modal;
  modal.feed(200).ta(2).xy(0, 0);
  MotionCommand command = modal.commands[0];
  double t = 0, worst = 0;
  std::vector<double> position(2 * 64);
  std::vector<double> last(3);
  std::vector<MoveTiming> timings;
  std::size_t most_timings = 0;
  for (int i = 1; i <= 20000; ++i) {
    const double angle = i * 0.002;
    command.id = static_cast<std::uint64_t>(i);
    command.target_uu[kX] = 50 * std::sin(angle);
    command.target_uu[kY] = 50 - 50 * std::cos(angle);
    REQUIRE_FALSE(pipeline.add(command));
    while (t + 64 * kServoPeriod_ms < pipeline.horizon_ms()) {
      pipeline.sample(times(t, kServoPeriod_ms, 64), position, {});
      for (std::size_t k = 0; k < 64; ++k)
        worst = std::max(worst, std::abs(std::hypot(position[k], position[64 + k] - 50000) - 50000));
      t += 64 * kServoPeriod_ms;
    }
    timings.clear();
    pipeline.take_timings(timings);
    most_timings = std::max(most_timings, timings.size());
  }
  CHECK(worst < 0.1);           // chord 0.1 mm on R 50: sagitta 0.025 um = 0.025 mu
  CHECK(most_timings < 200);    // delivered as they become final
}
