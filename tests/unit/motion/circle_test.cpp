#include "runtime/motion/circle.h"

#include <cmath>
#include <numbers>
#include <random>

#include <catch2/catch.hpp>

#include "tests/unit/motion/scenario.h"

using namespace pmac::motion;
using namespace pmac::motion::test;
using std::numbers::pi;

namespace {

Arc arc_of(const MotionCommand& command, const AxisVector& start, const PipelineConfig& config = {}) {
  AxisVector end = start;
  for (std::size_t axis = 0; axis < kAxisCount; ++axis)
    if (command.axes >> axis & 1) end[axis] = command.target_uu[axis];
  auto result = make_arc(command, start, end, config);
  REQUIRE(std::holds_alternative<Arc>(result));
  return std::get<Arc>(result);
}

bool is_refused(const MotionCommand& command, const AxisVector& start, const PipelineConfig& config = {}) {
  AxisVector end = start;
  end[kX] = command.target_uu[kX];
  end[kY] = command.target_uu[kY];
  auto result = make_arc(command, start, end, config);
  const auto* fault = std::get_if<pmac::runtime::Fault>(&result);
  return fault && fault->kind == pmac::runtime::FaultKind::kCircleRadius;
}

AxisVector point_at(const Arc& arc, double u) {
  CurvePoint point;
  evaluate(arc.curve, u, point);
  return point.position;
}

MotionCommand by_radius(bool clockwise, double x, double y, double r) { return Program().arc_r(clockwise, x, y, r).commands[0]; }
MotionCommand by_center(bool clockwise, double x, double y, double i, double j) {
  return Program().arc_ij(clockwise, x, y, i, j).commands[0];
}

}  // namespace

TEST_CASE("circle: clockwise about normal k-1 is clockwise seen from above", "[motion][circle]") {
  const Arc cw = arc_of(by_center(true, 2, 14, 1, 0), at_xy(1, 13));  // contour example: quarter to the right
  CHECK(cw.curve.sweep_rad == Approx(pi / 2));
  CHECK(point_at(cw, 0.5)[kX] == Approx(2 - std::sqrt(0.5)));
  CHECK(point_at(cw, 0.5)[kY] == Approx(13 + std::sqrt(0.5)));
  const Arc ccw = arc_of(by_center(false, 2, 14, 1, 0), at_xy(1, 13));
  CHECK(ccw.curve.sweep_rad == Approx(3 * pi / 2));
}

TEST_CASE("circle: the oval's half turn by radius has c = 2R", "[motion][circle]") {
  const Arc arc = arc_of(by_radius(false, 60, 20, 10), at_xy(60, 0));
  CHECK(arc.length_uu == Approx(10 * pi));
  CHECK(point_at(arc, 0.5)[kX] == Approx(70));
  CHECK(point_at(arc, 0.5)[kY] == Approx(10));
}

TEST_CASE("circle: start equal to end is a full turn by centre, and refused by radius", "[motion][circle]") {
  CHECK(arc_of(by_center(true, 1, 1, 2, 0), at_xy(1, 1)).curve.sweep_rad == Approx(2 * pi));
  CHECK(is_refused(by_radius(true, 1, 1, 5), at_xy(1, 1)));
}

TEST_CASE("circle: a chord longer than the diameter is a half turn unless a radius error limit forbids it", "[motion][circle]") {
  const Arc arc = arc_of(by_radius(true, 10, 0, 4), at_xy(0, 0));
  CHECK(arc.curve.sweep_rad == Approx(pi));
  CHECK(arc.curve.radius == Approx(5));
  PipelineConfig config;
  config.radius_error_limit_uu = 0.5;
  CHECK(is_refused(by_radius(true, 10, 0, 4), at_xy(0, 0), config));
  CHECK(is_refused(by_center(true, 10, 0, 4, 0), at_xy(0, 0), config));
}

TEST_CASE("circle: an end point off the circle makes a spiral that meets it", "[motion][circle]") {
  const Arc arc = arc_of(by_center(false, -3, 0, -2, 0), at_xy(2, 0));  // about (0,0), radius 2 to 3
  CHECK(arc.curve.radius_change == Approx(1));
  CHECK(arc.length_uu == Approx(pi * 2.5));
  const AxisVector middle = point_at(arc, 0.5), end = point_at(arc, 1 - 1e-12);
  CHECK(std::hypot(middle[kX], middle[kY]) == Approx(2.5));
  CHECK(end[kX] == Approx(-3));
  CHECK(end[kY] == Approx(0).margin(1e-9));
}

TEST_CASE("circle: random chords end at their end point, on the right side, on the circle", "[motion][circle]") {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-50, 50), more(1.0, 4.0);
  for (int i = 0; i < 3000; ++i) {
    const AxisVector start = at_xy(place(random), place(random));
    const double x = place(random), y = place(random);
    const bool clockwise = i % 2 == 0;
    const double chord = std::hypot(x - start[kX], y - start[kY]);
    const double radius = (i % 4 < 2 ? 1 : -1) * more(random) * chord / 2;
    const Arc arc = arc_of(by_radius(clockwise, x, y, radius), start);
    CHECK((radius > 0 ? arc.curve.sweep_rad <= pi + 1e-6 : arc.curve.sweep_rad >= pi - 1e-6));
    CHECK(arc.curve.radius == Approx(std::abs(radius)));
    const AxisVector end = point_at(arc, 1 - 1e-13);
    CHECK(std::hypot(end[kX] - x, end[kY] - y) < 1e-9);
    const AxisVector quarter = point_at(arc, 0.01);
    const double turn = (quarter[kX] - start[kX]) * (arc.curve.center[1] - start[kY]) -
                        (quarter[kY] - start[kY]) * (arc.curve.center[0] - start[kX]);
    CHECK((turn > 0) == !clockwise);
  }
}

TEST_CASE("circle: a helix counts its lift, other axes run along", "[motion][circle]") {
  MotionCommand command = by_center(false, -5, 0, -5, 0);
  command.axes |= 1u << kZ | 1u << kC;
  command.target_uu[kZ] = 6;
  command.target_uu[kC] = 90;
  const Arc arc = arc_of(command, at_xy(5, 0));
  const AxisVector middle = point_at(arc, 0.5);
  CHECK(middle[kZ] == Approx(3));
  CHECK(middle[kC] == Approx(45));
  CHECK(middle[kY] == Approx(5));
  CurvePoint point;
  evaluate(arc.curve, 0.3, point);
  CurvePoint near;
  evaluate(arc.curve, 0.3 + 1e-6, near);
  for (const std::size_t axis : {kX, kY, kZ, kC}) {
    CHECK((near.position[axis] - point.position[axis]) / 1e-6 == Approx(point.d1[axis]).margin(1e-3));
    CHECK((near.d1[axis] - point.d1[axis]) / 1e-6 == Approx(point.d2[axis]).margin(1e-3));
  }
}

TEST_CASE("circle: other planes turn by the right hand about their normal", "[motion][circle]") {
  MotionCommand command;
  command.kind = CommandKind::kCircle;
  command.clockwise = true;
  command.normal = {0, -1, 0};  // ZX plane
  command.axes = 1u << kX | 1u << kZ;
  command.target_uu[kX] = 0;
  command.target_uu[kZ] = 1;
  command.has_center = true;
  command.center_uu = {-1, 0, 0};
  AxisVector start{};
  start[kX] = 1;
  const Arc arc = arc_of(command, start);  // X to Z, about -Y by the right hand: a quarter
  CHECK(arc.curve.sweep_rad == Approx(pi / 2));
  CHECK(point_at(arc, 0.5)[kZ] == Approx(std::sqrt(0.5)));
}
