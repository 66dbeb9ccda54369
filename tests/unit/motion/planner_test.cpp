// Closed forms of blended sequences. Numbers: the vendor's example programs worked by hand (ramps of ta + ts, moves of L/F).
#include <random>

#include <catch2/catch.hpp>

#include "tests/reference/blender.h"
#include "tests/unit/motion/scenario.h"

using namespace pmac::motion;
using namespace pmac::motion::test;

namespace {

PipelineConfig unsegmented() { return config_xy(1000); }

PathPoint path_at(const Run& r, double time_ms) {
  std::size_t i = 0;
  while (i + 1 < r.pieces.size() && r.pieces[i + 1].start_ms <= time_ms) ++i;
  return evaluate(r.pieces[i], std::min(time_ms - r.pieces[i].start_ms, r.pieces[i].duration_ms));
}

}  // namespace

TEST_CASE("basic move: F5 ta500 over 10 units takes 2500 ms", "[motion][planner]") {
  // TM = 10/5 s = 2000 ms, ramps 500 ms: 2000 + 500/2 + 500/2. Peak 5 uu/s, 10 uu/s^2.
  const Run r = run(unsegmented(), Program().feed(5).ta(500).ts(0).xy(10, 0));
  CHECK(r.end_ms == 2500);
  CHECK(r.max_speed(0) == Approx(5));          // mu/ms at 1000 mu/uu
  CHECK(r.max_accel(0) == Approx(0.01).epsilon(1e-6));
  CHECK(r.position[0].back() == 10000);
}

TEST_CASE("S-curve move: 3000 ms, acceleration 10 and deceleration 5 uu/s^2", "[motion][planner]") {
  // ta500 ts250: T_acc 750; td1000 tsd250: T_dec 1250; TM 2000.
  const Run r = run(unsegmented(), Program().feed(5).ta(500).ts(250).td(1000).xy(10, 0));
  CHECK(r.end_ms == 3000);
  double accel = 0, decel = 0;
  for (double t = 0; t <= 3000; t += 0.25) {
    const double a = path_at(r, t).acceleration[kX] * 1e6;  // uu/s^2
    accel = std::max(accel, a);
    decel = std::min(decel, a);
  }
  CHECK(accel == Approx(10));
  CHECK(decel == Approx(-5));
}

TEST_CASE("simple move: ta500 td800 ts100 takes 2750 ms", "[motion][planner]") {
  CHECK(run(unsegmented(), Program().feed(5).ta(500).ts(100).td(800).xy(10, 0)).end_ms == 2750);
}

TEST_CASE("a short move lasts its acceleration time", "[motion][planner]") {
  CHECK(run(unsegmented(), Program().feed(50).ta(100).ts(50).xy(1, 0)).end_ms == 300);
  CHECK(run(unsegmented(), Program().feed(50).ta(100).ts(0).td(300).xy(1, 0)).end_ms == 400);  // (100 + 300)/2 twice
  CHECK(run(unsegmented(), Program().tm(0).ta(100).ts(0).xy(1, 0)).end_ms == 200);
}

TEST_CASE("move time: the slowest of feed axes and other axes counts", "[motion][planner]") {
  const auto time = [](double alt) {
    Program p;
    p.feed(100).ta(0).target({{kX, 30}, {kY, 40}, {kZ, 10}});
    p.commands[0].feed_axes = 1u << kX | 1u << kY;
    p.commands[0].alt_feed_uu = alt;
    return run(config_xy(1000, 3), p).end_ms;
  };
  CHECK(time(0) == Approx(500));
  CHECK(time(20) == Approx(500));
  CHECK(time(1) == Approx(10000));
  Program only_other;
  only_other.feed(10).ta(0).target({{kC, 90}});
  CHECK(run(unsegmented(), only_other).end_ms == Approx(90000));  // factory AltFeedRate 1
  only_other.commands[0].alt_feed_uu = 0;
  CHECK(run(unsegmented(), only_other).end_ms == Approx(9000));
  Program inverse_time;
  inverse_time.feed(4).ta(0).xy(123, 4);
  inverse_time.commands[0].inverse_time = true;
  CHECK(run(unsegmented(), inverse_time).end_ms == Approx(250));
  PipelineConfig clipped = unsegmented();
  clipped.max_feed_uu = 50;
  CHECK(run(clipped, Program().feed(100).ta(0).xy(30, 40)).end_ms == Approx(1000));
}

TEST_CASE("the middle of a blend lies Ta/8 + Ts^2/(24 Ta) times the change of velocity beside the corner", "[motion][planner]") {
  const double v = 0.05;  // uu/ms
  const Run r = run(unsegmented(), Program().feed(50).ta(100).ts(50).xy(20, 0).xy(20, 20));
  const double offset = v * (100.0 / 8 + 50.0 * 50 / 2400);
  const PathPoint middle = path_at(r, 75 + 400);
  CHECK(middle.position[kX] == Approx(20 - offset));
  CHECK(middle.position[kY] == Approx(offset));
  CHECK(middle.velocity[kX] == Approx(v / 2));
  CHECK(r.end_ms == Approx(150 + 800));
}

TEST_CASE("collinear moves at one speed are one motion", "[motion][planner]") {
  const Run one = run(unsegmented(), Program().feed(50).ta(100).ts(0).xy(40, 0));
  const Run two = run(unsegmented(), Program().feed(50).ta(100).ts(0).xy(15, 0).xy(40, 0));
  REQUIRE(one.end_ms == Approx(two.end_ms));
  for (std::size_t k = 0; k < one.position[0].size(); ++k) CHECK(two.position[0][k] == Approx(one.position[0][k]).margin(1e-8));
}

TEST_CASE("contour and oval last T_a/2 + sum of TM + T_d/2", "[motion][planner]") {
  PipelineConfig config = config_xy(1000);
  config.segment_time_ms = 5;
  const Run contour_run = run(config, contour(), at_xy(1, 4));
  CHECK(contour_run.end_ms == Approx(2010).epsilon(1e-12));  // 2 * 180 + 10 * 150 + 150
  CHECK(contour_run.position[0].back() == Approx(1000).epsilon(1e-12));
  CHECK(contour_run.position[1].back() == Approx(4000).epsilon(1e-12));
  CHECK(run(config, oval()).end_ms == Approx((240 + 20 * 3.14159265358979) / 0.2 + 25).epsilon(1e-12));  // 1539.16
  config.ramp_rule = RampRule::kTurbo;
  CHECK(run(config, contour(), at_xy(1, 4)).end_ms == Approx(1500));  // T_acc 100: 2 * 180 + 2 * 120 + 8 * 100 + 100
}

TEST_CASE("delay: a zero-distance move that blends", "[motion][planner]") {
  // Standstill = t - T_acc, total = T_a/2 + TM + t + TM + T_d/2.
  const Run r = run(unsegmented(), Program().feed(50).ta(100).ts(0).xy(20, 0).delay(300).xy(40, 0));
  CHECK(r.end_ms == Approx(50 + 400 + 300 + 400 + 50));
  CHECK(path_at(r, 50 + 400 + 50.001).velocity[kX] == Approx(0).margin(1e-12));
  CHECK(path_at(r, 50 + 400 + 249.999).velocity[kX] == Approx(0).margin(1e-12));
  CHECK(path_at(r, 50 + 400 + 260).velocity[kX] > 0);
  CHECK(run(unsegmented(), Program().feed(50).ta(100).ts(0).xy(20, 0).delay(30).xy(40, 0)).end_ms == Approx(50 + 400 + 100 + 400 + 50));
}

TEST_CASE("no_blend and a sharp corner stop; the moves then take their own ramps", "[motion][planner]") {
  Program p;
  p.feed(50).ta(100).ts(0).xy(20, 0).xy(20, 20);
  p.commands[0].no_blend = true;
  CHECK(run(unsegmented(), p).end_ms == Approx(2 * (400 + 100)));
  PipelineConfig config = unsegmented();
  config.corner_blend_bp = 0.5;  // 90 degrees: cosine 0 is below
  p.commands[0].no_blend = false;
  CHECK(run(config, p).end_ms == Approx(2 * (400 + 100)));
  config.corner_blend_bp = -0.5;
  CHECK(run(config, p).end_ms == Approx(800 + 100));
}

TEST_CASE("room: unsegmented moves stop where td is shorter than the blend, segmented ones shorten it", "[motion][planner]") {
  Program p;
  p.feed(50).ta(100).ts(0).xy(20, 0).ta(300).xy(20, 20);
  CHECK(run(unsegmented(), p).end_ms == Approx(400 + 100 + 400 + 300));
  PipelineConfig segmented = unsegmented();
  segmented.segment_time_ms = 5;
  CHECK(run(segmented, p).end_ms == Approx(50 + 400 + 400 + 150));
}

TEST_CASE("unsegmented moves keep MaxSpeed and InvAmax of every motor", "[motion][planner]") {
  PipelineConfig config = unsegmented();
  set_limits(config, 32, 0.1);
  const Run fast = run(config, Program().feed(200).ta(10).ts(0).xy(40, 0));
  CHECK(fast.max_speed(0) <= 32 * (1 + 1e-9));
  CHECK(fast.max_accel(0) <= 0.1 * (1 + 1e-6));
  CHECK(fast.end_ms == Approx(40000 / 32.0 + 320));
  const Run square = run(config, Program().feed(200).ta(10).ts(10).xy(40, 0).xy(40, 40).xy(0, 40).xy(0, 0));
  CHECK(std::max(square.max_accel(0), square.max_accel(1)) <= 0.1 * (1 + 1e-6));
  CHECK(square.position[0].back() == Approx(0).margin(1e-9));
}

TEST_CASE("faults name the line and leave the pipeline as it was", "[motion][planner]") {
  Pipeline pipeline;
  pipeline.reset(unsegmented(), {}, 0);
  Program p;
  p.feed(50).ta(100).xy(1, 0).xy(std::nan(""), 0).feed(-3).xy(2, 0);
  CHECK_FALSE(pipeline.add(p.commands[0]));
  const auto target = pipeline.add(p.commands[1]);
  REQUIRE(target);
  CHECK(target->kind == pmac::runtime::FaultKind::kBadTarget);
  CHECK(target->source.line == 2);
  CHECK(pipeline.add(p.commands[2])->source.line == 3);
  CHECK(pipeline.calculated_position()[kX] == 1);
  CHECK_FALSE(pipeline.end_sequence());
}

TEST_CASE("blends agree with velocities integrated sample by sample", "[motion][planner]") {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(-20, 20), unit(0, 1);
  for (int n = 0; n < 30; ++n) {
    const double ta = 20 + 80 * unit(random), ts = n % 3 == 0 ? 0 : ta * unit(random);
    Program p;
    p.ta(ta).ts(ts);
    std::vector<pmac::reference::BlendMove> moves;
    double x = 0, y = 0;
    for (int i = 0; i < 8; ++i) {
      const double tm = ta + ts + 200 * unit(random), to_x = place(random), to_y = place(random);
      p.tm(tm).xy(to_x, to_y);
      moves.push_back({to_x - x, to_y - y, tm, ta, ts});
      x = to_x;
      y = to_y;
    }
    const Run r = run(unsegmented(), p);
    double worst = 0;
    for (const auto& point : pmac::reference::blend(moves, 0.05)) {
      if (point.t_ms > r.end_ms) continue;
      const PathPoint mine = path_at(r, point.t_ms);
      worst = std::max({worst, std::abs(mine.position[kX] - point.x), std::abs(mine.position[kY] - point.y)});
    }
    CHECK(worst < 1e-5);  // Simpson over 0.05 ms steps that straddle the corners of r
  }
}

TEST_CASE("planner: ramps given as rates leave each end of a short move a blend of its own", "[motion][planner]") {
  // 10 mm/s into a delay of one segment, 5 ms, and out of it: each blend gets 5 ms, so 2 mu/ms^2 at the most.
  PipelineConfig config = config_xy();
  config.segment_time_ms = 5;
  const Run r = run(config, Program().feed(10).ta(-2000).xy(10, 0).delay(1).xy(12, 0), {}, 0.05);
  REQUIRE_FALSE(r.fault);
  CHECK(r.max_accel(0) <= 2.001);
}
