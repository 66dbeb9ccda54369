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
  CHECK(singular.reason() == "the axis definitions are singular: those of motors 1 2 depend on one another");
  const AxisMap incomplete({linear(1, 1, 2)});
  CHECK_FALSE(incomplete.solvable());
  CHECK(incomplete.reason() == "fewer independent motors (1) than axes (X Y)");
}

TEST_CASE("axis definitions: no linear motor at all can be solved", "[kinematics]") {
  CHECK(AxisMap(std::vector<MotorDefinition>{}).solvable());
  CHECK(AxisMap({MotorDefinition{1, Kind::kInverse, {}, 0}}).solvable());
}

TEST_CASE("axis definitions: three rows of which two are enough are solved by least squares", "[kinematics]") {
  const AxisMap map({linear(1, 1, 0), linear(2, 0, 1), linear(3, 1, 1)});
  REQUIRE(map.solvable());
  const double motor_mu[3] = {1, 2, 6};  // X = 1, Y = 2 and X + Y = 6 contradict one another by 3: each gives way by 1
  AxisVector axes{};
  map.axes_from_motors(motor_mu, axes);
  CHECK(axes[kX] == Approx(2.0).epsilon(1e-12));
  CHECK(axes[kY] == Approx(3.0).epsilon(1e-12));
}

TEST_CASE("axis definitions: of three motors the two that depend on one another are named", "[kinematics]") {
  MotorDefinition z{4, Kind::kLinear, {}, 0};
  z.coefficient_mu_uu[8] = 5;
  const AxisMap map({linear(2, 1, 3), linear(3, -2, -6), z});
  CHECK_FALSE(map.solvable());
  CHECK(map.reason().find("motors 2 3 depend") != std::string::npos);
}

TEST_CASE("axis definitions: nearly singular ones are solved as well as their numbers allow", "[kinematics]") {
  const AxisMap map({linear(1, 1, 0), linear(2, 1, 1e-6)});
  REQUIRE(map.solvable());
  AxisVector axes{}, back{};
  axes[kX] = 3;
  axes[kY] = -7;
  double motor_mu[2];
  map.motors_from_axes(axes, motor_mu);
  map.axes_from_motors(motor_mu, back);
  CHECK(back[kX] == Approx(3).epsilon(1e-9));
  CHECK(back[kY] == Approx(-7).epsilon(1e-8));
}

TEST_CASE("axis definitions: rates leave offsets out, both ways", "[kinematics]") {
  const AxisMap map({linear(1, 3, 4, 1000), linear(2, -4, 3, 2000)});
  AxisVector rate{}, back{};
  rate[kX] = 2;
  rate[kY] = 1;
  double motor_rate[2];
  map.motor_rates_from_axis_rates(rate, motor_rate);
  CHECK(motor_rate[0] == 10);  // by hand
  CHECK(motor_rate[1] == -5);
  map.axis_rates_from_motor_rates(motor_rate, back);
  CHECK(back[kX] == Approx(2).epsilon(1e-12));
  CHECK(back[kY] == Approx(1).epsilon(1e-12));
}
