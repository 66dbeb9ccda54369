// Planar two-link arm in closed form: a SCARA without wrist and vertical motor. Source: J. J. Craig, Introduction to Robotics,
// section 4.4 (law of cosines). Settings: upper_arm_mm 400, forearm_mm 300, elbow 1 (sign of the elbow angle).
#include "kinematics/stock/makers.h"

namespace pmac::kinematics::stock {
namespace {

class TwoLink : public Robot {
 public:
  explicit TwoLink(RobotSettings& s)
      : geometry_{s.length("upper_arm_mm", 400), s.length("forearm_mm", 300), 0},
        arm_(s.side("elbow", 1) > 0 ? ScaraArm::kElbowPositive : ScaraArm::kElbowNegative) {}
  int joint_count() const override { return 2; }
  std::uint32_t axes() const override { return axis::bit(axis::kX) | axis::bit(axis::kY); }

  std::string forward(std::span<const double> joint, AxisVector& axis_uu) const override {
    const ScaraPose pose = scara_forward(geometry_, {joint[0], joint[1], 0, 0});
    axis_uu[axis::kX] = pose.x_mm;
    axis_uu[axis::kY] = pose.y_mm;
    return {};
  }
  std::string inverse(const AxisVector& axis_uu, std::span<const double>, std::span<double> joint) const override {
    const auto joints = scara_inverse(geometry_, {axis_uu[axis::kX], axis_uu[axis::kY], 0, 0}, arm_);
    if (!joints) return "the target is out of the arm's reach";
    joint[0] = joints->shoulder_deg;
    joint[1] = joints->elbow_deg;
    return {};
  }

 private:
  ScaraGeometry geometry_;
  ScaraArm arm_;
};

}  // namespace

std::unique_ptr<Robot> make_two_link(RobotSettings& settings) { return std::make_unique<TwoLink>(settings); }

}  // namespace pmac::kinematics::stock
