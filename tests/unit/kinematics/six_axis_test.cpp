// The eight branches of the six-axis arm, and joints along a path.
#include <catch2/catch.hpp>

#include "kinematics/stock/six_axis.h"
#include "tests/unit/kinematics/poses.h"

using namespace pmac::kinematics;
using namespace pmac::kinematics::stock;
using test::Random;

namespace {

double difference(const FlangePose& a, const FlangePose& b) {
  return std::max((a.position_mm - b.position_mm).cwiseAbs().maxCoeff(), 100 * (a.orientation - b.orientation).cwiseAbs().maxCoeff());
}

double difference(const Joints6& a, const Joints6& b) {
  double worst = 0;
  for (std::size_t i = 0; i < 6; ++i) worst = std::max(worst, std::abs(a[i] - b[i]));
  return worst;
}

}  // namespace

TEST_CASE("six-axis arm: all eight branches reach the pose, differ, and know their branch", "[kinematics]") {
  const SixAxisGeometry g;
  Random random(4711);
  int poses_with_eight = 0;
  for (int n = 0; n < 1000; ++n) {
    Joints6 joints{};
    for (double& joint : joints) joint = random(-175, 175);
    const FlangePose pose = six_axis_forward(g, joints);
    const auto all = six_axis_inverses(g, pose, joints);
    int found = 0;
    double nearest = 1e9;
    for (std::size_t i = 0; i < 8; ++i) {
      if (!all[i]) continue;
      ++found;
      REQUIRE(difference(six_axis_forward(g, *all[i]), pose) < 1e-8);
      nearest = std::min(nearest, difference(*all[i], joints));
      for (std::size_t k = 0; k < i; ++k)
        if (all[k]) CHECK(difference(*all[i], *all[k]) > 1e-3);
      const SixAxisBranch branch = six_axis_branch(g, *all[i]);
      CHECK(branch.shoulder == ((i & 4) ? -1 : 1));
      CHECK(branch.elbow == ((i & 2) ? -1 : 1));
      CHECK(branch.wrist == ((i & 1) ? -1 : 1));
    }
    CHECK(nearest < 1e-7);  // the joints that the pose came from are one of them
    poses_with_eight += found == 8;
  }
  CHECK(poses_with_eight > 100);  // near the column the arm reaches both ways
}

TEST_CASE("six-axis arm: along a straight line no joint jumps and the branch stays", "[kinematics]") {
  const SixAxisGeometry g;
  for (const int wrist : {1, -1})
    for (const int elbow : {1, -1}) {
      Joints6 near{0, elbow > 0 ? 20.0 : 60.0, elbow > 0 ? 10.0 : -140.0, 0, wrist * 60.0, 0};
      const SixAxisBranch branch = six_axis_branch(g, near);
      REQUIRE(branch.elbow == elbow);
      REQUIRE(branch.wrist == wrist);
      const FlangePose start = six_axis_forward(g, near);
      for (int i = 1; i <= 1000; ++i) {
        FlangePose pose = start;
        pose.position_mm += Eigen::Vector3d(0.05, 0.3, -0.1) * i;
        pose.orientation = turn_z(0.3 * i) * start.orientation;  // almost a turn in all: joint 6 goes beyond 180 degrees
        const auto joints = six_axis_inverse(g, pose, six_axis_branch(g, near), near);
        REQUIRE(joints);
        REQUIRE(difference(*joints, near) < 3);
        REQUIRE(difference(six_axis_forward(g, *joints), pose) < 1e-8);
        near = *joints;
      }
      CHECK(six_axis_branch(g, near).wrist == branch.wrist);
      CHECK(six_axis_branch(g, near).elbow == branch.elbow);
      CHECK(six_axis_branch(g, near).shoulder == branch.shoulder);
    }
}

TEST_CASE("six-axis arm: with joints 4 and 6 in line joint 4 stays and the pose is kept", "[kinematics]") {
  const SixAxisGeometry g;
  const Joints6 straight{30, 10, -20, 25, 0, 40};
  const FlangePose pose = six_axis_forward(g, straight);
  Joints6 near = straight;
  near[3] = 70;
  const auto joints = six_axis_inverse(g, pose, {1, 1, 1}, near);
  REQUIRE(joints);
  CHECK((*joints)[3] == 70);
  CHECK((*joints)[5] == Approx(-5).margin(1e-6));  // 25 + 40 = 70 - 5
  CHECK(difference(six_axis_forward(g, *joints), pose) < 1e-6);
}
