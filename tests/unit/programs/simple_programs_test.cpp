// The simple programs of the course against their closed forms. Ramps: T = Ta + Ts; a move: |D|/F + (T_acc + T_dec)/2.
#include "tests/unit/programs/bench.h"

using pmac::test::ProgramBench;

TEST_CASE("simple move: 2750 ms a move, 6500 ms in all", "[programs]") {
  ProgramBench bench("01_simple_move.pmc");
  bench.run("&1 b1r");
  REQUIRE(bench.refusals.empty());
  REQUIRE(bench.moves.size() == 4);
  // 10 / 5 s + (600 + 900) / 2 ms
  CHECK(bench.moves[0].end_ms - bench.moves[0].start_ms == Approx(2750.0).margin(1e-9));
  CHECK(bench.moves[2].end_ms - bench.moves[2].start_ms == Approx(2750.0).margin(1e-9));
  CHECK(bench.moves[3].end_ms == Approx(6500.0).margin(1e-9));
  CHECK(bench.motor(1).final_mu == Approx(0.0).margin(1e-9));
  // peak acceleration 5 / max(Ta, Ts) = 10 au/s^2 = 0.01 mu/ms^2 in the shorter ramp
  CHECK(bench.motor(1).max_accel_mu_ms2 == Approx(0.01).epsilon(1e-6));
}

TEST_CASE("basic moves: 2500 ms a move, 6000 ms in all", "[programs]") {
  ProgramBench bench("02_basic_moves.pmc");
  bench.run("&1 b1r");
  REQUIRE(bench.moves.size() == 4);
  CHECK(bench.moves[0].end_ms == Approx(2500.0).margin(1e-9));
  CHECK(bench.moves[2].start_ms == Approx(3000.0).margin(1e-9));
  CHECK(bench.moves[2].end_ms == Approx(5500.0).margin(1e-9));
  CHECK(bench.moves[3].end_ms == Approx(6000.0).margin(1e-9));
  CHECK(bench.motor(1).max_speed_mu_ms == Approx(5.0).epsilon(1e-9));
  CHECK(bench.motor(1).max_mu == Approx(10000.0).margin(1e-9));
}

TEST_CASE("S-curve loop: 3000 ms a move, 10 and 5 au/s^2, ten rounds in 70 s", "[programs]") {
  ProgramBench bench("03_scurve_loop.pmc");
  bench.run("&1 b2r");
  REQUIRE(bench.moves.size() == 40);
  // tm 2000 + (750 + 1250) / 2
  for (std::size_t i = 0; i < bench.moves.size(); i += 2)
    CHECK(bench.moves[i].end_ms - bench.moves[i].start_ms == Approx(3000.0).margin(1e-6));
  CHECK(bench.moves.back().end_ms == Approx(70000.0).margin(1e-6));
  double up = 0, down = 0;  // accelerations of the first move, towards plus
  const double h = bench.time_ms[1];
  for (std::size_t k = 1; bench.time_ms[k + 1] < 3000.0; ++k) {
    const double a = (bench.motor_mu[k + 1][2] - 2 * bench.motor_mu[k][2] + bench.motor_mu[k - 1][2]) / (h * h);
    up = std::max(up, a);
    down = std::min(down, a);
  }
  CHECK(up == Approx(0.010).epsilon(1e-6));      // 5 au/s in 500 ms: 10 au/s^2
  CHECK(down == Approx(-0.005).epsilon(1e-6));   // in 1000 ms: 5 au/s^2
  CHECK(bench.motor(2).max_speed_mu_ms == Approx(5.0).epsilon(1e-9));
}
