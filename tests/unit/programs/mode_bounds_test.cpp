// Worked values and bounds of the modes: recipes of pvt segments, how far curves through and beside points are from arcs, splines of three
// times, turns about a point, spirals. Expected values are closed forms, named where they stand.
#include <numbers>

#include <fmt/format.h>

#include "tests/unit/programs/lines.h"

using namespace pmac::test;
using std::numbers::pi;

namespace {

constexpr double kServo_ms = 0.44274211;

double uu(const ProgramBench& bench, std::size_t k, std::size_t motor) { return bench.motor_mu[k][motor] / 1000; }

std::size_t tick_at(double time_ms) { return static_cast<std::size_t>(std::lround(time_ms / kServo_ms)); }

/// Speed of a motor (uu/ms) in the middle between two ticks around a time, and that time.
std::pair<double, double> speed_near(const ProgramBench& bench, std::size_t motor, double time_ms) {
  const std::size_t k = tick_at(time_ms);
  return {bench.time_ms[k] - kServo_ms / 2, (uu(bench, k, motor) - uu(bench, k - 1, motor)) / kServo_ms};
}

/// Largest and smallest distance from a centre between two times.
std::pair<double, double> radii(const ProgramBench& bench, double cx, double cy, double from_ms, double to_ms, std::size_t first = 1, std::size_t second = 2) {
  double least = 1e9, greatest = 0;
  for (std::size_t k = tick_at(from_ms) + 1; k < tick_at(to_ms); ++k) {
    const double r = std::hypot(uu(bench, k, first) - cx, uu(bench, k, second) - cy);
    least = std::min(least, r);
    greatest = std::max(greatest, r);
  }
  return {least, greatest};
}

const char* kSegments = "Coord[1].SegMoveTime=5";

}  // namespace

TEST_CASE("pvt: segments of the manual's recipes have the speeds that they are named for", "[programs][pvt]") {
  // T = 100 ms, V = 60/s = 0.06/ms. V T/3: speed V (t/T)^2; 2 V T/3: V (1 - (1-t/T)^2); 5/6 and 1/6 V T: V to V and V to 0 ... User's Manual p779
  const double T = 100, V = 0.06;
  const Lines bench("inc pvt100 X2:60\nX4:0\nX4:60\nX2:0\nX3:60\nX6:60\nX4.5:30\nX1.5:0");
  REQUIRE(bench.faults.empty());
  const auto expected = [&](double t) {
    const int block = static_cast<int>(t / T);
    const double s = t / T - block;
    switch (block) {
      case 0: return V * s * s;
      case 1: return V * (1 - s * s);
      case 2: return V * (1 - (1 - s) * (1 - s));
      case 3: return V * (1 - s) * (1 - s);
      case 4: return V * s;
      case 5: return V;
      case 6: return V * (1 - s / 2);
      default: return V * (1 - s) / 2;
    }
  };
  for (double t = 5; t < 795; t += 10) {
    const auto [at, speed] = speed_near(bench, 1, t);
    CHECK(speed == Approx(expected(at)).margin(2e-6));
  }
  CHECK(last(bench, 1) == Approx(27.0).margin(1e-9));
}

TEST_CASE("pvt: a circle of cubics is left by V^4 T^4 / (384 R^3)", "[programs][pvt]") {
  const int blocks = 12;
  const double R = 10, T = 100, V = 2 * pi * R / (blocks * T);  // uu/ms
  std::string lines = fmt::format("inc pvt100 X{}:{} abs\n", V * T / 2, V * 1000);
  const double x0 = V * T / 2;
  for (int i = 1; i <= blocks; ++i) {
    const double a = 2 * pi * i / blocks;
    lines += fmt::format("X{:.12f}:{:.12f} Y{:.12f}:{:.12f}\n", x0 + R * std::sin(a), V * 1000 * std::cos(a), R - R * std::cos(a), V * 1000 * std::sin(a));
  }
  const Lines bench(lines + fmt::format("X{}:0 Y0\n", x0 + V * T / 2));
  REQUIRE(bench.faults.empty());
  const auto [least, greatest] = radii(bench, x0, R, T, (blocks + 1) * T);
  const double bound = std::pow(V * T, 4) / (384 * R * R * R);
  const double worst = std::max(R - least, greatest - R);
  CHECK(worst < 1.02 * bound);
  CHECK(worst > 0.9 * bound);
}

TEST_CASE("fine interpolation: arcs are left by V^4 tau^4 / (384 R^3) through the points, by V^2 tau^2 / (6 R) beside them", "[programs][fine]") {
  const double R = 10, tau = 20, V = 0.1;
  const std::string lines = "F100 ta20 ts0 X0.5\ncircle2 X0.5 Y0 I0 J10\nlinear X1";
  const std::string text = with_motors(lines, fmt::format("Coord[1].SegMoveTime={}", tau));
  for (const auto fine : {pmac::motion::FineInterpolation::kThrough, pmac::motion::FineInterpolation::kBspline}) {
    ProgramBench bench("lines.pmc", text, fine);
    bench.run("&1 b1r");
    REQUIRE(bench.faults.empty());
    const auto [least, greatest] = radii(bench, 0.5, R, 100, 500);
    const bool through = fine == pmac::motion::FineInterpolation::kThrough;
    const double bound = through ? std::pow(V * tau, 4) / (384 * R * R * R) : V * V * tau * tau / (6 * R);
    CHECK(std::max(R - least, greatest - R) < 1.02 * bound);
    CHECK(R - least > (through ? 0 : 0.98 * bound));
  }
}

TEST_CASE("spline: points are passed at a sixth of the difference of the displacements", "[programs][spline]") {
  const double T = 100 * kServo_ms;  // knots lie on ticks
  const Lines bench(fmt::format("spline({})\nX10 Y4\nX30 Y2\nX35 Y-6\nX20 Y0", T));
  REQUIRE(bench.faults.empty());
  const double x[] = {0, 10, 30, 35, 20, 20}, y[] = {0, 4, 2, -6, 0, 0};
  for (std::size_t i = 1; i <= 4; ++i) {
    const double dx = (x[i + 1] - 2 * x[i] + x[i - 1]) / 6, dy = (y[i + 1] - 2 * y[i] + y[i - 1]) / 6;
    CHECK(uu(bench, tick_at((static_cast<double>(i) + 1) * T), 1) == Approx(x[i] + dx).margin(1e-6));
    CHECK(uu(bench, tick_at((static_cast<double>(i) + 1) * T), 2) == Approx(y[i] + dy).margin(1e-6));
  }
}

TEST_CASE("spline: three times are those of the segment before, of its own, and of the one after", "[programs][spline]") {
  const std::string same = "spline100 X10\nspline50 X20 Y4\nspline200 X40\n";
  const std::string three = "spline100 spline100 spline50 X10\nspline100 spline50 spline200 X20 Y4\nspline50 spline200 spline200 X40\n";
  const Lines one(same), all(three);
  REQUIRE(all.faults.empty());
  REQUIRE(one.motor_mu.size() == all.motor_mu.size());
  for (std::size_t k = 0; k < one.motor_mu.size(); ++k) CHECK(one.motor_mu[k][1] == all.motor_mu[k][1]);
  // The first and last times are also those of the segments without distance.
  const Lines ends("spline30 spline100 spline70 X10\n");
  REQUIRE(ends.faults.empty());
  CHECK(ends.moves.back().end_ms == Approx(30 + 100 + 70).margin(1e-9));
  CHECK(last(ends, 1) == Approx(10.0).margin(1e-9));
}

TEST_CASE("spline: three times that do not fit their neighbours are named", "[programs][spline]") {
  const Lines before("spline100 spline100 spline100 X1\nspline70 spline50 spline50 X2\n");
  REQUIRE(before.faults.size() == 1);
  CHECK(before.faults[0].fault.detail == "the first of three spline times is that of the segment before, which takes 100 ms, not 70");
  const Lines after("spline100 spline100 spline70 X1\nspline100 X2\n");
  REQUIRE(after.faults.size() == 1);
  CHECK(after.faults[0].fault.detail == "the block before says with its third spline time that this segment takes 70 ms, not 100");
}

TEST_CASE("transform: a turn about a point leaves it where it is", "[programs][transform]") {
  // Bias = c - M c for c = (40, -5), 30 degrees
  const double s = std::sin(pi / 6), c = std::cos(pi / 6);
  const std::string turn = fmt::format("Tdata[1].Diag[6]={0} Tdata[1].Diag[7]={0} Tdata[1].XYZ[0]=-{1} Tdata[1].XYZ[2]={1} "
                                       "Tdata[1].Bias[6]={2} Tdata[1].Bias[7]={3} tsel 1\n", c, s, 40 - (c * 40 + s * 5), -5 - (s * 40 - c * 5));
  const Lines centre(turn + "X40 Y-5"), beside(turn + "X50 Y-5");
  REQUIRE(centre.faults.empty());
  CHECK(last(centre, 1) == Approx(40.0).margin(1e-9));
  CHECK(last(centre, 2) == Approx(-5.0).margin(1e-9));
  CHECK(last(beside, 1) == Approx(40 + 10 * c).margin(1e-9));
  CHECK(last(beside, 2) == Approx(-5 + 10 * s).margin(1e-9));
}

TEST_CASE("circle: a spiral's radius goes evenly with the angle, in every plane and in the second set", "[programs][circle]") {
  // From radius 10 to 5 in half a turn, at the middle 7.5. normal j-1: circle1 goes from +Z to +X seen against J.
  struct Row { const char* words; std::size_t first, second; const char* axes; };
  const Row rows[] = {{"normal k-1 circle2 X-15 Y0 I-10", 1, 2, "XYZ"},
                      {"normal j-1 circle1 X-15 Z0 I-10 K0", 1, 3, "XYZ"},
                      {"normal i-1 circle2 Y-15 Z0 J-10 K0", 2, 3, "XYZ"}};
  for (const Row& row : rows) {
    INFO(row.words);
    const Lines bench(std::string("F50 ta20 ts0 ") + row.words, kSegments);
    REQUIRE(bench.faults.empty());
    std::size_t middle = 0;
    double at = 1e9;
    for (std::size_t k = 0; k < bench.motor_mu.size(); ++k) {
      const double off = std::abs(uu(bench, k, row.first) + 10);   // beside the centre
      if (off < at) at = off, middle = k;
    }
    CHECK(std::hypot(uu(bench, middle, row.first) + 10, uu(bench, middle, row.second)) == Approx(7.5).margin(0.02));
    CHECK(last(bench, static_cast<int>(row.first)) == Approx(-15.0).margin(1e-9));
    // Length: the mean radius times the angle.
    CHECK(bench.moves[0].length == Approx(7.5 * pi).margin(1e-6));
  }
}
