// Parallel robots against the constraints that define them: rods and legs keep their lengths between joints that are placed here by
// themselves, without the shortcuts of the closed forms.
#include <catch2/catch.hpp>

#include <Eigen/Dense>

#include "tests/unit/kinematics/poses.h"

using namespace pmac::kinematics;
using namespace pmac::kinematics::test;
using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;

namespace {

constexpr double kRadian = 3.14159265358979323846 / 180;

Vector3d on_circle(double radius_mm, double angle_deg, double z_mm = 0) {
  return {radius_mm * std::cos(angle_deg * kRadian), radius_mm * std::sin(angle_deg * kRadian), z_mm};
}

Vector3d position(const AxisVector& pose) { return {pose[axis::kX], pose[axis::kY], pose[axis::kZ]}; }

template <class Check> void for_poses(const std::string& name, Check check) {
  const auto robot = standard_robot(name);
  Random random(5772156);
  std::vector<double> joints(static_cast<std::size_t>(robot->joint_count())), near(joints.size());
  for (int i = 0; i < 2000; ++i) {
    const AxisVector pose = random_pose(name, random);
    REQUIRE(robot->inverse(pose, near, joints) == "");
    check(pose, joints);
  }
}

}  // namespace

TEST_CASE("linear delta: every rod has its length", "[kinematics]") {
  for_poses("linear_delta", [](const AxisVector& pose, const std::vector<double>& joints) {
    const double towers_deg[] = {90, 210, 330};
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector3d carriage = on_circle(200, towers_deg[i], joints[i]), platform = position(pose) + on_circle(40, towers_deg[i]);
      REQUIRE((carriage - platform).norm() == Approx(350).margin(1e-9));
      REQUIRE(carriage.z() > platform.z());
    }
  });
}

TEST_CASE("rotary delta: every forearm has its length, and its elbow is outward", "[kinematics]") {
  for_poses("rotary_delta", [](const AxisVector& pose, const std::vector<double>& joints) {
    const double arms_deg[] = {0, 120, 240};
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector3d out = on_circle(1, arms_deg[i]);
      const Vector3d elbow = on_circle(150, arms_deg[i]) + 200 * (std::cos(joints[i] * kRadian) * out - std::sin(joints[i] * kRadian) * Vector3d::UnitZ());
      const Vector3d platform = position(pose) + on_circle(50, arms_deg[i]);
      REQUIRE((elbow - platform).norm() == Approx(450).margin(1e-9));
      // The other elbow position is the mirror image at the line from the shoulder to the platform; ours is farther out.
      const Vector3d line = (platform - on_circle(150, arms_deg[i])).normalized();
      REQUIRE(out.cross(line).dot((elbow - on_circle(150, arms_deg[i])).cross(line)) > 0);
    }
  });
}

TEST_CASE("hexapod: legs are as long as the distance of their joints, by quaternions", "[kinematics]") {
  const double base_deg[] = {-10, 10, 110, 130, 230, 250}, platform_deg[] = {-50, 50, 70, 170, 190, 290};
  const double home_mm = std::sqrt(250.0 * 250 + 150.0 * 150 - 2 * 250 * 150 * std::cos(40 * kRadian) + 300.0 * 300);  // law of cosines
  for_poses("hexapod", [&](const AxisVector& pose, const std::vector<double>& joints) {
    const Quaterniond turn = AngleAxisd(pose[axis::kC] * kRadian, Vector3d::UnitZ()) * AngleAxisd(pose[axis::kB] * kRadian, Vector3d::UnitY()) *
                             AngleAxisd(pose[axis::kA] * kRadian, Vector3d::UnitX());
    for (std::size_t i = 0; i < 6; ++i) {
      const Vector3d leg = position(pose) + turn * on_circle(150, platform_deg[i]) - on_circle(250, base_deg[i]);
      REQUIRE(joints[i] + home_mm == Approx(leg.norm()).margin(1e-9));
    }
  });
}

TEST_CASE("hexapod: far from home the forward map goes there in stages", "[kinematics]") {
  const auto robot = standard_robot("hexapod");
  const AxisVector far = pose(120, -90, 420, 25, -20, 35);
  std::vector<double> joints(6);
  REQUIRE(robot->inverse(far, joints, joints) == "");
  AxisVector back{};
  REQUIRE(robot->forward(joints, back) == "");
  CHECK(difference(far, back, robot->axes()) < 1e-9);
}

TEST_CASE("three-jack mirror: the heads lie in the tilted plane, the pole on its normal", "[kinematics]") {
  const double x[] = {-300, 300, 0}, y[] = {-100, -100, 150};
  for_poses("three_jack_mirror", [&](const AxisVector& pose, const std::vector<double>& joints) {
    const Vector3d normal = AngleAxisd(pose[axis::kA] * kRadian, Vector3d::UnitX()) * (AngleAxisd(pose[axis::kB] * kRadian, Vector3d::UnitY()) * Vector3d::UnitZ());
    const Vector3d pole(0, 0, pose[axis::kZ]);
    for (std::size_t i = 0; i < 3; ++i) REQUIRE(normal.dot(pole - Vector3d(x[i], y[i], joints[i] - 50)) == Approx(50).margin(1e-9));
  });
}

TEST_CASE("CoreXY: one belt alone moves along a diagonal", "[kinematics]") {
  AxisVector out{};
  const double belts[2] = {10, 0};
  REQUIRE(standard_robot("corexy")->forward(belts, out) == "");
  CHECK(out[axis::kX] == 5);
  CHECK(out[axis::kY] == 5);
}
