// Serial robots against Orocos KDL: chains of joints that know nothing of our closed forms. Each pose is a seeded random one; the
// joints that our inverse gives, sent through the chain, must give the pose, and our forward map must agree with the chain.
#include <catch2/catch.hpp>

#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>

#include "tests/unit/kinematics/poses.h"

using namespace pmac::kinematics;
using namespace pmac::kinematics::test;

namespace {

using KDL::Frame;
using KDL::Joint;
using KDL::Rotation;
using KDL::Segment;
using KDL::Vector;

constexpr double kRadian = 3.14159265358979323846 / 180;

/// A chain and which joints of the robot its joints are.
struct Model {
  KDL::Chain chain;
  std::vector<int> joint;
  std::vector<bool> turns;
  double home_deg[6] = {};

  void turn(Joint::JointType type, int of_robot, const Frame& tip = Frame::Identity()) { add(type, of_robot, true, tip); }
  void slide(Joint::JointType type, int of_robot, const Frame& tip = Frame::Identity()) { add(type, of_robot, false, tip); }
  void fixed(double x, double y, double z) { chain.addSegment(Segment(Joint(Joint::None), Frame(Vector(x, y, z)))); }

  Frame forward(const std::vector<double>& joints) const {
    KDL::JntArray q(static_cast<unsigned>(joint.size()));
    for (std::size_t i = 0; i < joint.size(); ++i) {
      const auto j = static_cast<std::size_t>(joint[i]);
      q(static_cast<unsigned>(i)) = turns[i] ? (joints[j] + home_deg[j]) * kRadian : joints[j];
    }
    Frame frame;
    KDL::ChainFkSolverPos_recursive solver(chain);
    REQUIRE(solver.JntToCart(q, frame) >= 0);
    return frame;
  }

 private:
  void add(Joint::JointType type, int of_robot, bool turning, const Frame& tip) {
    chain.addSegment(Segment(Joint(type), tip));
    joint.push_back(of_robot);
    turns.push_back(turning);
  }
};

Frame at(double x, double y, double z) { return Frame(Vector(x, y, z)); }

Model scara() {
  Model m;
  m.turn(Joint::RotZ, 0, at(400, 0, 0));
  m.turn(Joint::RotZ, 1, at(300, 0, 0));
  m.turn(Joint::RotZ, 2);
  m.slide(Joint::TransZ, 3, at(0, 0, 250));
  return m;
}

Model two_link() {
  Model m;
  m.turn(Joint::RotZ, 0, at(400, 0, 0));
  m.turn(Joint::RotZ, 1, at(300, 0, 0));
  return m;
}

Model six_axis() {
  Model m;
  m.turn(Joint::RotZ, 0, at(150, 0, 400));
  m.turn(Joint::RotY, 1, at(0, 0, 600));
  m.turn(Joint::RotY, 2, at(620, 0, 120));
  m.turn(Joint::RotX, 3);
  m.turn(Joint::RotY, 4);
  m.turn(Joint::RotX, 5, Frame(Rotation::RotY(-90 * kRadian), Vector(100, 0, 0)));
  m.home_deg[4] = 90;
  return m;
}

void slides(Model& m, double tool_mm) {
  m.slide(Joint::TransX, 0);
  m.slide(Joint::TransY, 1);
  m.slide(Joint::TransZ, 2, at(0, 0, tool_mm));
}

Model five_axis_head() {
  Model m;
  slides(m, 150);
  m.turn(Joint::RotZ, 4);
  m.turn(Joint::RotY, 3, at(0, 0, -150));
  return m;
}

/// From the work to the tool: the table's axes first.
Model five_axis_table() {
  Model m;
  m.turn(Joint::RotZ, 4, at(0, 0, -50));
  m.turn(Joint::RotX, 3, at(0, 0, 50));
  slides(m, 0);
  return m;
}

Model five_axis_head_table() {
  Model m;
  m.turn(Joint::RotZ, 4);
  slides(m, 150);
  m.turn(Joint::RotY, 3, at(0, 0, -150));
  return m;
}

/// Largest difference of the position, and with an orientation of its matrix.
double difference(const Frame& frame, const AxisVector& pose, bool with_orientation, bool in_plane) {
  double worst = std::max(std::abs(frame.p.x() - pose[axis::kX]), std::abs(frame.p.y() - pose[axis::kY]));
  if (!in_plane) worst = std::max(worst, std::abs(frame.p.z() - pose[axis::kZ]));
  if (!with_orientation) return worst;
  const Rotation want = Rotation::RPY(pose[axis::kA] * kRadian, pose[axis::kB] * kRadian, pose[axis::kC] * kRadian);
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) worst = std::max(worst, 100 * std::abs(frame.M(row, column) - want(row, column)));
  return worst;
}

void compare(const std::string& name, const Model& model, bool with_orientation, bool in_plane = false) {
  const auto robot = standard_robot(name);
  Random random(31415926);
  std::vector<double> joints(static_cast<std::size_t>(robot->joint_count())), near(joints.size());
  double worst_inverse = 0, worst_forward = 0;
  for (int i = 0; i < 3000; ++i) {
    const AxisVector want = random_pose(name, random);
    REQUIRE(robot->inverse(want, near, joints) == "");
    worst_inverse = std::max(worst_inverse, difference(model.forward(joints), want, with_orientation, in_plane));
    AxisVector ours{};
    REQUIRE(robot->forward(joints, ours) == "");
    worst_forward = std::max(worst_forward, difference(model.forward(joints), ours, with_orientation, in_plane));
  }
  INFO(name);
  CHECK(worst_inverse < 1e-9);
  CHECK(worst_forward < 1e-9);
}

}  // namespace

TEST_CASE("KDL: SCARA", "[kinematics]") { compare("scara", scara(), false); }
TEST_CASE("KDL: planar two-link arm", "[kinematics]") { compare("two_link", two_link(), false, true); }
TEST_CASE("KDL: six-axis arm, position and orientation", "[kinematics]") { compare("six_axis", six_axis(), true); }
TEST_CASE("KDL: five axes, swivel head", "[kinematics]") { compare("five_axis_head", five_axis_head(), false); }
TEST_CASE("KDL: five axes, trunnion table", "[kinematics]") { compare("five_axis_table", five_axis_table(), false); }
TEST_CASE("KDL: five axes, head and table", "[kinematics]") { compare("five_axis_head_table", five_axis_head_table(), false); }

TEST_CASE("KDL: the wrist of the SCARA points where C says", "[kinematics]") {
  const auto robot = standard_robot("scara");
  const Model model = scara();
  std::vector<double> joints(4);
  REQUIRE(robot->inverse(pose(300, 400, 200, 0, 0, 45), joints, joints) == "");
  double roll = 0, pitch = 0, yaw = 0;
  model.forward(joints).M.GetRPY(roll, pitch, yaw);
  CHECK(yaw / kRadian == Approx(45).margin(1e-9));
}
