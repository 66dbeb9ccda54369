// Circles: the examples of the MCX514 manual p114, an independent slow walk around the circle, and random arcs.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <random>

#include "runtime/drives/mcx514/arc.h"

using namespace pmac::drives::mcx514;

namespace {

struct Walk {
  std::uint64_t events = 0, doubles = 0;
  AxisCounts position{}, pulses{};
  double worst = 0;            // largest |distance from the circle|
  Stop stop = Stop::kRunning;
  std::vector<int> quadrants;
};

/// Every event; the distance from the circle is computed from the positions alone. Positions are along ax1 and ax2.
Walk walk(const ArcSetting& setting) {
  Arc arc(setting);
  Walk w;
  const double radius = std::hypot(static_cast<double>(setting.center.ax1), static_cast<double>(setting.center.ax2));
  while (!arc.done() && w.events < 100'000'000) {
    const Event event = arc.next();
    ++w.events;
    const auto axis1 = static_cast<std::size_t>(setting.axis[0]), axis2 = static_cast<std::size_t>(setting.axis[1]);
    w.position[0] += event.step[axis1];
    w.position[1] += event.step[axis2];
    w.pulses[0] += std::abs(event.step[axis1]);
    w.pulses[1] += std::abs(event.step[axis2]);
    w.doubles += event.step[axis1] != 0 && event.step[axis2] != 0;
    const double x = static_cast<double>(w.position[0] - setting.center.ax1), y = static_cast<double>(w.position[1] - setting.center.ax2);
    w.worst = std::max(w.worst, std::abs(std::hypot(x, y) - radius));
  }
  w.stop = arc.stop();
  w.quadrants = arc.quadrants();
  return w;
}

/// The same end by passing over as much as possible.
Walk leap(const ArcSetting& setting) {
  Arc arc(setting);
  Walk w;
  while (!arc.done()) {
    const Skip skip = arc.skip(1'000'000'000'000);
    w.events += skip.events;
    w.doubles += skip.doubles;
    for (std::size_t axis = 0; axis < 2; ++axis) {
      w.position[axis] += skip.steps[axis];
      w.pulses[axis] += std::abs(skip.steps[axis]);
    }
    if (skip.events > 0) continue;
    const Event event = arc.next();
    ++w.events;
    w.doubles += event.step[0] != 0 && event.step[1] != 0;
    for (std::size_t axis = 0; axis < 2; ++axis) {
      w.position[axis] += event.step[axis];
      w.pulses[axis] += std::abs(event.step[axis]);
    }
  }
  w.stop = arc.stop();
  w.quadrants = arc.quadrants();
  return w;
}

ArcSetting setting_of(Plane center, Plane finish, bool clockwise) {
  ArcSetting setting;
  setting.center = center;
  setting.finish = finish;
  setting.clockwise = clockwise;
  return setting;
}

void check_same(const Walk& a, const Walk& b) {
  CHECK(a.events == b.events);
  CHECK(a.doubles == b.doubles);
  CHECK(a.position == b.position);
  CHECK(a.pulses == b.pulses);
  CHECK(a.stop == b.stop);
  CHECK(a.quadrants == b.quadrants);
}

/// The manual's rules word by word, angle by angle, without octant tables: only for small circles.
struct SlowArc {
  std::int64_t x, y, r2;
  int turn;                                   // +1 counter-clockwise
  std::uint64_t events = 0;

  static double angle(std::int64_t px, std::int64_t py) {
    const double a = std::atan2(static_cast<double>(py), static_cast<double>(px));
    return a < -1e-12 ? a + 2 * M_PI : a;
  }
  /// Boundaries are multiples of 45 degrees; 1e-9 rad is far less than any two different angles of small integers.
  static int octant(std::int64_t px, std::int64_t py, int direction) {
    const double eighths = angle(px, py) / (M_PI / 4);
    const double shifted = direction > 0 ? eighths + 1e-9 : eighths - 1e-9;
    return (static_cast<int>(std::floor(shifted)) + 8) % 8;
  }
  void step() {
    const int o = octant(x, y, turn);
    // The tangent at the middle of the octant tells both directions; the short axis is the one along which it is longer.
    const double middle = (o + 0.5) * M_PI / 4;
    const double tx = -turn * std::sin(middle), ty = turn * std::cos(middle);
    const std::int64_t dx = tx > 0 ? 1 : -1, dy = ty > 0 ? 1 : -1;
    const bool x_is_short = std::abs(tx) > std::abs(ty);
    const std::int64_t sx = x_is_short ? x + dx : x, sy = x_is_short ? y : y + dy;
    const std::int64_t f = sx * sx + sy * sy - r2, g = (x + dx) * (x + dx) + (y + dy) * (y + dy) - r2;
    const bool both = std::abs(g) < std::abs(f);
    x = both ? x + dx : sx;
    y = both ? y + dy : sy;
    ++events;
  }
};

}  // namespace

TEST_CASE("the clockwise example of the manual makes 270 degrees and ends exactly at its finish point", "[mcx514]") {
  const Walk w = walk(setting_of({5000, 0}, {5000, -5000}, true));
  CHECK(w.position == AxisCounts{5000, -5000, 0, 0});
  CHECK(w.stop == Stop::kShortAxis);
  CHECK(w.quadrants == std::vector<int>{3, 2, 1, 0, 7, 6});
  CHECK(w.events == 21213);        // 6 * 5000 / sqrt(2), an event for every pulse of the short axis
  CHECK(w.pulses == AxisCounts{15000, 15000, 0, 0});  // three quarters of the circle's bounding square
  CHECK(w.worst < 0.5);
}

TEST_CASE("the counter-clockwise example of the manual stops in quadrant 4 when axis 2 reaches 299", "[mcx514]") {
  const Walk w = walk(setting_of({-200, 500}, {-702, 299}, false));
  CHECK(w.position[1] == 299);
  CHECK(w.position[0] == -700);    // the point of the circle at 299: -200 - sqrt(538.5165^2 - 201^2) = -699.59
  CHECK(w.stop == Stop::kShortAxis);
  CHECK(w.quadrants == std::vector<int>{6, 7, 0, 1, 2, 3, 4});
  CHECK(w.events == 2287);
  CHECK(w.pulses == AxisCounts{1456, 1779, 0, 0});
  CHECK(w.doubles == 948);
  CHECK(w.worst < 0.5);
}

TEST_CASE("a finish point of (0,0) is a full circle", "[mcx514]") {
  for (const bool clockwise : {false, true}) {
    const Walk w = walk(setting_of({-538, 0}, {0, 0}, clockwise));
    CHECK(w.position == AxisCounts{});
    CHECK(w.pulses == AxisCounts{4 * 538, 4 * 538, 0, 0});  // around the bounding square
    CHECK(w.quadrants.size() == 8);
  }
  CHECK(walk(setting_of({-200, 500}, {0, 0}, false)).position == AxisCounts{});
}

TEST_CASE("a finish point that the circle does not reach ends the drive with its quadrant", "[mcx514]") {
  // Circle about (-200,500) with radius 538.5: in quadrant 4 axis 2 ends at 500 - 538.5 / sqrt(2) = 119, above the finish point's 0.
  const Walk w = walk(setting_of({-200, 500}, {-800, 0}, false));
  CHECK(w.stop == Stop::kEndOfQuadrant);
  CHECK(w.position == AxisCounts{-581, 119, 0, 0});
  CHECK(w.quadrants.back() == 4);
}

TEST_CASE("a finish point behind the start in the start's quadrant is almost a full turn away", "[mcx514]") {
  // Counter-clockwise from the right: the finish point lies just before the start.
  const Walk w = walk(setting_of({-1000, 0}, {0, -5}, false));
  CHECK(w.position == AxisCounts{0, -5, 0, 0});
  CHECK(w.quadrants == std::vector<int>{0, 1, 2, 3, 4, 5, 6, 7});
  const Walk same_octant = walk(setting_of({-1000, -100}, {1, -5}, false));
  CHECK(same_octant.quadrants.size() == 9);
  CHECK(same_octant.quadrants.front() == same_octant.quadrants.back());
}

TEST_CASE("small circles agree with a walk by angles, step by step", "[mcx514]") {
  for (std::int64_t cx = -6; cx <= 6; ++cx)
    for (std::int64_t cy = -6; cy <= 6; ++cy) {
      if (cx == 0 && cy == 0) continue;
      for (const bool clockwise : {false, true}) {
        Arc arc(setting_of({cx, cy}, {0, 0}, clockwise));
        SlowArc slow{-cx, -cy, cx * cx + cy * cy, clockwise ? -1 : 1};
        std::int64_t x = 0, y = 0;
        while (!arc.done()) {
          const Event event = arc.next();
          x += event.step[0];
          y += event.step[1];
          slow.step();
          REQUIRE(slow.events <= static_cast<std::uint64_t>(6 * std::sqrt(static_cast<double>(slow.r2)) + 8));
          REQUIRE(x - cx == slow.x);
          REQUIRE(y - cy == slow.y);
        }
      }
    }
}

TEST_CASE("every small arc ends, within six events for each pulse of the radius and half a pulse of the circle", "[mcx514]") {
  for (std::int64_t cx = -4; cx <= 4; ++cx)
    for (std::int64_t cy = -4; cy <= 4; ++cy)
      for (std::int64_t fx = -9; fx <= 9; ++fx)
        for (std::int64_t fy = -9; fy <= 9; ++fy) {
          if (cx == 0 && cy == 0) continue;
          for (const bool clockwise : {false, true}) {
            const Walk w = walk(setting_of({cx, cy}, {fx, fy}, clockwise));
            REQUIRE(w.stop != Stop::kRunning);
            REQUIRE(static_cast<double>(w.events) <= 6 * std::hypot(static_cast<double>(cx), static_cast<double>(cy)) + 4);
            REQUIRE(w.worst < 0.5);
          }
        }
}

TEST_CASE("100000 random arcs stay within one pulse of their circles and end in their finish quadrants", "[mcx514]") {
  std::mt19937_64 random(514);
  std::uniform_real_distribution<double> angle(0, 2 * M_PI), exponent(std::log(3.0), std::log(1200.0));
  double worst = 0;
  int by_short_axis = 0;
  for (int i = 0; i < 100'000; ++i) {
    const double radius = std::exp(exponent(random)), from = angle(random), to = angle(random);
    const Plane center{std::llround(radius * std::cos(from)), std::llround(radius * std::sin(from))};
    const Plane finish{center.ax1 + std::llround(radius * std::cos(to)), center.ax2 + std::llround(radius * std::sin(to))};
    if (center.ax1 == 0 && center.ax2 == 0) continue;
    ArcSetting setting = setting_of(center, finish, (i & 1) != 0);
    setting.axis = {i % 4, (i + 1 + i / 4 % 3) % 4};   // every pair of axes, either one first
    const Walk w = walk(setting);
    REQUIRE(w.stop != Stop::kRunning);
    worst = std::max(worst, w.worst);
    by_short_axis += w.stop == Stop::kShortAxis;
    if (w.stop != Stop::kShortAxis || radius < 8) continue;
    // The short axis is exact; the long one misses by at most the rounding of the finish point and of the path.
    REQUIRE(std::max(std::abs(w.position[0] - finish.ax1), std::abs(w.position[1] - finish.ax2)) <= 2);
  }
  INFO(worst);
  CHECK(worst <= 1.0);
  CHECK(worst < 0.5);            // of the rule in use
  CHECK(by_short_axis > 95'000);
}

TEST_CASE("passing over events gives the same pulses as making them", "[mcx514]") {
  std::mt19937_64 random(1);
  std::uniform_int_distribution<std::int64_t> coordinate(-30'000, 30'000);
  for (int i = 0; i < 300; ++i) {
    const ArcSetting setting = setting_of({coordinate(random), coordinate(random)}, {coordinate(random), coordinate(random)}, (i & 1) != 0);
    check_same(walk(setting), leap(setting));
  }
  check_same(walk(setting_of({5000, 0}, {5000, -5000}, true)), leap(setting_of({5000, 0}, {5000, -5000}, true)));
}

TEST_CASE("a full circle with the largest radius is passed over in no time and closes", "[mcx514]") {
  const Walk w = leap(setting_of({kLargestDistance, 0}, {0, 0}, true));
  CHECK(w.position == AxisCounts{});
  CHECK(w.pulses == AxisCounts{4 * kLargestDistance, 4 * kLargestDistance, 0, 0});
  CHECK(static_cast<double>(w.events) == Approx(8 * static_cast<double>(kLargestDistance) / std::sqrt(2.0)).epsilon(1e-8));
  const Walk corner = leap(setting_of({kLargestDistance, -kLargestDistance}, {0, 0}, false));
  CHECK(corner.position == AxisCounts{});
}

TEST_CASE("a square root is rounded to the nearest integer", "[mcx514]") {
  CHECK(rounded_root(0) == 0);
  CHECK(rounded_root(2) == 1);
  CHECK(rounded_root(3) == 2);   // 1.73
  CHECK(rounded_root(6) == 2);   // 2.449
  CHECK(rounded_root(7) == 3);   // 2.65
  const std::int64_t n = 1'518'500'249;          // about sqrt(2^61)
  CHECK(rounded_root(n * n + n) == n);
  CHECK(rounded_root(n * n + n + 1) == n + 1);
}

TEST_CASE("a helix spreads its further axes over the events of the circle and turns as often as it is told", "[mcx514]") {
  ArcSetting setting = setting_of({-1000, 0}, {0, 0}, false);
  setting.further_turns = 2;
  const auto events = static_cast<std::int64_t>(Arc(setting).remaining());
  Helix helix(setting, {0, 0, -600, 41}, events);
  AxisCounts at{};
  std::int64_t made = 0;
  double worst = 0;
  while (!helix.done()) {
    const Event event = helix.next();
    ++made;
    for (std::size_t axis = 0; axis < 4; ++axis) at[axis] += event.step[axis];
    worst = std::max(worst, std::abs(static_cast<double>(at[2]) + 600.0 * static_cast<double>(made) / static_cast<double>(events)));
  }
  CHECK(made == events);
  CHECK(at == AxisCounts{0, 0, -600, 41});
  CHECK(worst <= 0.5);
  CHECK(helix.quadrants().size() == 24);
}
