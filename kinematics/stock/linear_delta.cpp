// Delta robot with three vertical sliders. Every rod runs from a carriage to the platform and stays parallel to itself, so that the
// platform is the point at one rod length from three carriages that are moved inward by the platform's radius.
//
//    tower |        joint: height of the carriage
//          o--._ rod
//          |    `o platform, X Y Z is its middle
//
// Source: R. L. Williams II, The Delta Parallel Robot: Kinematics Solutions (prismatic input). Closed form both ways.
// Settings: tower_radius_mm 200, platform_radius_mm 40, rod_mm 350, tower_deg 90 210 330 (directions of the towers).
#include <cmath>

#include "kinematics/stock/geometry.h"
#include "kinematics/stock/makers.h"

namespace pmac::kinematics::stock {
namespace {

class LinearDelta : public Robot {
 public:
  explicit LinearDelta(RobotSettings& s) : rod_mm_(s.length("rod_mm", 350)) {
    const double radius_mm = s.length("tower_radius_mm", 200) - s.number("platform_radius_mm", 40);
    const std::vector<double> tower_deg = s.list("tower_deg", {90, 210, 330});
    for (int i = 0; i < 3; ++i) {
      const double angle_rad = rad_from_deg(tower_deg[static_cast<std::size_t>(i)]);
      towers_mm_.col(i) = Eigen::Vector3d(radius_mm * std::cos(angle_rad), radius_mm * std::sin(angle_rad), 0);
    }
  }
  int joint_count() const override { return 3; }
  std::uint32_t axes() const override { return axis::bit(axis::kX) | axis::bit(axis::kY) | axis::bit(axis::kZ); }

  std::string forward(std::span<const double> joint, AxisVector& axis_uu) const override {
    Eigen::Matrix3d carriages_mm = towers_mm_;
    for (int i = 0; i < 3; ++i) carriages_mm(2, i) = joint[static_cast<std::size_t>(i)];
    const auto point = lower_point(carriages_mm, rod_mm_);
    if (!point) return "the rods do not meet: the carriages are too far apart";
    for (int i = 0; i < 3; ++i) axis_uu[static_cast<std::size_t>(axis::kX + i)] = (*point)(i);
    return {};
  }
  std::string inverse(const AxisVector& axis_uu, std::span<const double>, std::span<double> joint) const override {
    for (int i = 0; i < 3; ++i) {
      const double dx = axis_uu[axis::kX] - towers_mm_(0, i), dy = axis_uu[axis::kY] - towers_mm_(1, i);
      const double height2 = rod_mm_ * rod_mm_ - dx * dx - dy * dy;
      if (!(height2 >= 0)) return "the rod of tower " + std::to_string(i + 1) + " is too short";
      joint[static_cast<std::size_t>(i)] = axis_uu[axis::kZ] + std::sqrt(height2);
    }
    return {};
  }

 private:
  double rod_mm_;
  Eigen::Matrix3d towers_mm_;  // columns
};

}  // namespace

std::unique_ptr<Robot> make_linear_delta(RobotSettings& settings) { return std::make_unique<LinearDelta>(settings); }

}  // namespace pmac::kinematics::stock
