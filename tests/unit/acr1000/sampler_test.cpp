// Samples at a fixed period, and the common lookahead over the path that two cards draw together.
#include <catch2/catch.hpp>
#include <cmath>

#include "runtime/acr1000/path_lookahead.h"
#include "tests/unit/acr1000/scripted_driver.h"

using namespace pmac::acr1000;

namespace {

struct Row { double time_s; std::vector<double> position; };

/// Cards driven by steps, with a sink that is told of every stretch.
struct Bench {
  std::function<void(double, double)> stretch;
  CardSystem system{{{}, {}, {}, [this](double from, double to) { if (stretch) stretch(from, to); }}};
  std::vector<Row> rows;
  SampleTaker taker = [this](double time_s, std::span<const MotionPoint> cards) {
    rows.push_back({time_s, {}});
    for (const MotionPoint& point : cards) rows.back().position.push_back(point.position_pulses);
  };
  void add(std::vector<ScriptedDriver::Step> steps) {
    Card& card = system.add({});
    card.driver = std::make_unique<ScriptedDriver>(card, std::move(steps));
  }
};

std::vector<ScriptedDriver::Step> around(const std::vector<std::int64_t>& targets) {
  std::vector<ScriptedDriver::Step> steps{rates({10000, 0, 0, 0})};
  for (const std::int64_t target : targets) steps.push_back(mov(10000, target));
  return steps;
}

/// Worst speed (pulses/s) and acceleration (pulses/s^2) of an axis from differences of the rows.
std::pair<double, double> worst_of(const std::vector<Row>& rows, std::size_t axis, double period_s) {
  double speed = 0, accel = 0;
  for (std::size_t k = 2; k < rows.size(); ++k) {
    const double p0 = rows[k].position[axis], p1 = rows[k - 1].position[axis], p2 = rows[k - 2].position[axis];
    speed = std::max(speed, std::abs(p0 - p1) / period_s);
    accel = std::max(accel, std::abs(p0 - 2 * p1 + p2) / (period_s * period_s));
  }
  return {speed, accel};
}

}  // namespace

TEST_CASE("samples: rows at 0, the period, ..., the last one the first at or after the end", "[acr1000]") {
  for (const auto& [length, last] : std::vector<std::pair<std::int64_t, double>>{{1000, 1.0}, {1010, 1.1}, {0, 0.0}}) {
    Bench bench;
    bench.add({rates({1000, 0, 0, 0}), mov(0, length)});
    Sampler sampler(bench.system, 0.1, bench.taker);
    bench.stretch = [&](double from, double to) { sampler.stretch(from, to); };
    sampler.finish(bench.system.run({}).time_s);
    CAPTURE(length);
    CHECK(bench.rows.front().time_s == 0);
    CHECK(bench.rows.back().time_s == Approx(last));
    CHECK(bench.rows.size() == static_cast<std::size_t>(std::lround(last * 10)) + 1);
    CHECK(bench.rows.back().position[0] == static_cast<double>(length));
    if (length > 0) CHECK(bench.rows[5].position[0] == Approx(500));
  }
}

TEST_CASE("lookahead: a square keeps its path and the limits of both axes", "[acr1000]") {
  Bench bench;
  bench.add(around({10000, 10000, 0, 0}));
  bench.add(around({0, 10000, 10000, 0}));
  constexpr double kPeriodS = 1e-3, kAccel = 50000;
  PathLookahead lookahead(bench.system, {{8000, kAccel}, {8000, kAccel}}, kPeriodS, bench.taker);
  bench.stretch = [&](double from, double to) { lookahead.stretch(from, to); };
  bench.system.run({});
  lookahead.finish();
  for (const std::size_t axis : {0u, 1u}) {
    const auto [speed, accel] = worst_of(bench.rows, axis, kPeriodS);
    CHECK(speed <= 8000 * 1.001);
    CHECK(accel <= kAccel * 1.001);
  }
  for (const Row& row : bench.rows) {
    const double x = row.position[0], y = row.position[1];
    const double off = std::min({std::abs(x), std::abs(y), std::abs(x - 10000), std::abs(y - 10000)});
    REQUIRE(off < 1e-6);
  }
  // Four sides from rest to rest: each 10000/8000 + 8000/50000 s.
  CHECK(lookahead.end_s() == Approx(4 * (10000 / 8000.0 + 8000 / 50000.0)).epsilon(0.01));
  CHECK(lookahead.stretched_s(2) == Approx(lookahead.end_s() / 2).epsilon(0.01));
  CHECK(bench.rows.back().position == std::vector<double>{0, 0});
}

TEST_CASE("lookahead: limits that the program keeps leave its times alone", "[acr1000]") {
  Bench bench;
  bench.add({rates({1000, 5000, 5000, 5000}), mov(0, 2000)});
  PathLookahead lookahead(bench.system, {{2000, 6000}}, 1e-3, bench.taker);
  bench.stretch = [&](double from, double to) { lookahead.stretch(from, to); };
  const double end_s = bench.system.run({}).time_s;
  lookahead.finish();
  CHECK(lookahead.end_s() == Approx(end_s).epsilon(1e-3));
}

TEST_CASE("lookahead: lines and arcs of the contour keep their path and the limits of both axes", "[acr1000]") {
  Bench bench;
  bench.add({rates({10000, 0, 0, 0}), mov(20000, 0), circle(47124, 34142, {1, 20000, -20000, 0, 47124}), circle(47124, 68284, {1, 20000, -14142, 14142, 47124}), mov(20000, 68284), mov(68284, 0)});
  bench.add({rates({10000, 0, 0, 0}), mov(20000, 20000), circle(47124, 34142, {1, 20000, 0, 20000, 47124}), circle(47124, 20000, {1, 20000, 14142, 14142, 47124}), mov(20000, 0), mov(68284, 0)});
  constexpr double kPeriodS = 1e-3, kAccel = 40000;
  PathLookahead lookahead(bench.system, {{8000, kAccel}, {8000, kAccel}}, kPeriodS, bench.taker);
  bench.stretch = [&](double from, double to) { lookahead.stretch(from, to); };
  bench.system.run({});
  lookahead.finish();
  for (const std::size_t axis : {0u, 1u}) {
    const auto [speed, accel] = worst_of(bench.rows, axis, kPeriodS);
    CHECK(speed <= 8000 * 1.001);
    CHECK(accel <= kAccel * 1.001);
  }
  double worst = 0;
  for (const Row& row : bench.rows) {
    const double x = row.position[0], y = row.position[1];
    const double lines = std::min({std::abs(x), std::abs(y), std::abs(x - 68284)});
    const double arcs = std::min(std::abs(std::hypot(x - 20000, y - 20000) - 20000), std::abs(std::hypot(x - 48284, y - 20000) - 19999.81));
    worst = std::max(worst, std::min(lines, arcs));
  }
  CHECK(worst < 0.3);   // what the end points are beside the arcs
  // From rest to rest: two lines of 20000 and one of 68284 at 8000, arcs at most a little slower than 10000.
  CHECK(lookahead.end_s() > 20.2532);
  CHECK(lookahead.end_s() < 26);
}
