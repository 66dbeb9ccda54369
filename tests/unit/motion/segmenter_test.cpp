// Segments in motor space: contour error against the programmed lines and arcs, kinematic routines, smoothing.
#include <numbers>
#include <random>

#include <catch2/catch.hpp>

#include "tests/unit/motion/plane_path.h"
#include "tests/unit/motion/scara.h"
#include "tests/unit/motion/scenario.h"

using namespace pmac::motion;
using namespace pmac::motion::test;

namespace {

PipelineConfig segmented(double segment_ms = 5) {
  PipelineConfig config = config_xy(1000);
  config.segment_time_ms = segment_ms;
  return config;
}

/// The same through a routine.
PipelineConfig through_routine(PipelineConfig config) {
  config.map.inverse = [](const AxisVector& axis, double* motor, SourceLine) -> std::optional<pmac::runtime::Fault> {
    motor[0] = 1000 * axis[kX];
    motor[1] = 1000 * axis[kY];
    return std::nullopt;
  };
  return config;
}

}  // namespace

TEST_CASE("contour and oval stay within 1 um of their lines and arcs at servo rate", "[motion][segmenter]") {
  CHECK(contour_error(run(segmented(), contour(), at_xy(1, 4)), contour_shape(), 1000) < 1e-3);
  CHECK(contour_error(run(segmented(), oval()), oval_shape(), 1000) < 1e-3);
}

TEST_CASE("segments meet in position and velocity, and last exactly the sequence", "[motion][segmenter]") {
  for (const FineInterpolation fine : {FineInterpolation::kThrough, FineInterpolation::kBspline}) {
    PipelineConfig config = segmented(7);
    config.fine = fine;
    const Run r = run(config, contour(), at_xy(1, 4));
    double time = 0;
    for (std::size_t i = 0; i < r.segments.size(); ++i) {
      const Segment& s = r.segments[i];
      CHECK(s.start_ms == Approx(time).margin(1e-9));
      time += s.duration_ms;
      if (i + 1 == r.segments.size()) continue;
      for (std::size_t m = 0; m < 2; ++m) {
        CHECK(s.motor[m].position(s.duration_ms) == Approx(r.segments[i + 1].motor[m].c0).margin(1e-7));
        CHECK(s.motor[m].velocity(s.duration_ms) == Approx(r.segments[i + 1].motor[m].c1).margin(1e-6));
      }
    }
    CHECK(time == Approx(2010));
    CHECK(r.position[0].back() == Approx(1000));
    CHECK(r.position[1].back() == Approx(4000));
  }
}

TEST_CASE("the B-spline cuts an arc by V^2 T^2 / (6 R)", "[motion][segmenter]") {
  PipelineConfig config = segmented(5);
  config.fine = FineInterpolation::kBspline;
  Program p;
  p.feed(200).ta(50).arc_ij(false, 10, 0, -10, 0);
  const Run r = run(config, p, at_xy(10, 0));
  const std::size_t middle = r.position[0].size() / 2;
  const double radius = std::hypot(r.position[0][middle], r.position[1][middle]) / 1000;
  CHECK(10 - radius == Approx(0.2 * 0.2 * 25 / 60).epsilon(0.02));  // 0.0167 mm
}

TEST_CASE("SCARA: a straight line at F100 is straight to 1e-3 mm", "[motion][segmenter]") {
  for (const double ts : {0.0, 30.0}) {
    PipelineConfig config = scara_config();
    config.segment_time_ms = 5;
    const Run r = run(config, Program().feed(100).ta(50).ts(ts).xy(300, 400), at_xy(500, 0));
    double worst = 0;
    for (std::size_t k = 0; k < r.position[0].size(); ++k) {
      const auto [x, y] = scara_forward(r.position[0][k], r.position[1][k]);
      worst = std::max(worst, std::abs((x - 500) * 400 + y * 200) / std::hypot(400, 200));
    }
    CHECK(worst < 1e-3);
    CHECK(worst < 1e-6);  // what it is: 1e-7
    const auto [x, y] = scara_forward(r.position[0].back(), r.position[1].back());
    CHECK(std::hypot(x - 300, y - 400) < 1e-9);
  }
}

TEST_CASE("SCARA: motors follow the image of lines, arcs and corners", "[motion][segmenter]") {
  PipelineConfig config = scara_config();
  config.segment_time_ms = 5;
  Program p;
  p.feed(100).ta(50).ts(20).xy(300, 400).arc_r(false, 200, 500, -80).xy(100, 500).xy(100, 400).arc_ij(true, 100, 400, 20, 10).xy(500, 0);
  const Run r = run(config, p, at_xy(500, 0));
  std::size_t i = 0;
  double worst = 0;
  for (std::size_t k = 0; k < r.position[0].size(); ++k) {
    const double t = std::min(static_cast<double>(k) * r.period_ms, r.end_ms);
    while (i + 1 < r.pieces.size() && r.pieces[i + 1].start_ms <= t) ++i;
    const PathPoint point = evaluate(r.pieces[i], t - r.pieces[i].start_ms);
    double motor[2];
    REQUIRE_FALSE(config.map.inverse(point.position, motor, {}));
    for (std::size_t m = 0; m < 2; ++m) worst = std::max(worst, std::abs(motor[m] - r.position[m][k]));
  }
  CHECK(worst < 1e-5);  // degrees
}

TEST_CASE("kinematics are called once a node, and twice more in corners", "[motion][segmenter]") {
  PipelineConfig config = scara_config();
  config.segment_time_ms = 5;
  int calls = 0;
  auto inverse = config.map.inverse;
  config.map.inverse = [&](const AxisVector& a, double* m, SourceLine s) { return ++calls, inverse(a, m, s); };
  const Run r = run(config, Program().feed(100).ta(50).xy(300, 400).xy(300, 450), at_xy(500, 0));
  // Nodes are one more than segments, one call is for reset(). The corner of 50 ms has 11 nodes, with two where it begins and ends between
  // multiples of 5 ms; in them velocities are central differences.
  CHECK(calls <= static_cast<int>(r.segments.size()) + 2 + 2 * 13);
}

TEST_CASE("a routine that does what axis definitions do gives their motion, also on arcs with two or three nodes", "[motion][segmenter]") {
  for (const double segment_ms : {2.0, 5.0, 10.0}) {
    Program p;   // full circles of 57, 62 and 73 ms: corners of 55 ms leave 2 to 18 ms of them
    p.feed(260).ta(50).ts(5).xy(12, 0).arc_ij(true, 12, 0, 2.32, 0.44).xy(-4, -9).arc_ij(false, -4, -9, 2.5, 0.6).xy(3, -9).arc_ij(false, 3, -9, 3, 0.3).xy(0, 0);
    const Run a = run(segmented(segment_ms), p), b = run(through_routine(segmented(segment_ms)), p);
    REQUIRE(a.position[0].size() == b.position[0].size());
    double apart_mu = 0;
    for (std::size_t m = 0; m < 2; ++m)
      for (std::size_t k = 0; k < a.position[m].size(); ++k) apart_mu = std::max(apart_mu, std::abs(a.position[m][k] - b.position[m][k]));
    CHECK(apart_mu < 1e-3);
  }
}

TEST_CASE("motors stand exactly still in a delay, and lookahead takes it at full rate", "[motion][segmenter]") {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> at(-20, 20), ms(1, 40);
  for (int i = 0; i < 200; ++i) {
    Program p;   // at half the motors' acceleration: 57 mu/ms in 60 ms and more
    p.feed(40 * std::sqrt(2)).ta(60 + ms(random)).ts(i % 2 * ms(random)).xy(at(random), at(random)).delay(200 + ms(random)).xy(at(random), at(random));
    for (PipelineConfig config : {segmented(ms(random)), through_routine(segmented(ms(random)))}) {
      const Run plain = run(config, p);
      const double from_ms = plain.timings[1].start_ms + 70, to_ms = plain.timings[1].end_ms - 70;   // half of ta and ts
      for (const Segment& s : plain.segments)
        if (s.start_ms >= from_ms && s.start_ms + s.duration_ms <= to_ms)
          for (const MotorCubic& q : s.motor) CHECK((q.c1 == 0 && q.c2 == 0 && q.c3 == 0));
      config.lookahead = true;
      config.lookahead_segments = 100;
      set_limits(config, 500, 4);
      CHECK(run(config, p).end_ms == Approx(plain.end_ms).margin(1e-6));
    }
  }
}

TEST_CASE("an unreachable place stops production with the line of its move", "[motion][segmenter]") {
  for (const bool lookahead : {false, true}) {
    PipelineConfig config = scara_config();
    config.segment_time_ms = 5;
    config.lookahead = lookahead;
    config.lookahead_segments = 100;
    set_limits(config, 0.2, 0.001);
    const Run r = run(config, Program().feed(100).ta(50).xy(300, 400).xy(600, 400).xy(0, 500), at_xy(500, 0));
    REQUIRE(r.fault);
    CHECK(r.fault->kind == pmac::runtime::FaultKind::kInverseKinematics);
    CHECK(r.fault->source.line == 2);
    if (!lookahead) continue;
    for (std::size_t m = 0; m < 2; ++m) {  // with lookahead it comes to rest within the limits
      CHECK(r.max_accel(m) <= 0.001 * 1.001);
      CHECK(r.velocity[m].back() == 0);
    }
  }
}

TEST_CASE("unsegmented moves through kinematics go straight in motor space", "[motion][segmenter]") {
  const Run r = run(scara_config(), Program().feed(100).ta(50).xy(300, 400), at_xy(500, 0));
  const std::size_t last = r.position[0].size() - 1, k = last / 3;
  const double share = (r.position[0][k] - r.position[0][0]) / (r.position[0][last] - r.position[0][0]);
  CHECK(r.position[1][k] == Approx(r.position[1][0] + share * (r.position[1][last] - r.position[1][0])));
}
