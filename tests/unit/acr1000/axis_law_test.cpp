// The position law of CIRCLE and MOV. End points are the P29 values of the manual's own programs (chapter 8); way points follow from
// X = Xc + R cos(phi - theta), Y = Yc + R sin(phi - theta), the circle in the plane that the two axes are made from.
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "runtime/acr1000/axis_law.h"

using namespace pmac::acr1000;

namespace {

AxisLaw circle(double start, double end, CircleArguments arguments) { return {true, start, end, arguments}; }

struct Pair { const char* name; AxisLaw x, y; };

std::vector<Pair> worked_examples() {
  return {{"full circle", circle(0, 0, {1, 10000, 10000, 0, 62832}), circle(0, 0, {1, 10000, 0, -10000, 62832})},
          {"contour arc 1", circle(0, 34142, {1, 20000, -20000, 0, 47124}), circle(20000, 34142, {1, 20000, 0, 20000, 47124})},
          {"contour arc 2", circle(34142, 68284, {1, 20000, -14142, 14142, 47124}), circle(34142, 20000, {1, 20000, 14142, 14142, 47124})},
          {"ellipse", circle(0, 0, {1, 20000, 20000, 0, 125664}), circle(0, 0, {1, 10000, 0, -10000, 62832})}};
}

}  // namespace

TEST_CASE("CIRCLE: every worked example ends within half a pulse of its P29", "[acr1000]") {
  for (const Pair& pair : worked_examples()) {
    CAPTURE(pair.name);
    CHECK(std::abs(computed_end_pulses(pair.x) - pair.x.end_pulses) < 0.5);
    CHECK(std::abs(computed_end_pulses(pair.y) - pair.y.end_pulses) < 0.5);
    CHECK(at(pair.x, 1).position_pulses == pair.x.end_pulses);
    CHECK(at(pair.y, 1).position_pulses == pair.y.end_pulses);
    CHECK(at(pair.x, 0).position_pulses == Approx(pair.x.start_pulses).margin(1e-11));
  }
}

TEST_CASE("CIRCLE: two cards keep the radius to 1e-9", "[acr1000]") {
  for (const Pair& pair : worked_examples()) {
    CAPTURE(pair.name);
    const double xc = centre_pulses(pair.x), yc = centre_pulses(pair.y);
    const double rx = amplitude_pulses(pair.x.circle), ry = amplitude_pulses(pair.y.circle);
    for (int k = 0; k < 10000; ++k) {
      const double dx = (at(pair.x, k / 10000.0).position_pulses - xc) / rx, dy = (at(pair.y, k / 10000.0).position_pulses - yc) / ry;
      REQUIRE(std::abs(std::hypot(dx, dy) - 1) < 1e-9);
    }
  }
}

TEST_CASE("CIRCLE: way points at the quarters", "[acr1000]") {
  struct Way { double quarter, x, y; };
  const std::vector<std::vector<Way>> ways = {
      {{0.25, -10000.04, -10000}, {0.5, -20000, 0.07}, {0.75, -9999.89, 10000}},
      {{0.25, 3370.62, 31111.43}, {0.5, 12346.38, 38477.61}, {0.75, 23901.89, 39615.69}},
      {{0.25, 44382.26, 39615.52}, {0.5, 55937.65, 38477.39}, {0.75, 64913.28, 31111.23}},
      {{0.25, -20000.07, -10000}, {0.5, -40000, 0.07}, {0.75, -19999.78, 10000}}};
  const std::vector<Pair> pairs = worked_examples();
  for (std::size_t n = 0; n < pairs.size(); ++n)
    for (const Way& way : ways[n]) {
      CAPTURE(pairs[n].name, way.quarter);
      CHECK(at(pairs[n].x, way.quarter).position_pulses == Approx(way.x).margin(0.006));
      CHECK(at(pairs[n].y, way.quarter).position_pulses == Approx(way.y).margin(0.006));
    }
}

TEST_CASE("CIRCLE: rot -1 turns counter-clockwise about the same centre", "[acr1000]") {
  // A quarter from (10000, 0) about the origin ends at (0, 10000); the printed P29 formula with its rot factor gives (20000, -10000).
  const AxisLaw x = circle(10000, 0, {-1, 10000, 10000, 0, 15708}), y = circle(0, 10000, {-1, 10000, 0, -10000, 15708});
  CHECK(std::abs(computed_end_pulses(x)) < 0.5);
  CHECK(std::abs(computed_end_pulses(y) - 10000) < 0.5);
  CHECK(centre_pulses(x) == 0);
  CHECK(centre_pulses(y) == 0);
  CHECK(at(x, 0.5).position_pulses == Approx(7071.07).margin(0.1));
  CHECK(at(y, 0.5).position_pulses == Approx(7071.07).margin(0.1));
}

TEST_CASE("CIRCLE: the sine of one axis swings from its start to twice the radius below and back", "[acr1000]") {
  const AxisLaw sine = circle(0, 0, {1, 10000, 10000, 0, 62832});
  double low = 0, high = -1e9;
  for (int k = 0; k <= 100000; ++k) {
    const double p = at(sine, k / 100000.0).position_pulses;
    low = std::min(low, p);
    high = std::max(high, p);
  }
  CHECK(low == Approx(-20000).margin(0.001));
  CHECK(high == 0);
}

TEST_CASE("axis law: the derivatives are those of the position", "[acr1000]") {
  const double h = 1e-5;
  for (const AxisLaw& law : {circle(34142, 68284, {1, 20000, -14142, 14142, 47124}), circle(5, 7, {-1, 300, 20, -299, 900}), AxisLaw{false, 100, -25000, {}}})
    for (const double u : {0.1, 0.45, 0.9}) {
      const double before = at(law, u - h).position_pulses, after = at(law, u + h).position_pulses;
      CHECK(at(law, u).d1 == Approx((after - before) / (2 * h)).epsilon(1e-7));
      CHECK(at(law, u).d2 == Approx((after - 2 * at(law, u).position_pulses + before) / (h * h)).epsilon(1e-4).margin(1));
    }
}

TEST_CASE("axis law: the manual's line takes Y along at a quarter of X", "[acr1000]") {
  const AxisLaw y{false, 0, 25000, {}};
  CHECK(at(y, 0.5).position_pulses == 12500);
  CHECK(own_length_pulses(y) == 25000);
  CHECK(own_length_pulses({false, 0, -25000, {}}) == 25000);
  CHECK(own_length_pulses(circle(0, 0, {1, 10000, 10000, 0, 62832})) == 62832);
}
