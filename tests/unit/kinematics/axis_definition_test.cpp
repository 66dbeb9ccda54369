#include <catch2/catch.hpp>

#include "kinematics/kinematics.h"

using namespace pmac::kinematics;
using Kind = MotorDefinition::Kind;

namespace {

constexpr int kX = 6, kY = 7;

MotorDefinition linear(int motor, double x, double y, double offset_mu = 0) {
  MotorDefinition d{motor, Kind::kLinear, {}, offset_mu};
  d.coefficient_mu_uu[kX] = x;
  d.coefficient_mu_uu[kY] = y;
  return d;
}

}  // namespace

TEST_CASE("axis definitions: a scale and an offset map both ways", "[kinematics]") {
  const AxisMap map({linear(1, 10000, 0, 20000)});  // #1->10000X+20000
  REQUIRE(map.solvable());
  AxisVector axes{};
  axes[kX] = 3;
  double motor_mu[1];
  map.motors_from_axes(axes, motor_mu);
  CHECK(motor_mu[0] == 50000.0);  // by hand
  AxisVector back{};
  map.axes_from_motors(motor_mu, back);
  CHECK(back[kX] == Approx(3.0).margin(1e-12));
}

TEST_CASE("axis definitions: a rotated pair is solved for its axes", "[kinematics]") {
  // #1->8660.25X-5000Y  #2->5000X+8660.25Y: a turn by 30 degrees, 10000 motor units an axis unit.
  const AxisMap map({linear(1, 8660.25, -5000), linear(2, 5000, 8660.25)});
  REQUIRE(map.solvable());
  const double motor_mu[2] = {8660.25 * 2 - 5000 * 7, 5000 * 2 + 8660.25 * 7};
  AxisVector axes{};
  map.axes_from_motors(motor_mu, axes);
  CHECK(axes[kX] == Approx(2.0).epsilon(1e-12));
  CHECK(axes[kY] == Approx(7.0).epsilon(1e-12));
}

TEST_CASE("axis definitions: both motors of a gantry follow, the lower one decides", "[kinematics]") {
  const AxisMap map({linear(1, 100, 0), linear(2, 100, 0)});
  REQUIRE(map.solvable());
  const double motor_mu[2] = {500, 700};
  AxisVector axes{};
  map.axes_from_motors(motor_mu, axes);
  CHECK(axes[kX] == Approx(5.0));
  double out_mu[2];
  map.motors_from_axes(axes, out_mu);
  CHECK(out_mu[0] == out_mu[1]);
}

TEST_CASE("axis definitions: singular and incomplete definitions say why", "[kinematics]") {
  const AxisMap singular({linear(1, 1, 2), linear(2, 2, 4)});
  CHECK_FALSE(singular.solvable());
  CHECK(singular.reason().find("singular") != std::string::npos);
  const AxisMap incomplete({linear(1, 1, 2)});
  CHECK_FALSE(incomplete.solvable());
  CHECK(incomplete.reason().find("fewer") != std::string::npos);
}

TEST_CASE("axis definitions: no linear motor at all can be solved", "[kinematics]") {
  CHECK(AxisMap(std::vector<MotorDefinition>{}).solvable());
  CHECK(AxisMap({MotorDefinition{1, Kind::kInverse, {}, 0}}).solvable());
}
