// A mirror on three vertical jacks. The jacks' heads carry a plane that is tilted by A (about X) and then B (about the tilted Y); the
// mirror's pole stands mirror_mm above that plane on its normal, at x = y = 0.
//
//             _--o pole, height Z
//         _--  _-|--- mirror_mm        normal n = (sin B, -sin A cos B, cos A cos B)
//      o-----o-----o  heads            head i = Z - (mirror_mm + nx x_i + ny y_i) / nz
//      |     |     |  jacks
//
// Source: the plane through three points; no approximation for small angles. Closed form both ways.
// Settings: x_mm -300 300 0, y_mm -100 -100 150 (where the jacks stand), mirror_mm 50. Joint 0: the head is at Z = -mirror_mm.
#include <cmath>

#include "kinematics/stock/geometry.h"
#include "kinematics/stock/makers.h"

namespace pmac::kinematics::stock {
namespace {

class ThreeJackMirror : public Robot {
 public:
  explicit ThreeJackMirror(RobotSettings& s)
      : x_mm_(s.list("x_mm", {-300, 300, 0})), y_mm_(s.list("y_mm", {-100, -100, 150})), mirror_mm_(s.number("mirror_mm", 50)) {}
  int joint_count() const override { return 3; }
  std::uint32_t axes() const override { return axis::bit(axis::kZ) | axis::bit(axis::kA) | axis::bit(axis::kB); }

  std::string forward(std::span<const double> joint, AxisVector& axis_uu) const override {
    const auto head = [&](std::size_t i) { return Eigen::Vector3d(x_mm_[i], y_mm_[i], joint[i] - mirror_mm_); };
    Eigen::Vector3d normal = (head(1) - head(0)).cross(head(2) - head(0));
    if (normal.z() < 0) normal = -normal;
    normal.normalize();
    if (!(normal.z() > 0)) return "the jacks stand on one line";
    axis_uu[axis::kB] = deg_from_rad(std::asin(normal.x()));
    axis_uu[axis::kA] = deg_from_rad(std::atan2(-normal.y(), normal.z()));
    axis_uu[axis::kZ] = (normal.dot(head(0)) + mirror_mm_) / normal.z();
    return {};
  }
  std::string inverse(const AxisVector& axis_uu, std::span<const double>, std::span<double> joint) const override {
    const Eigen::Vector3d normal = turn_x(axis_uu[axis::kA]) * turn_y(axis_uu[axis::kB]) * Eigen::Vector3d::UnitZ();
    if (!(normal.z() > 0)) return "the mirror is tilted by 90 degrees or more";
    for (std::size_t i = 0; i < 3; ++i)
      joint[i] = axis_uu[axis::kZ] - (mirror_mm_ + normal.x() * x_mm_[i] + normal.y() * y_mm_[i]) / normal.z() + mirror_mm_;
    return {};
  }

 private:
  std::vector<double> x_mm_, y_mm_;
  double mirror_mm_;
};

}  // namespace

std::unique_ptr<Robot> make_three_jack_mirror(RobotSettings& settings) { return std::make_unique<ThreeJackMirror>(settings); }

}  // namespace pmac::kinematics::stock
