// The lookahead: limits at servo rate, time against the time-optimal motion, streaming. Optimal times: closed form for straight
// lines, and a dense phase-plane integration of the geometric path (tests/reference/time_optimal.h).
#include "runtime/motion/lookahead.h"

#include <numbers>
#include <random>

#include <catch2/catch.hpp>

#include "tests/reference/time_optimal.h"
#include "tests/unit/motion/plane_path.h"
#include "tests/unit/motion/scenario.h"

using namespace pmac::motion;
using namespace pmac::motion::test;
using pmac::reference::PlanePiece;
using pmac::reference::TimeOptimal;
using std::numbers::pi;

namespace {

/// 1000 mu/mm, 5 ms segments, MaxSpeed 500 mu/ms, 1 mu/ms^2 (1000 mm/s^2).
PipelineConfig with_lookahead(int window = 200) {
  PipelineConfig config = config_xy(1000);
  config.segment_time_ms = 5;
  config.lookahead = true;
  config.lookahead_segments = window;
  set_limits(config, 500, 1);
  return config;
}

void check_limits(const Run& r, double speed = 500, double accel = 1) {
  REQUIRE_FALSE(r.fault);
  for (std::size_t m = 0; m < r.position.size(); ++m) {
    CHECK(r.max_speed(m) <= 1.001 * speed);
    CHECK(r.max_accel(m) <= 1.001 * accel);
  }
}

/// A tangent path: the program, its geometry for the reference, its place.
struct TangentPath {
  Program program;
  std::vector<PlanePiece> pieces;
  double x = 0, y = 0, heading = 0;

  void line(double length) {
    x += length * std::cos(heading);
    y += length * std::sin(heading);
    program.xy(x, y);
    pieces.push_back({heading, length, 0});
  }
  void arc(double radius, double turn) {  // turn > 0: left
    const double side = turn > 0 ? 1 : -1;
    const double cx = -side * radius * std::sin(heading), cy = side * radius * std::cos(heading);
    const double next = heading + turn;
    pieces.push_back({heading, radius * std::abs(turn), side / radius});
    const double to_x = x + cx + side * radius * std::sin(next), to_y = y + cy - side * radius * std::cos(next);
    program.arc_ij(turn < 0, to_x, to_y, cx, cy);
    x = to_x;
    y = to_y;
    heading = next;
  }
};

TangentPath zigzag() {  // 201 legs of 10 mm, 200 right angles rounded with 0.5 mm
  TangentPath path;
  path.program.feed(200).ta(0);
  for (int leg = 0; leg < 201; ++leg) {
    path.line(leg == 0 || leg == 200 ? 9.5 : 9);
    if (leg < 200) path.arc(0.5, leg % 2 == 0 ? pi / 2 : -pi / 2);
  }
  return path;
}

}  // namespace

TEST_CASE("lookahead: the oval takes the time-optimal time within 0.3 %, keeps limits and path", "[motion][lookahead]") {
  const Run r = run(with_lookahead(), oval());
  check_limits(r);
  const double optimum = 1000 * (0.65 + 0.85 + 8 * std::sqrt(2 * 0.010 * (1 - std::sqrt(0.5)) / 1));  // 2112.29 ms
  CHECK(r.end_ms >= optimum * 0.9999);
  CHECK(r.end_ms <= optimum * 1.003);
  CHECK(contour_error(r, oval_shape(), 1000) < 1e-3);
}

TEST_CASE("lookahead: the contour's geometry at F50 without ramps", "[motion][lookahead]") {
  const Run r = run(with_lookahead(), contour(50, 0, 0), at_xy(1, 4));
  check_limits(r);
  CHECK(r.end_ms <= 1097.48 * 1.003);
  CHECK(r.end_ms >= 1097.48 * 0.9999);
  CHECK(contour_error(r, contour_shape(), 1000) < 1e-3);
}

TEST_CASE("lookahead: 201 legs with rounded corners at F200", "[motion][lookahead]") {
  const Run r = run(with_lookahead(), zigzag().program);
  check_limits(r);
  CHECK(r.end_ms <= 37088.6 * 1.003);
  CHECK(r.end_ms >= 37088.6 * 0.9999);
}

TEST_CASE("lookahead: straight lines take the closed-form time", "[motion][lookahead]") {
  for (const double ta : {0.0, 25.0}) {
    const Run r = run(with_lookahead(), Program().feed(400).ta(ta).ts(0).xy(20, 0));
    check_limits(r);
    CHECK(r.end_ms == Approx(2 * std::sqrt(20000.0)).epsilon(1e-4));  // accelerate half of it, brake the other half
  }
}

TEST_CASE("lookahead: a step in feed rate alone does not stop the motion", "[motion][lookahead]") {
  const Run r = run(with_lookahead(), Program().ta(0).feed(100).xy(20, 0).feed(50).xy(40, 0).feed(200).xy(80, 0));
  check_limits(r);
  // 0-100: 5 mm, cruise, 100-50: 3.75 mm; 400 ms at 50; 50-200: 18.75 mm, cruise, 200-0: 20 mm.
  const double closed = 100 + 112.5 + 50 + 400 + 150 + (40 - 18.75 - 20) / 0.2 + 200;
  CHECK(r.end_ms == Approx(closed).epsilon(1e-3));
}

TEST_CASE("lookahead: agrees with a dense solver on random tangent paths", "[motion][lookahead]") {
  std::mt19937 random(17);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int n = 0; n < 12; ++n) {
    TangentPath path;
    const double feed = 50 + 250 * unit(random);
    path.heading = 2 * pi * unit(random);
    path.program.feed(feed).ta(0);
    for (int i = 0; i < 10; ++i) {
      path.line(3 + 20 * unit(random));
      path.arc(1 + 15 * unit(random), (unit(random) < 0.5 ? -1 : 1) * (0.3 + 2 * unit(random)));
    }
    path.line(5);
    const Run r = run(with_lookahead(), path.program);
    check_limits(r);
    const double optimum = TimeOptimal(path.pieces, feed, 1000, 0.001).solve();
    INFO("path " << n << " optimum " << optimum);
    CHECK(r.end_ms <= optimum * 1.003);  // the reference itself is some 1e-4 fast
    CHECK(r.end_ms >= optimum * 0.9995);
  }
}

TEST_CASE("lookahead: corners and random programs keep every limit at servo rate", "[motion][lookahead]") {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(-20, 20), feed(5, 300), unit(0, 1);
  for (int n = 0; n < 300; ++n) {
    Program p;
    p.feed(feed(random)).ta(unit(random) < 0.3 ? 0 : 100 * unit(random)).ts(unit(random) < 0.5 ? 0 : 50 * unit(random));
    for (int i = 0; i < 10; ++i) {
      const double kind = unit(random);
      if (unit(random) < 0.3) p.feed(feed(random));
      if (kind < 0.6) p.xy(place(random), place(random));
      if (kind >= 0.6 && kind < 0.9) p.arc_r(unit(random) < 0.5, place(random), place(random), 60);
      if (kind >= 0.9) p.delay(30 * unit(random));
    }
    PipelineConfig config = with_lookahead(n % 2 ? 40 : 200);
    set_limits(config, 80, 0.7);
    config.servo_period_ms = n % 3 == 0 ? 0.1 : kServoPeriod_ms;
    const Run r = run(config, p, {}, config.servo_period_ms);
    INFO("program " << n);
    check_limits(r, 80, 0.7);
  }
}

TEST_CASE("lookahead: streaming equals the whole path once the window covers the stopping distance", "[motion][lookahead]") {
  const Run whole = run(with_lookahead(100000), zigzag().program);
  for (const int window : {60, 100, 333}) {  // 500 ms to stop from MaxSpeed, half of it on average: 67 segments at the most
    const Run r = run(with_lookahead(window), zigzag().program);
    CHECK(r.end_ms == Approx(whole.end_ms).epsilon(1e-12));
    REQUIRE(r.position.size() == whole.position.size());
    for (std::size_t k = 0; k < r.position[0].size(); k += 7) CHECK(r.position[0][k] == Approx(whole.position[0][k]).margin(1e-6));
  }
}

TEST_CASE("lookahead: a short window is slower, never wrong", "[motion][lookahead]") {
  double last = 1e9;
  for (const int window : {1, 2, 5, 10, 20, 200}) {
    const Run r = run(with_lookahead(window), oval());
    check_limits(r);
    CHECK(r.end_ms <= last * (1 + 1e-9));
    last = r.end_ms;
  }
}

TEST_CASE("lookahead: limits hold at any sampling rate", "[motion][lookahead]") {
  for (const double period : {0.05, 0.2, 1.0, 2.0}) check_limits(run(with_lookahead(), oval(), {}, period));
}

TEST_CASE("lookahead: a fine polyline without ramps is passed without stopping, within the limits of the samples", "[motion][lookahead]") {
  for (const double step_mm : {0.02, 0.1}) {
    Program p;
    p.feed(200).ta(0);
    for (int i = 1; i <= 5000; ++i) p.xy(50 * std::sin(i * step_mm / 50), 50 - 50 * std::cos(i * step_mm / 50));
    const Run r = run(with_lookahead(), p);
    check_limits(r);
    // The circle itself allows 200 mm/s; part of the acceleration is kept for the steps in direction.
    CHECK(r.end_ms <= 1.4 * 5000 * step_mm / 0.2 + 400);  // 400: ramps
    PipelineConfig strict = with_lookahead();
    strict.servo_period_ms = 0;
    const Run stops = run(strict, p);
    check_limits(stops);
    CHECK(stops.end_ms > 5 * r.end_ms);
  }
}

TEST_CASE("lookahead: random polylines keep limits at servo rate", "[motion][lookahead]") {
  std::mt19937 random(23);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int n = 0; n < 40; ++n) {
    Program p;
    p.ta(unit(random) < 0.7 ? 0 : unit(random)).feed(50 + 250 * unit(random));
    double heading = 0, x = 0, y = 0;
    const double turn = 0.3 * unit(random) * unit(random), length = 2 * unit(random) * unit(random);
    for (int i = 0; i < 400; ++i) {
      if (unit(random) < 0.02) p.feed(50 + 250 * unit(random));
      heading += turn * (2 * unit(random) - 1) + (unit(random) < 0.01 ? 1.5 : 0);
      const double l = length * unit(random) + 0.005;
      p.xy(x += l * std::cos(heading), y += l * std::sin(heading));
    }
    INFO("polyline " << n);
    check_limits(run(with_lookahead(), p));
  }
}

TEST_CASE("lookahead: the path is that of the run without it", "[motion][lookahead]") {
  PipelineConfig off = with_lookahead();
  off.lookahead = false;
  const Run slow = run(with_lookahead(), contour(), at_xy(1, 4)), fast = run(off, contour(), at_xy(1, 4));
  REQUIRE(slow.segments.size() == fast.segments.size());
  for (std::size_t i = 0; i < slow.segments.size(); ++i) CHECK(slow.segments[i].motor[0].c0 == fast.segments[i].motor[0].c0);
}
