// The lookahead against the dense solver of tests/reference: limits at servo rate within 1.001, time within 1.003 of the optimum and one
// segment, path kept. Optimal times of the first three are given numbers: closed form for the oval, phase-plane integration otherwise.
#include <map>
#include <random>

#include <catch2/catch.hpp>

#include "tests/property/lookahead_bench.h"
#include "tests/property/lookahead_programs.h"

using namespace pmac::test;

namespace {

constexpr int kPoints = 500;  // of the solver in a path piece: it is right to some 5e-4 then, mostly fast

using Machine = LookaheadMachine;

void keeps_limits_and_path(const LookaheadCase& run, double path_mu = 1) {
  CHECK(run.speed_share <= 1.001);
  CHECK(run.accel_share <= 1.001);
  CHECK(run.away_mu < path_mu);  // 1000 mu are a mm
}

LookaheadCase is_optimal(const std::string& name, const Machine& machine, const std::string& lines, double path_mu = 1) {
  INFO(name);
  const LookaheadCase run = run_lookahead_case(program_on(machine, lines), "&1 b1r", kPoints);
  keeps_limits_and_path(run, path_mu);
  INFO("time " << run.time_ms << " ms, optimum " << run.optimum_ms << " ms");
  CHECK(run.time_ms <= 1.003 * run.optimum_ms + run.segment_ms);
  CHECK(run.time_ms >= 0.998 * run.optimum_ms);  // the solver is slow by as much at very small blends
  return run;
}

Machine with_segments(double segment_ms) {
  Machine machine;
  machine.segment_ms = segment_ms;
  machine.window = static_cast<int>(1000 / segment_ms);
  return machine;
}

Machine in_space() {
  Machine machine;
  machine.definitions = {"1000X", "1000Y", "1000Z"};
  machine.limits = {{500, 1}, {200, 0.5}, {80, 2}};
  return machine;
}

}  // namespace

TEST_CASE("optimal times: the oval at F200", "[property][lookahead]") {
  const LookaheadCase run = run_lookahead_case(program_on({}, speed_words(200, 25) + oval()), "&1 b1r", 2000);
  keeps_limits_and_path(run);
  const double optimum_ms = 1000 * (0.65 + 0.85 + 8 * std::sqrt(2 * 0.010 * (1 - std::sqrt(0.5)) / 1));
  CHECK(optimum_ms == Approx(2112.29).margin(0.005));
  CHECK(run.optimum_ms == Approx(optimum_ms).epsilon(2e-4));  // the solver itself
  CHECK(run.time_ms <= 1.003 * optimum_ms);
  CHECK(run.time_ms >= 0.9999 * optimum_ms);
}

TEST_CASE("optimal times: the contour at F50 without ramps", "[property][lookahead]") {
  const LookaheadCase run = run_lookahead_case(program_on({}, speed_words(50) + contour()), "&1 b1r", 2000);
  keeps_limits_and_path(run);
  CHECK(run.optimum_ms == Approx(1097.48).epsilon(2e-4));
  CHECK(run.time_ms <= 1.003 * 1097.48);
  CHECK(run.time_ms >= 0.9999 * 1097.48);
}

TEST_CASE("optimal times: 201 legs of 10 mm with rounded corners at F200", "[property][lookahead]") {
  const LookaheadCase run = run_lookahead_case(program_on({}, speed_words(200) + zigzag(201)), "&1 b1r", kPoints);
  keeps_limits_and_path(run);
  CHECK(run.optimum_ms == Approx(37088.6).epsilon(4e-4));
  CHECK(run.time_ms <= 1.003 * 37088.6);
  CHECK(run.time_ms >= 0.9999 * 37088.6);
}

TEST_CASE("lookahead is optimal: segments of 1 to 20 ms", "[property][lookahead]") {
  for (const double segment_ms : {1.0, 2.0, 7.5, 10.0, 20.0}) {
    is_optimal(fmt::format("oval, {} ms", segment_ms), with_segments(segment_ms), speed_words(200, 25) + oval());
    is_optimal(fmt::format("contour, {} ms", segment_ms), with_segments(segment_ms), speed_words(50) + contour());
    is_optimal(fmt::format("zigzag, {} ms", segment_ms), with_segments(segment_ms), speed_words(200) + zigzag(11));
  }
}

TEST_CASE("lookahead is optimal: feeds and sizes", "[property][lookahead]") {
  for (const double feed : {5.0, 50.0, 150.0, 400.0}) is_optimal(fmt::format("oval F{}", feed), {}, speed_words(feed) + oval());
  for (const double feed : {5.0, 20.0, 100.0}) is_optimal(fmt::format("contour F{}", feed), {}, speed_words(feed) + contour());
  for (const double k : {0.1, 10.0, 100.0}) is_optimal(fmt::format("contour times {}", k), {}, speed_words(k > 1 ? 400 : 50) + contour(k));
  for (const double radius : {50.0, 500.0}) is_optimal(fmt::format("oval R{}", radius), {}, speed_words(450) + oval(6 * radius, radius));
  is_optimal("20 m", {}, speed_words(400) + "linear X20000 Y3000\n");
}

TEST_CASE("lookahead is optimal: servo periods", "[property][lookahead]") {
  for (const double period_ms : {0.0625, 0.25, 1.0, 4.0}) {
    Machine machine;
    machine.more = fmt::format("Sys.ServoPeriod={}", period_ms);
    is_optimal(fmt::format("oval, {} ms", period_ms), machine, speed_words(200, 25) + oval());
    is_optimal(fmt::format("contour, {} ms", period_ms), machine, speed_words(50) + contour());
  }
}

TEST_CASE("lookahead is optimal: ramps without S curve", "[property][lookahead]") {
  for (const double ta_ms : {1.0, 25.0, 100.0}) {
    is_optimal(fmt::format("oval ta{}", ta_ms), {}, speed_words(200, ta_ms) + oval());
    is_optimal(fmt::format("contour ta{}", ta_ms), {}, speed_words(50, ta_ms) + contour());
    is_optimal(fmt::format("corners ta{}", ta_ms), {}, speed_words(150, ta_ms) + corners());
    is_optimal(fmt::format("reversals ta{}", ta_ms), {}, speed_words(150, ta_ms) + reversals());
  }
}

TEST_CASE("lookahead is optimal: helix, planes, lines in space", "[property][lookahead]") {
  is_optimal("helix", in_space(), speed_words(200) + "inc\nlinear X20\ncircle2 X0 Y0 I0 J10 Z5\ncircle2 X0 Y0 I0 J10 Z5\nlinear X20\n");
  is_optimal("ZX and YZ", in_space(), speed_words(100) + "normal J-1\ninc\nlinear X10\ncircle1 X5 Z5 I0 K5\nlinear Z10\nnormal I-1\ncircle1 Y6 Z6 J6 K0\nlinear Y5\n");
  is_optimal("lines", in_space(), speed_words(150, 20) + "linear X20 Y3 Z-7\nlinear X-5 Y12 Z2\nlinear X-6 Y12 Z9\nlinear X9 Y-4 Z0\nlinear X0 Y0 Z0\n");
}

TEST_CASE("lookahead is optimal: through rotated axes, CoreXY and a gantry", "[property][lookahead]") {
  Machine turned, core_xy, gantry;
  turned.definitions = {"707.106781186548X+707.106781186548Y", "-707.106781186548X+707.106781186548Y+300"};
  core_xy.definitions = {"1000X+1000Y", "1000X-1000Y"};
  gantry.definitions = {"1000X", "1000Y", "1000X"};
  for (const auto& [name, machine] : std::map<std::string, Machine>{{"turned", turned}, {"CoreXY", core_xy}, {"gantry", gantry}}) {
    is_optimal("oval, " + name, machine, speed_words(200, 25) + oval());
    is_optimal("contour, " + name, machine, speed_words(50) + contour());
  }
}

TEST_CASE("lookahead is optimal: motors of very different limits", "[property][lookahead]") {
  for (const double ratio : {10.0, 100.0}) {
    Machine machine;
    machine.limits = {{500, 1}, {500 / std::sqrt(ratio), ratio}};
    is_optimal(fmt::format("oval, 1:{}", ratio), machine, speed_words(200, 25) + oval());
    is_optimal(fmt::format("contour, 1:{}", ratio), machine, speed_words(50) + contour());
    Machine units;
    units.definitions = {"1000X", fmt::format("{}Y", 1000 * ratio)};
    units.limits = {{500, 1}, {500 * ratio, 1 / ratio}};
    is_optimal(fmt::format("oval, units 1:{}", ratio), units, speed_words(200, 25) + oval(), ratio);
  }
  Machine free;
  free.limits = {{0, 1}, {0, 0}};
  is_optimal("no limit of Y", free, speed_words(200, 25) + oval());
}

TEST_CASE("lookahead is optimal: very short blocks", "[property][lookahead]") {
  for (const double ta_ms : {1.0, 5.0, 20.0}) is_optimal(fmt::format("10 um, ta{}", ta_ms), {}, speed_words(100, ta_ms) + short_blocks(0.01, 0.002, 400));
  is_optimal("10 um, straight", {}, speed_words(100) + short_blocks(0.01, 0, 300));
  is_optimal("one of 1 um", {}, speed_words(100) + "linear X0.001\n");
  is_optimal("one of 10 um with ramps", {}, speed_words(100, 20, 5) + "linear X0.01\n");
}

TEST_CASE("lookahead is optimal: random tangent paths", "[property][lookahead]") {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0, 1);
    Machine machine;
    machine.limits = {{500, 0.3 + 1.5 * unit(random)}, {30 + 270 * unit(random), 0.3 + 1.5 * unit(random)}};
    TangentLines path(6 * unit(random));
    for (int i = 0; i < 8; ++i) path.line(0.5 + 19 * unit(random)).arc(0.3 + 15 * unit(random), (unit(random) < 0.5 ? -1 : 1) * (0.1 + 2.4 * unit(random)));
    is_optimal(fmt::format("seed {}", seed), machine, speed_words(50 + 250 * unit(random)) + path.text());
  }
}

TEST_CASE("lookahead: a growing window comes to the optimum from above", "[property][lookahead]") {
  double last_ms = 1e9;
  for (const int window : {2, 5, 10, 20, 40, 67, 400}) {
    Machine machine;
    machine.window = window;
    const LookaheadCase run = run_lookahead_case(program_on(machine, speed_words(200, 25) + oval()), "&1 b1r", 0);
    INFO("window " << window);
    keeps_limits_and_path(run);
    CHECK(run.time_ms <= last_ms * (1 + 1e-9));
    last_ms = run.time_ms;
    if (window >= 67) CHECK(run.time_ms <= 1.003 * 2112.29);  // 4/3 of MaxSpeed * InvAmax / (2 * SegMoveTime), User's Manual p791
  }
}

/// Segments of programmed time that take many times as long when they are executed.
TEST_CASE("lookahead is optimal: segments that are stretched much", "[property][lookahead]") {
  is_optimal("oval ta25 ts10", {}, speed_words(200, 25, 10) + oval());
  is_optimal("contour ta5 ts2", {}, speed_words(50, 5, 2) + contour());
  is_optimal("corners ta5 ts2", {}, speed_words(150, 5, 2) + corners());
  is_optimal("reversals ta0 ts20", {}, speed_words(150, 0, 20) + reversals());
  is_optimal("contour F1000", {}, speed_words(1000) + contour());
  is_optimal("contour F5000", {}, speed_words(5000) + contour());
  is_optimal("oval R1 F450", {}, speed_words(450) + oval(6, 1));
  is_optimal("spiral", {}, speed_words(200) + "circle2 X-5 Y0 I10 J0\ncircle1 X20 Y0 I10\n");
  Machine slow;
  slow.limits = {{50, 1}, {30, 1}};
  is_optimal("slow motors", slow, speed_words(200, 25) + oval());
}
