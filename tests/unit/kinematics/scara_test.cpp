#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "kinematics/kinematics.h"

using namespace pmac::kinematics;

TEST_CASE("SCARA: the worked poses of a 400/300 mm arm", "[kinematics]") {
  // Worked by hand from the law of cosines with L1 = 400, L2 = 300, offset 250: elbow cosine (r^2 - 250000) / 240000.
  struct Row { ScaraPose pose; ScaraJoints joints; };
  const Row rows[] = {
      {{500, 0, 250, 0}, {-36.86989764584401, 90, -53.13010235415599, 0}},
      {{400, 300, 250, 90}, {0, 90, 0, 0}},
      {{300, 400, 200, 45}, {16.26020470831197, 90, -61.26020470831197, -50}},
      {{0, 600, 250, 0}, {63.61567025059204, 62.72038726402191, -126.33605751461394, 0}},
  };
  for (const Row& row : rows) {
    const auto joints = scara_inverse({}, row.pose, ScaraArm::kElbowPositive);
    REQUIRE(joints);
    CHECK(joints->shoulder_deg == Approx(row.joints.shoulder_deg).margin(1e-10));
    CHECK(joints->elbow_deg == Approx(row.joints.elbow_deg).margin(1e-10));
    CHECK(joints->wrist_deg == Approx(row.joints.wrist_deg).margin(1e-10));
    CHECK(joints->vertical_mm == Approx(row.joints.vertical_mm).margin(1e-10));
  }
}

TEST_CASE("SCARA: forward of inverse is the pose, in both arms", "[kinematics]") {
  std::mt19937_64 random(20240917);
  std::uniform_real_distribution<double> radius(104.7, 699.3), angle(-3.14159, 3.14159), z(0, 500), c(-180, 180);
  for (int i = 0; i < 10000; ++i) {
    const double r = radius(random), a = angle(random);
    const ScaraPose pose{r * std::cos(a), r * std::sin(a), z(random), c(random)};
    for (ScaraArm arm : {ScaraArm::kElbowPositive, ScaraArm::kElbowNegative}) {
      const auto joints = scara_inverse({}, pose, arm);
      REQUIRE(joints);
      const ScaraPose back = scara_forward({}, *joints);
      REQUIRE(std::hypot(back.x_mm - pose.x_mm, back.y_mm - pose.y_mm) < 1e-9);
      REQUIRE(std::abs(back.z_mm - pose.z_mm) < 1e-9);
      REQUIRE(std::abs(back.c_deg - pose.c_deg) < 1e-9);
    }
  }
}

TEST_CASE("SCARA: a target out of reach has no solution", "[kinematics]") {
  CHECK_FALSE(scara_inverse({}, {701, 0, 250, 0}, ScaraArm::kElbowPositive));
  CHECK_FALSE(scara_inverse({}, {99, 0, 250, 0}, ScaraArm::kElbowPositive));
  CHECK_FALSE(scara_inverse({}, {0, 0, 250, 0}, ScaraArm::kElbowPositive));
}
