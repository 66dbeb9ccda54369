// pvt and spline moves in whole programs. Expected values are closed forms: constant acceleration, the cubic with given ends, the
// weights of the uniform cubic B-spline at its knots (1, 4, 1)/6 and in between (1, 23, 23, 1)/48.
#include "tests/unit/programs/lines.h"

using namespace pmac::test;

namespace {

/// Position of a motor (uu) at the tick next to a time, with that tick's time.
std::pair<double, double> at(const ProgramBench& bench, int motor, double time_ms) {
  std::size_t k = 0;
  while (k + 1 < bench.time_ms.size() && bench.time_ms[k] < time_ms) ++k;
  return {bench.time_ms[k], bench.motor_mu[k][static_cast<std::size_t>(motor)] / 1000};
}

}  // namespace

TEST_CASE("pvt: half V T from rest is a constant acceleration, V T a constant speed", "[programs][pvt]") {
  for (const char* segments : {"Coord[1].SegMoveTime=0", "Coord[1].SegMoveTime=7"}) {
    const Lines bench("pvt200 X5:50\nX15:50\ninc X5:0\nabs Y3:0", segments);
    REQUIRE(bench.faults.empty());
    REQUIRE(bench.moves.size() == 4);
    CHECK(bench.moves[2].end_ms == Approx(600.0).margin(1e-9));
    CHECK(bench.moves[3].end_ms == Approx(800.0).margin(1e-9));
    for (std::size_t k = 0; k < bench.time_ms.size(); ++k) {
      const double t = std::min(bench.time_ms[k], 600.0), v = 0.05, a = v / 200;
      const double x = t < 200 ? a * t * t / 2 : t < 400 ? 5 + v * (t - 200) : 20 - a * (600 - t) * (600 - t) / 2;
      CHECK(bench.motor_mu[k][1] / 1000 == Approx(x).margin(1e-9));
    }
    CHECK(last(bench, 2) == Approx(3.0).margin(1e-9));
  }
}

TEST_CASE("pvt: the cubic between two points and velocities; fractions of a millisecond; FeedTime", "[programs][pvt]") {
  const Lines bench("Coord[1].FeedTime=60000 pvt100.5 X10:1200\nX12\n");  // 1200 a minute is 0.02 a ms; no velocity is 0
  REQUIRE(bench.faults.empty());
  const auto [t, x] = at(bench, 1, 40);
  const double T = 100.5, V = 0.02, D = 10;
  CHECK(x == Approx((3 * D / T / T - V / T) * t * t + (-2 * D / T / T / T + V / T / T) * t * t * t).margin(1e-9));
  CHECK(bench.moves[1].end_ms == Approx(201.0).margin(1e-9));
}

TEST_CASE("pvt: ta, ts and the motors' limits do not change it", "[programs][pvt]") {
  for (const char* segments : {"Coord[1].SegMoveTime=0", "Coord[1].SegMoveTime=7"}) {
    const Lines bench("F1 ta100 ts20 pvt40 X-6:-100\nX-10:0", std::string("Motor[1].InvAmax=10 Motor[1].InvDmax=10 Motor[1].MaxSpeed=1 ") + segments);
    REQUIRE(bench.faults.empty());
    CHECK(bench.moves[1].end_ms == Approx(80.0).margin(1e-9));
    const auto [t, x] = at(bench, 1, 20);
    const double T = 40, V = -0.1, D = -6;
    CHECK(x == Approx((3 * D / T / T - V / T) * t * t + (-2 * D / T / T / T + V / T / T) * t * t * t).margin(1e-9));
  }
}

TEST_CASE("pvt: after other moves it is what it is alone, to its end", "[programs][pvt]") {
  for (const char* segments : {"Coord[1].SegMoveTime=0", "Coord[1].SegMoveTime=7"}) {
    const Lines bench("F100 ta50 td60 ts10 linear X1\nX2 Y1\nX3\npvt40 X7:100\nX11:100\nX13:0\ndwell 5", segments);
    REQUIRE(bench.faults.empty());
    REQUIRE(bench.moves.size() == 7);
    const double start_ms = bench.moves[2].end_ms, end_ms = start_ms + 120, V = 0.1, a = V / 40;
    CHECK(bench.moves[5].end_ms == Approx(end_ms).margin(1e-9));
    CHECK(bench.moves[6].start_ms == Approx(end_ms).margin(1e-9));
    for (std::size_t k = 0; k < bench.time_ms.size(); ++k) {   // 3 + cubic, constant speed, constant deceleration: half V T is 2
      const double t = bench.time_ms[k] - start_ms, left_ms = std::max(0.0, 120 - t);
      if (t < 40) continue;
      CHECK(bench.motor_mu[k][1] / 1000 == Approx(t < 80 ? 7 + V * (t - 40) : 13 - a * left_ms * left_ms / 2).margin(1e-9));
    }
  }
}

TEST_CASE("pvt: goes through a transformation", "[programs][pvt]") {
  const Lines bench("Tdata[1].Diag[6]=0 Tdata[1].Diag[7]=0 Tdata[1].XYZ[0]=-2 Tdata[1].XYZ[2]=2 tsel 1\npvt200 X5:50\nX10:0");
  REQUIRE(bench.faults.empty());
  const auto [t, y] = at(bench, 2, 100);
  CHECK(y == Approx(2 * 0.05 / 200 * t * t / 2).margin(1e-9));
  CHECK(last(bench, 2) == Approx(20.0).margin(1e-9));
}

TEST_CASE("pvt: a move that is left moving is error 8", "[programs][pvt]") {
  for (const char* then : {"", "dwell 0", "linear X20", "delay 5", "pmatch"}) {
    Lines bench(std::string("pvt200 X5:50\n") + then);
    REQUIRE(bench.faults.size() == 1);
    CHECK(value_of(bench, "Coord[1].ErrorStatus") == 8);
  }
  Lines compensated("ccr1 ccmode1 pvt200 X5:50", "Coord[1].SegMoveTime=1");
  CHECK(value_of(compensated, "Coord[1].ErrorStatus") == 3);
  CHECK(Lines("pvt0 X1").faults.size() == 1);
}

TEST_CASE("spline: n points take n + 2 times, and the knots have the weights of the B-spline", "[programs][spline]") {
  for (const char* segments : {"Coord[1].SegMoveTime=0", "Coord[1].SegMoveTime=10"}) {
    const Lines bench("spline100 X10\nX30\nX40\nlinear X50", segments);
    REQUIRE(bench.faults.empty());
    const double servo = 0.44274211;
    const auto near = [&](double time_ms, double x) {  // the knot itself lies between two ticks
      const auto [t, position] = at(bench, 1, time_ms);
      CHECK(position == Approx(x).margin(0.3 * servo));
    };
    near(100, 10.0 / 6);
    near(150, (23 * 10.0 + 30) / 48);
    near(200, (4 * 10.0 + 30) / 6);
    near(250, (23 * 10.0 + 23 * 30 + 40) / 48);
    near(300, (10 + 4 * 30.0 + 40) / 6);
    near(400, (30 + 5 * 40.0) / 6);
    const auto [t, x] = at(bench, 1, 500);
    CHECK(x == Approx(40.0).margin(1e-3));
    CHECK(bench.moves[4].end_ms == Approx(500.0).margin(1e-9));  // three points and two segments at rest
    CHECK(last(bench, 1) == Approx(50.0).margin(1e-9));
  }
}

TEST_CASE("spline: unequal times keep the acceleration continuous", "[programs][spline]") {
  const Lines bench("spline100 X10\nspline50 X20 Y4\nspline200 X40\n");
  REQUIRE(bench.faults.empty());
  CHECK(bench.moves.back().end_ms == Approx(100 + 100 + 50 + 200 + 200).margin(1e-9));
  std::vector<double> acceleration;
  for (std::size_t k = 1; k + 1 < bench.time_ms.size(); ++k)
    acceleration.push_back(bench.motor_mu[k + 1][1] - 2 * bench.motor_mu[k][1] + bench.motor_mu[k - 1][1]);
  double greatest = 0, step = 0;
  for (std::size_t k = 1; k < acceleration.size(); ++k) {
    greatest = std::max(greatest, std::abs(acceleration[k]));
    step = std::max(step, std::abs(acceleration[k] - acceleration[k - 1]));
  }
  CHECK(step < 0.05 * greatest);
  CHECK(last(bench, 1) == Approx(40.0).margin(1e-9));
  CHECK(last(bench, 2) == Approx(4.0).margin(1e-9));
}

TEST_CASE("pvt: acceleration limits of the motors put no ramp before an unsegmented move", "[programs][pvt]") {
  const Lines bench("pvt200 X5:50\nX10:0", "Motor[1].InvAmax=10 Motor[1].InvDmax=10");   // the move needs 0.25 mu/ms^2
  REQUIRE(bench.faults.empty());
  CHECK(bench.moves[1].end_ms == Approx(400.0).margin(1e-9));
  const auto [t, x] = at(bench, 1, 100);
  CHECK(x == Approx(0.05 / 200 * t * t / 2).margin(1e-9));
}
