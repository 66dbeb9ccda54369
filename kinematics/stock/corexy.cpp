// CoreXY: two belts of which each moves both axes. Belt a = x + y, belt b = x - y. Source: I. E. Moyer, CoreXY Cartesian motion
// platform, theory of operation. No settings; a linear map, which axis definitions (#1->X+Y #2->X-Y) express as well.
#include "kinematics/stock/makers.h"

namespace pmac::kinematics::stock {
namespace {

class CoreXY : public Robot {
 public:
  int joint_count() const override { return 2; }
  std::uint32_t axes() const override { return axis::bit(axis::kX) | axis::bit(axis::kY); }

  std::string forward(std::span<const double> joint, AxisVector& axis_uu) const override {
    axis_uu[axis::kX] = (joint[0] + joint[1]) / 2;
    axis_uu[axis::kY] = (joint[0] - joint[1]) / 2;
    return {};
  }
  std::string inverse(const AxisVector& axis_uu, std::span<const double>, std::span<double> joint) const override {
    joint[0] = axis_uu[axis::kX] + axis_uu[axis::kY];
    joint[1] = axis_uu[axis::kX] - axis_uu[axis::kY];
    return {};
  }
};

}  // namespace

std::unique_ptr<Robot> make_corexy(RobotSettings&) { return std::make_unique<CoreXY>(); }

}  // namespace pmac::kinematics::stock
