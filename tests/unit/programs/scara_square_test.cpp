// A SCARA round a 200 mm square with 5 mm fillets under joint limits of 200 degrees/s and 1000 degrees/s^2: time, limits and contour.
#include <numbers>

#include "kinematics/kinematics.h"
#include "tests/reference/joint_time_optimal.h"
#include "tests/unit/programs/bench.h"

using namespace pmac;
using test::ProgramBench;

namespace {

constexpr double kRadian = std::numbers::pi / 180;
constexpr double kSpeed_deg_ms = 0.2, kAccel_deg_ms2 = 0.001, kSegment_ms = 1;

/// Distance from the outline of the square of 200 mm about (450, 0) with fillets of 5 mm.
double off_outline_mm(double x, double y) {
  const double u = std::abs(x - 450) - 95, v = std::abs(y) - 95;  // from the fillets' middles
  if (u > 0 && v > 0) return std::abs(std::hypot(u, v) - 5);
  return std::abs(std::max(u, v) - 5);
}

/// The optimum: counter-clockwise from the middle of the lower side.
double optimal_ms(double step_mm) {
  std::vector<reference::PlanePiece> path{{0, 95, 0}};
  for (int corner = 0; corner < 4; ++corner) {
    path.push_back({corner * std::numbers::pi / 2, 5 * std::numbers::pi / 2, 1.0 / 5});
    path.push_back({(corner + 1) * std::numbers::pi / 2, corner == 3 ? 95.0 : 190.0, 0});
  }
  return reference::JointTimeOptimal({400, 300}, {200 * kRadian, 1000 * kRadian}, 2000, 450, -100, path, step_mm).solve();
}

struct Contour {
  double start_ms = 0, end_ms = 0, off_mm = 0, speed_deg_ms = 0, accel_deg_ms2 = 0;
};

/// The moves behind the rapid one: worst distance, speed and acceleration of joints 1 and 2 from the servo samples.
Contour contour_of(const ProgramBench& bench) {
  Contour c;
  bool begun = false;
  for (const auto& move : bench.moves) {
    if (move.mode == "rapid" || move.mode == "dwell") continue;
    if (!begun) c.start_ms = move.start_ms;
    begun = true;
    c.end_ms = move.end_ms;
  }
  const double period_ms = bench.time_ms[1] - bench.time_ms[0];
  for (std::size_t k = 1; k + 1 < bench.time_ms.size(); ++k) {
    if (bench.time_ms[k] < c.start_ms + period_ms) continue;
    const auto& here = bench.motor_mu[k];
    const auto pose = kinematics::scara_forward({}, {here[1], here[2], here[3], here[4]});
    c.off_mm = std::max(c.off_mm, off_outline_mm(pose.x_mm, pose.y_mm));
    for (std::size_t m = 1; m <= 2; ++m) {
      const double before = bench.motor_mu[k - 1][m], after = bench.motor_mu[k + 1][m];
      c.speed_deg_ms = std::max(c.speed_deg_ms, std::abs(after - here[m]) / period_ms);
      c.accel_deg_ms2 = std::max(c.accel_deg_ms2, std::abs(before - 2 * here[m] + after) / (period_ms * period_ms));
    }
  }
  return c;
}

}  // namespace

TEST_CASE("SCARA square: the dense optimum has settled", "[programs]") {
  CHECK(optimal_ms(0.004) == Approx(optimal_ms(0.002)).epsilon(3e-4));
}

TEST_CASE("SCARA square: time within 0.3 % and a segment of the optimum, joint limits within 0.1 %, contour within 1 um", "[programs]") {
  ProgramBench bench("kinematics/scara_square.pmc");
  bench.run("&1 b1r");
  REQUIRE(bench.faults.empty());
  const Contour c = contour_of(bench);
  const double best_ms = optimal_ms(0.002), time_ms = c.end_ms - c.start_ms;
  INFO("time " << time_ms << " ms, optimum " << best_ms << " ms");
  CHECK(time_ms <= 1.003 * best_ms + kSegment_ms);
  CHECK(time_ms >= best_ms * 0.999);
  CHECK(c.speed_deg_ms <= 1.001 * kSpeed_deg_ms);
  CHECK(c.accel_deg_ms2 <= 1.001 * kAccel_deg_ms2);
  CHECK(c.off_mm < 1e-3);
}
