// SCARA arm in closed form.
//
//            o wrist          r^2 = x^2 + y^2
//           / L2              E  = (r^2 - L1^2 - L2^2) / (2 L1 L2) = cos(elbow)
//    elbow o                  q  = angle at the shoulder between upper arm and r (law of cosines)
//         / L1
//        o shoulder
//
// Source: J. J. Craig, Introduction to Robotics, section 4.4; User's Manual p515-519. As a stock robot with the settings
// upper_arm_mm 400, forearm_mm 300, vertical_mm 250 (Z at joint 0), elbow 1 (sign of the elbow angle).
#include <cmath>
#include <numbers>

#include "kinematics/stock/makers.h"

namespace pmac::kinematics {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;

}  // namespace

ScaraPose scara_forward(const ScaraGeometry& g, const ScaraJoints& j) {
  const double m1 = j.shoulder_deg * kRadPerDeg;
  const double m12 = (j.shoulder_deg + j.elbow_deg) * kRadPerDeg;
  return {g.upper_arm_mm * std::cos(m1) + g.forearm_mm * std::cos(m12),
          g.upper_arm_mm * std::sin(m1) + g.forearm_mm * std::sin(m12), j.vertical_mm + g.vertical_offset_mm,
          j.shoulder_deg + j.elbow_deg + j.wrist_deg};
}

std::optional<ScaraJoints> scara_inverse(const ScaraGeometry& g, const ScaraPose& p, ScaraArm arm) {
  const double l1 = g.upper_arm_mm, l2 = g.forearm_mm;
  const double r2 = p.x_mm * p.x_mm + p.y_mm * p.y_mm;
  const double cos_elbow = (r2 - l1 * l1 - l2 * l2) / (2 * l1 * l2);
  const double cos_shoulder = (r2 + l1 * l1 - l2 * l2) / (2 * l1 * std::sqrt(r2));
  if (!(std::abs(cos_elbow) <= 1.0) || !(std::abs(cos_shoulder) <= 1.0)) return std::nullopt;
  const double side = arm == ScaraArm::kElbowPositive ? 1.0 : -1.0;
  ScaraJoints j{};
  j.elbow_deg = side * std::acos(cos_elbow) / kRadPerDeg;
  j.shoulder_deg = (std::atan2(p.y_mm, p.x_mm) - side * std::acos(cos_shoulder)) / kRadPerDeg;
  j.wrist_deg = p.c_deg - j.shoulder_deg - j.elbow_deg;
  j.vertical_mm = p.z_mm - g.vertical_offset_mm;
  return j;
}

namespace stock {
namespace {

class Scara : public Robot {
 public:
  explicit Scara(RobotSettings& s)
      : geometry_{s.length("upper_arm_mm", 400), s.length("forearm_mm", 300), s.number("vertical_mm", 250)},
        arm_(s.side("elbow", 1) > 0 ? ScaraArm::kElbowPositive : ScaraArm::kElbowNegative) {}
  int joint_count() const override { return 4; }
  std::uint32_t axes() const override { return axis::bit(axis::kX) | axis::bit(axis::kY) | axis::bit(axis::kZ) | axis::bit(axis::kC); }

  std::string forward(std::span<const double> joint, AxisVector& axis_uu) const override {
    const ScaraPose pose = scara_forward(geometry_, {joint[0], joint[1], joint[2], joint[3]});
    axis_uu[axis::kX] = pose.x_mm;
    axis_uu[axis::kY] = pose.y_mm;
    axis_uu[axis::kZ] = pose.z_mm;
    axis_uu[axis::kC] = pose.c_deg;
    return {};
  }
  std::string inverse(const AxisVector& axis_uu, std::span<const double>, std::span<double> joint) const override {
    const auto joints = scara_inverse(geometry_, {axis_uu[axis::kX], axis_uu[axis::kY], axis_uu[axis::kZ], axis_uu[axis::kC]}, arm_);
    if (!joints) return "the target is out of the arm's reach";
    joint[0] = joints->shoulder_deg;
    joint[1] = joints->elbow_deg;
    joint[2] = joints->wrist_deg;
    joint[3] = joints->vertical_mm;
    return {};
  }

 private:
  ScaraGeometry geometry_;
  ScaraArm arm_;
};

}  // namespace

std::unique_ptr<Robot> make_scara(RobotSettings& settings) { return std::make_unique<Scara>(settings); }

}  // namespace stock
}  // namespace pmac::kinematics
