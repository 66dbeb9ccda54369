// What every stock robot promises, and what its settings refuse.
#include <catch2/catch.hpp>

#include "tests/unit/kinematics/poses.h"

using namespace pmac::kinematics;
using namespace pmac::kinematics::test;

TEST_CASE("stock robots: forward of inverse is the pose, 2000 seeded poses each", "[kinematics]") {
  for (const RobotKind& kind : robot_kinds()) {
    INFO(kind.name);
    const auto robot = standard_robot(std::string(kind.name));
    REQUIRE(robot);
    Random random(20260117);
    std::vector<double> joints(static_cast<std::size_t>(robot->joint_count())), near(joints.size());
    for (int i = 0; i < 2000; ++i) {
      const AxisVector want = random_pose(std::string(kind.name), random);
      REQUIRE(robot->inverse(want, near, joints) == "");
      AxisVector back{};
      REQUIRE(robot->forward(joints, back) == "");
      REQUIRE(difference(want, back, robot->axes()) < 1e-9);
    }
  }
}

TEST_CASE("stock robots: joints at 0 are a pose, and its inverse gives them back", "[kinematics]") {
  for (const RobotKind& kind : robot_kinds()) {
    INFO(kind.name);
    const auto robot = standard_robot(std::string(kind.name));
    std::vector<double> zero(static_cast<std::size_t>(robot->joint_count())), joints(zero.size());
    AxisVector home{};
    REQUIRE(robot->forward(zero, home) == "");
    if (kind.name == "scara" || kind.name == "two_link") continue;  // stretched: rounding alone decides whether it is in reach
    REQUIRE(robot->inverse(home, zero, joints) == "");
    for (const double joint : joints) CHECK(joint == Approx(0.0).margin(1e-7));
  }
}

TEST_CASE("stock robots: targets out of reach have a reason", "[kinematics]") {
  struct Row { const char* robot; AxisVector target; const char* why; };
  const Row rows[] = {
      {"scara", pose(701, 0, 0), "out of the arm's reach"},         {"two_link", pose(99, 0, 0), "out of the arm's reach"},
      {"linear_delta", pose(400, 0, 0), "too short"},               {"rotary_delta", pose(0, 0, -900), "arm 1"},
      {"six_axis", pose(2000, 0, 0), "out of the arm's reach"}, {"three_jack_mirror", pose(0, 0, 0, 90.5), "90 degrees"},
  };
  for (const Row& row : rows) {
    INFO(row.robot);
    const auto robot = standard_robot(row.robot);
    std::vector<double> joints(6), near(6);
    CHECK(robot->inverse(row.target, near, joints).find(row.why) != std::string::npos);
  }
  AxisVector ignored{};
  const double apart[3] = {0, 0, 900};
  CHECK(standard_robot("linear_delta")->forward(apart, ignored).find("do not meet") != std::string::npos);
  const double short_leg[6] = {-1000, 0, 0, 0, 0, 0}, torn[6] = {400, -200, 400, -200, 400, -200};
  CHECK(standard_robot("hexapod")->forward(short_leg, ignored) == "a leg has no length");
  CHECK(standard_robot("hexapod")->forward(torn, ignored) == "no pose of the platform has these leg lengths");
}

TEST_CASE("stock robots: settings say what is wrong with them", "[kinematics]") {
  struct Row { const char* robot; const char* name; std::vector<double> values; const char* why; };
  const Row rows[] = {
      {"scara", "upper_arm_mm", {0}, "above 0"},       {"scara", "elbow", {2}, "1 or -1"},
      {"scara", "forearm_mm", {1, 2}, "needs 1"},      {"hexapod", "base_deg", {1, 2, 3}, "needs 6"},
      {"scara", "upperarm", {400}, "upper_arm_mm"},    {"corexy", "x", {1}, "has none"},
      {"hexapod", "home_mm", {std::nan("")}, "finite"}, {"skara", "x", {1}, "there are scara"},
  };
  for (const Row& row : rows) {
    RobotSettings settings;
    settings.set(row.name, row.values);
    std::string problem;
    CHECK_FALSE(make_robot(row.robot, settings, problem));
    INFO(problem);
    CHECK(problem.find(row.why) != std::string::npos);
  }
}

TEST_CASE("stock robots: settings change the geometry", "[kinematics]") {
  RobotSettings settings;
  settings.set("upper_arm_mm", {3});
  settings.set("forearm_mm", {4});
  settings.set("elbow", {-1});
  std::string problem;
  const auto robot = make_robot("two_link", settings, problem);
  REQUIRE(robot);
  double joints[2];
  REQUIRE(robot->inverse(pose(0, 5, 0), {}, joints) == "");  // a 3-4-5 triangle: the elbow is a right angle
  CHECK(joints[1] == Approx(-90).margin(1e-10));
  CHECK(joints[0] == Approx(90 + 53.13010235415598).margin(1e-10));
}
