// The oval without and with lookahead.
#include "tests/unit/programs/bench.h"
#include "tests/unit/programs/geometry.h"

using pmac::test::Element;
using pmac::test::ProgramBench;

namespace {

const std::vector<Element>& oval() {
  static const std::vector<Element> path = {
      {0, 0, 60, 0}, {60, 0, 60, 20, 60, 10, 1}, {60, 20, -60, 20}, {-60, 20, -60, 0, -60, 10, 1}, {-60, 0, 0, 0}};
  return path;
}

double worst_deviation_mm(const ProgramBench& bench) {
  double worst = 0;
  for (const auto& row : bench.motor_mu) worst = std::max(worst, distance_to(oval(), row[1] / 1000, row[2] / 1000));
  return worst;
}

double total_ms(const ProgramBench& bench) { return bench.moves[4].end_ms - bench.moves[0].start_ms; }

}  // namespace

TEST_CASE("oval without lookahead: 1539.2 ms on the path", "[programs]") {
  ProgramBench bench("06_oval.pmc");
  bench.run("&1 b5r");
  REQUIRE(bench.moves.size() == 6);
  // (240 + 20 pi) mm at 200 mm/s plus one ramp of 25 ms
  CHECK(total_ms(bench) == Approx((240 + 20 * std::numbers::pi) / 0.2 + 25.0).margin(1e-6));
  CHECK(worst_deviation_mm(bench) < 1e-3);
  CHECK(bench.motor(1).final_mu == Approx(0.0).margin(1e-6));
}

TEST_CASE("oval with lookahead: limits hold at servo rate, the path stays, within 1 % of the optimum", "[programs]") {
  ProgramBench bench("07_oval_lookahead.pmc");
  bench.run("&1 b5r");
  REQUIRE(bench.refusals.empty());
  REQUIRE(bench.moves.size() == 6);
  for (int motor : {1, 2}) {
    CHECK(bench.motor(motor).max_accel_mu_ms2 <= 1.001);
    CHECK(bench.motor(motor).max_speed_mu_ms <= 500 * 1.001);
  }
  CHECK(worst_deviation_mm(bench) < 1e-3);
  // Time-optimal motion of the geometric oval, from rest to rest under 1000 mm/s^2 an axis and 200 mm/s: each straight part by
  // its trapezoid, each half circle by 4 sqrt(2 r (1 - 1/sqrt 2) / a): 0.65 + 0.85 + 8 sqrt(2 r (1 - 1/sqrt 2)/a).
  const double optimum_ms = 1000 * (0.65 + 0.85 + 8 * std::sqrt(2 * 10.0 * (1 - std::sqrt(0.5)) / 1000.0));
  CHECK(total_ms(bench) > 0.9999 * optimum_ms);
  CHECK(total_ms(bench) < 1.003 * optimum_ms + 5);
}
