// Delta robot with three turning arms. The elbows, moved inward by the platform's radius, are the centres of three spheres of one
// forearm length; the platform is the lower point where they meet. Joint 0: the arm is horizontal; positive: its elbow goes down.
//
//      base o=====o elbow          e = base - platform radius - distance of the target along the arm's direction
//        joint     \ forearm       2 e L1 cos q + 2 z L1 sin q + e^2 + y^2 + z^2 + L1^2 - L2^2 = 0, elbow outward
//                   o platform
//
// Source: R. Clavel, Delta, a fast robot with parallel geometry, 1988; R. L. Williams II, The Delta Parallel Robot: Kinematics
// Solutions. Closed form both ways.
// Settings: base_radius_mm 150, platform_radius_mm 50, upper_arm_mm 200, forearm_mm 450, arm_deg 0 120 240 (directions of the arms).
#include <cmath>

#include "kinematics/stock/geometry.h"
#include "kinematics/stock/makers.h"

namespace pmac::kinematics::stock {
namespace {

class RotaryDelta : public Robot {
 public:
  explicit RotaryDelta(RobotSettings& s)
      : radius_mm_(s.length("base_radius_mm", 150) - s.number("platform_radius_mm", 50)),
        upper_mm_(s.length("upper_arm_mm", 200)),
        fore_mm_(s.length("forearm_mm", 450)),
        arm_deg_(s.list("arm_deg", {0, 120, 240})) {}
  int joint_count() const override { return 3; }
  std::uint32_t axes() const override { return axis::bit(axis::kX) | axis::bit(axis::kY) | axis::bit(axis::kZ); }

  std::string forward(std::span<const double> joint, AxisVector& axis_uu) const override {
    Eigen::Matrix3d elbows_mm;
    for (int i = 0; i < 3; ++i) {
      const double joint_rad = rad_from_deg(joint[static_cast<std::size_t>(i)]), arm_rad = rad_from_deg(arm_deg_[static_cast<std::size_t>(i)]);
      const double out_mm = radius_mm_ + upper_mm_ * std::cos(joint_rad);
      elbows_mm.col(i) = Eigen::Vector3d(out_mm * std::cos(arm_rad), out_mm * std::sin(arm_rad), -upper_mm_ * std::sin(joint_rad));
    }
    const auto point = lower_point(elbows_mm, fore_mm_);
    if (!point) return "the forearms do not meet: the elbows are too far apart";
    for (int i = 0; i < 3; ++i) axis_uu[static_cast<std::size_t>(axis::kX + i)] = (*point)(i);
    return {};
  }
  std::string inverse(const AxisVector& axis_uu, std::span<const double>, std::span<double> joint) const override {
    const double x = axis_uu[axis::kX], y = axis_uu[axis::kY], z = axis_uu[axis::kZ];
    for (int i = 0; i < 3; ++i) {
      const double arm_rad = rad_from_deg(arm_deg_[static_cast<std::size_t>(i)]);
      const double e = radius_mm_ - (x * std::cos(arm_rad) + y * std::sin(arm_rad));
      const double side = y * std::cos(arm_rad) - x * std::sin(arm_rad);
      const double g = (e * e + side * side + z * z + upper_mm_ * upper_mm_ - fore_mm_ * fore_mm_) / (2 * upper_mm_);
      const double cosine = -g / std::hypot(e, z);
      if (!(std::abs(cosine) <= 1)) return "the target is out of the reach of arm " + std::to_string(i + 1);
      joint[static_cast<std::size_t>(i)] = deg_from_rad(std::atan2(z, e) + std::acos(cosine));
    }
    return {};
  }

 private:
  double radius_mm_, upper_mm_, fore_mm_;
  std::vector<double> arm_deg_;
};

}  // namespace

std::unique_ptr<Robot> make_rotary_delta(RobotSettings& settings) { return std::make_unique<RotaryDelta>(settings); }

}  // namespace pmac::kinematics::stock
