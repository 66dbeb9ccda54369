// The examples of programs/motion: each compiles without a message, runs to its end, and does what its first lines say.
#include <numbers>

#include "tests/unit/programs/bench.h"
#include "tests/unit/programs/geometry.h"

using namespace pmac::test;
using std::numbers::pi;

namespace {

/// Runs to its end, without a word.
struct Example : ProgramBench {
  explicit Example(const std::string& name) : ProgramBench("motion/" + name) {
    CHECK(diagnostics.empty());
    run("&1 b1r");
    CHECK(faults.empty());
    CHECK(refusals.empty());
    REQUIRE_FALSE(moves.empty());
  }
  double mm(std::size_t k, std::size_t motor) const { return motor_mu[k][motor] / 1000; }
};

double largest(const Example& example, std::size_t motor) {
  double result = -1e9;
  for (std::size_t k = 0; k < example.motor_mu.size(); ++k) result = std::max(result, example.mm(k, motor));
  return result;
}

}  // namespace

TEST_CASE("motion examples: pvt keeps to its circle by V^4 T^4 / (384 R^3)", "[programs]") {
  const Example example("1_pvt.pmc");
  const double R = 10, VT = 2 * pi * R / 16, x0 = VT / 2, bound = std::pow(VT, 4) / (384 * R * R * R);
  for (std::size_t k = 0; k < example.motor_mu.size(); ++k)
    if (const double t = example.time_ms[k]; t > 100 && t < 1700)
      CHECK(std::hypot(example.mm(k, 1) - x0, example.mm(k, 2) - 10) == Approx(R).margin(1.02 * bound));
}

TEST_CASE("motion examples: the spline passes its top at 10 - 20/6", "[programs]") {
  const Example example("2_spline.pmc");
  double top = 0;
  for (std::size_t k = 0; k < example.motor_mu.size(); ++k)
    if (example.time_ms[k] < 260) top = std::max(top, example.mm(k, 2));
  CHECK(top == Approx(10 - 20.0 / 6).margin(0.01));
  CHECK(example.mm(example.motor_mu.size() - 1, 1) == Approx(0.0).margin(1e-9));
}

TEST_CASE("motion examples: the tool keeps 4 from the plate, and its round corner becomes one of 14", "[programs]") {
  const Example example("3_cutter_compensation.pmc");
  const std::vector<Element> plate = {{0, 0, 0, 30}, {0, 30, 12, 30}, {12, 30, 12, 20}, {12, 20, 24, 20}, {24, 20, 24, 30}, {24, 30, 30, 30},
                                      {30, 30, 40, 20, 30, 20, -1}, {40, 20, 40, 0}, {40, 0, 0, 0}};
  double least = 1e9;
  const double from_ms = example.moves[3].start_ms + 100, to_ms = example.moves[15].end_ms - 100;  // without lead-in and lead-out
  for (std::size_t k = 0; k < example.motor_mu.size(); ++k)
    if (example.time_ms[k] > from_ms && example.time_ms[k] < to_ms) least = std::min(least, distance_to(plate, example.mm(k, 1), example.mm(k, 2)));
  CHECK(least == Approx(4.0).margin(1e-3));
  CHECK(largest(example, 1) == Approx(44.0).margin(1e-3));
  CHECK(largest(example, 2) == Approx(34.0).margin(1e-3));
}

TEST_CASE("motion examples: three flags", "[programs]") {
  const Example example("4_transformation.pmc");
  CHECK(example.moves.size() == 18);
  // The end of each flag, program X0 Y20: itself, turned about (40,0) and moved by (25,20), mirrored.
  const double c = std::cos(pi / 6), s = std::sin(pi / 6);
  const double ends[3][2] = {{0, 20}, {40 - 40 * c - 20 * s + 25, -40 * s + 20 * c + 20}, {60, 10}};
  std::size_t flag = 0;
  for (const auto& move : example.moves) {
    if (move.mode != "dwell") continue;
    const auto k = static_cast<std::size_t>(std::ceil((move.start_ms + 1) / example.machine->servo_period_ms()));
    CHECK(example.mm(k, 1) == Approx(ends[flag][0]).margin(1e-6));
    CHECK(example.mm(k, 2) == Approx(ends[flag][1]).margin(1e-6));
    ++flag;
  }
  CHECK(flag == 3);
}

TEST_CASE("motion examples: lookahead keeps 1 motor unit/ms^2 and uses it", "[programs]") {
  Example example("5_lookahead_corners.pmc");
  for (const int motor : {1, 2}) {
    CHECK(example.motor(motor).max_accel_mu_ms2 <= 1.001);
    CHECK(example.motor(motor).max_accel_mu_ms2 >= 0.99);
    CHECK(example.motor(motor).max_speed_mu_ms <= 250.0 * 1.001);
  }
}

TEST_CASE("motion examples: the helix climbs 5 a turn, the spiral ends at X-5", "[programs]") {
  const Example example("6_helix.pmc");
  CHECK(largest(example, 3) == Approx(10.0).margin(1e-6));
  const double turn = std::hypot(20 * pi, 5);
  CHECK(example.moves[1].length == Approx(turn).margin(1e-6));
  CHECK(example.moves[2].length == Approx(turn).margin(1e-6));
  CHECK(example.moves[3].length == Approx(7.5 * pi).margin(1e-6));
  CHECK(example.mm(example.motor_mu.size() - 1, 1) == Approx(10.0).margin(1e-6));
  CHECK(example.mm(example.motor_mu.size() - 1, 3) == Approx(0.0).margin(1e-6));
}
