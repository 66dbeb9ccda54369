// Stewart platform: six legs between a base and a platform, both flat. X Y Z is the middle of the platform above the middle of the
// base, its orientation Rz(C) Ry(B) Rx(A). A joint is the extension of a leg over its length in the home pose (0, 0, home_mm, 0, 0, 0).
//
//   leg length |p + R b_i - a_i|: inverse in closed form
//   forward: Newton on the six lengths from the home pose; where that does not converge, along a straight line in leg lengths from
//   the home pose in ever more steps, so that the platform stays assembled as it is there
//
// Source: D. Stewart, A platform with six degrees of freedom, 1965; J.-P. Merlet, Parallel Robots, chapter 4.
// Settings: base_radius_mm 250, base_deg -10 10 110 130 230 250, platform_radius_mm 150, platform_deg -50 50 70 170 190 290,
// home_mm 300.
#include <cmath>

#include "kinematics/stock/geometry.h"
#include "kinematics/stock/makers.h"

namespace pmac::kinematics::stock {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Points = Eigen::Matrix<double, 3, 6>;

constexpr int kMaxNewton = 12;           // quadratic: 4 to 6 near the home pose
constexpr int kMaxStages = 32;           // parts of the way in leg lengths
constexpr double kConverged_mm = 1e-12;  // last change of a length

/// On a circle, flat.
Points ring(double radius_mm, const std::vector<double>& angles_deg) {
  Points points;
  for (int i = 0; i < 6; ++i) {
    const double angle_rad = rad_from_deg(angles_deg[static_cast<std::size_t>(i)]);
    points.col(i) = Eigen::Vector3d(radius_mm * std::cos(angle_rad), radius_mm * std::sin(angle_rad), 0);
  }
  return points;
}

class Hexapod : public Robot {
 public:
  explicit Hexapod(RobotSettings& s)
      : base_mm_(ring(s.length("base_radius_mm", 250), s.list("base_deg", {-10, 10, 110, 130, 230, 250}))),
        platform_mm_(ring(s.length("platform_radius_mm", 150), s.list("platform_deg", {-50, 50, 70, 170, 190, 290}))) {
    home_ << 0, 0, s.length("home_mm", 300), 0, 0, 0;
    home_length_mm_ = legs(home_).colwise().norm().transpose();
  }
  int joint_count() const override { return 6; }
  std::uint32_t axes() const override { return 7u << axis::kX | 7u << axis::kA; }

  std::string forward(std::span<const double> joint, AxisVector& axis_uu) const override {
    const Vector6 extension = Eigen::Map<const Vector6>(joint.data());
    if (!(extension + home_length_mm_).allFinite() || (extension + home_length_mm_).minCoeff() <= 0) return "a leg has no length";
    for (int stages = 1; stages <= kMaxStages; stages *= 2) {
      Vector6 pose = home_;
      bool solved = true;
      for (int stage = 1; solved && stage <= stages; ++stage) solved = newton(home_length_mm_ + extension * stage / stages, pose);
      if (solved) return answer(pose, axis_uu);
    }
    return "no pose of the platform has these leg lengths";
  }
  std::string inverse(const AxisVector& axis_uu, std::span<const double>, std::span<double> joint) const override {
    Vector6 pose;
    pose << axis_uu[axis::kX], axis_uu[axis::kY], axis_uu[axis::kZ], axis_uu[axis::kA], axis_uu[axis::kB], axis_uu[axis::kC];
    const Vector6 length_mm = legs(pose).colwise().norm().transpose();
    if (!length_mm.allFinite()) return "the target is not a number";
    Eigen::Map<Vector6>(joint.data()) = length_mm - home_length_mm_;
    return {};
  }

 private:
  /// pose: x y z (mm) a b c (deg). Columns: from base joint to platform joint.
  Points legs(const Vector6& pose) const {
    return (rotation({pose(3), pose(4), pose(5)}) * platform_mm_).colwise() + Eigen::Vector3d(pose.head<3>()) - base_mm_;
  }

  /// d length / d (x y z, a b c in rad): direction of the leg, and its moment about the axes that the angles turn about.
  Matrix6 jacobian(const Vector6& pose, const Points& leg_mm) const {
    const Eigen::Matrix3d r = rotation({pose(3), pose(4), pose(5)});
    Eigen::Matrix3d turned_axes;
    turned_axes.col(0) = turn_z(pose(5)) * turn_y(pose(4)) * Eigen::Vector3d::UnitX();
    turned_axes.col(1) = turn_z(pose(5)) * Eigen::Vector3d::UnitY();
    turned_axes.col(2) = Eigen::Vector3d::UnitZ();
    Matrix6 j;
    for (int i = 0; i < 6; ++i) {
      const Eigen::Vector3d direction = leg_mm.col(i).normalized(), arm = r * platform_mm_.col(i);
      j.row(i).head<3>() = direction.transpose();
      j.row(i).tail<3>() = arm.cross(direction).transpose() * turned_axes;
    }
    return j;
  }

  /// Improves the pose until it has these lengths. False: it does not within kMaxNewton steps.
  bool newton(const Vector6& length_mm, Vector6& pose) const {
    for (int i = 0; i < kMaxNewton; ++i) {
      const Points leg_mm = legs(pose);
      const Vector6 missing_mm = length_mm - leg_mm.colwise().norm().transpose();
      Vector6 step = jacobian(pose, leg_mm).partialPivLu().solve(missing_mm);
      if (!step.allFinite()) return false;
      step.tail<3>() /= kRadPerDeg;
      pose += step;
      if (missing_mm.cwiseAbs().maxCoeff() < kConverged_mm * length_mm.maxCoeff()) return true;
    }
    return false;
  }

  std::string answer(const Vector6& pose, AxisVector& axis_uu) const {
    for (int i = 0; i < 3; ++i) {
      axis_uu[static_cast<std::size_t>(axis::kX + i)] = pose(i);
      axis_uu[static_cast<std::size_t>(axis::kA + i)] = pose(3 + i);
    }
    return {};
  }

  Points base_mm_, platform_mm_;
  Vector6 home_, home_length_mm_;
};

}  // namespace

std::unique_ptr<Robot> make_hexapod(RobotSettings& settings) { return std::make_unique<Hexapod>(settings); }

}  // namespace pmac::kinematics::stock
