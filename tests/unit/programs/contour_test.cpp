// The blended contour: its nominal times, its path, and the pump.
#include "tests/unit/programs/bench.h"
#include "tests/unit/programs/geometry.h"

using pmac::test::Element;
using pmac::test::ProgramBench;

namespace {

const std::vector<Element>& contour() {
  static const std::vector<Element> path = {
      {1, 4, 1, 13},  {1, 13, 2, 14, 2, 13, -1}, {2, 14, 3, 14}, {3, 14, 4, 13, 3, 13, -1},  {4, 13, 4, 7},  {4, 7, 7, 4, 7, 7, 1},
      {7, 4, 13, 4},  {13, 4, 14, 3, 13, 3, -1}, {14, 3, 14, 2}, {14, 2, 13, 1, 13, 2, -1},  {13, 1, 4, 1},  {4, 1, 1, 4, 4, 4, -1}};
  return path;
}

}  // namespace

TEST_CASE("contour: rapid 405.03 ms, blended motion 2010 ms, whole program 2890.1 ms", "[programs]") {
  ProgramBench bench("05_blended_contour.pmc");
  bench.run("&1 b4r");
  REQUIRE(bench.refusals.empty());
  REQUIRE(bench.faults.empty());
  REQUIRE(bench.moves.size() == 17);
  // Rapid: 4000 mu at 0.1 mu/ms^2 and 0.02 mu/ms^3 peaks at v = (sqrt(Ts^2 + 4 D/A) - Ts) A/2, time 2 (v/A + Ts).
  const double v = (std::sqrt(25.0 + 160000.0) - 5.0) * 0.05;
  const double rapid_ms = 2 * (v / 0.1 + 5.0);
  CHECK(bench.moves[0].end_ms == Approx(rapid_ms).margin(1e-6));
  // Ten blocks of 150 ms (the ramp time), two lines of 180 ms, and half a ramp at each end.
  const double start = rapid_ms + 70.0;
  CHECK(bench.moves[3].start_ms == Approx(start).margin(1e-6));
  CHECK(bench.moves[14].end_ms == Approx(start + 2010.0).margin(1e-6));
  CHECK(bench.moves[16].end_ms == Approx(2 * rapid_ms + 2080.0).margin(1e-6));
}

TEST_CASE("contour: stays within 1 um of its lines and arcs and ends at (1, 4)", "[programs]") {
  ProgramBench bench("05_blended_contour.pmc");
  bench.run("&1 b4r");
  const double start = bench.moves[3].start_ms, end = bench.moves[14].end_ms;
  double worst = 0;
  std::size_t last = 0;
  for (std::size_t k = 0; k < bench.time_ms.size(); ++k) {
    if (bench.time_ms[k] < start || bench.time_ms[k] > end) continue;
    worst = std::max(worst, distance_to(contour(), bench.motor_mu[k][1] / 1000, bench.motor_mu[k][2] / 1000));
    last = k + 1;
  }
  CHECK(worst < 1e-3);  // of a unit of 1 mm
  CHECK(bench.motor_mu[last][1] == Approx(1000.0).margin(1e-6));
  CHECK(bench.motor_mu[last][2] == Approx(4000.0).margin(1e-6));
}

TEST_CASE("contour: the pump runs from before the contour to its end", "[programs]") {
  ProgramBench bench("05_blended_contour.pmc");
  bench.run("&1 b4r");
  REQUIRE(bench.outputs.size() == 2);
  CHECK(bench.outputs[0].name == "DispensePumpOn");
  CHECK(bench.outputs[0].value == 1.0);
  CHECK(bench.outputs[0].time_ms == Approx(bench.moves[1].end_ms).margin(1e-9));  // after the first dwell
  CHECK(bench.outputs[1].value == 0.0);
  CHECK(bench.outputs[1].time_ms == Approx(bench.moves[14].end_ms).margin(1e-9));
}

TEST_CASE("contour: the smoothing kernel adds no time and leaves arcs by V^2 T^2 / 6R at most", "[programs]") {
  ProgramBench bench("05_blended_contour.pmc", {}, pmac::motion::FineInterpolation::kBspline);
  bench.run("&1 b4r");
  CHECK(bench.moves[14].end_ms - bench.moves[3].start_ms == Approx(2010.0).margin(1e-6));
  double worst = 0;
  for (std::size_t k = 0; k < bench.time_ms.size(); ++k)
    if (bench.time_ms[k] >= bench.moves[3].start_ms && bench.time_ms[k] <= bench.moves[14].end_ms)
      worst = std::max(worst, distance_to(contour(), bench.motor_mu[k][1] / 1000, bench.motor_mu[k][2] / 1000));
  // Fastest on a curve: the join of a 9-unit line (0.05 units/ms) with an arc of radius 1 (pi/2 in 150 ms), passed at their mean.
  const double join_speed = (0.05 + std::numbers::pi / 2 / 150) / 2;
  CHECK(worst < std::pow(join_speed * 5, 2) / 6);
  CHECK(worst > 1e-3);  // it does smooth
}
