// The wrist's middle is where the pose and the last length put it; joints 1 to 3 bring it there (a turn about Z and two links in the
// plane), joints 4 to 6 do the rest of the orientation, M = Rx(j4) Ry(j5) Rx(j6).
//
// As a stock robot: the branch of the joints before. Settings: d1_mm a1_mm a2_mm a3_mm d4_mm d6_mm (400 150 600 120 620 100), and
// home_deg 0 0 0 0 90 0: joints of the arm where the motors are at 0, by default with the flange looking down, which is A0 B0 C0.
#include "kinematics/stock/six_axis.h"

#include <algorithm>
#include <cmath>

#include "kinematics/stock/makers.h"

namespace pmac::kinematics::stock {
namespace {

using Eigen::Vector3d;

constexpr double kWristInLine = 1e-9;  // sine of joint 5

/// The flange's orientation with the arm along X: its Z looks back into the arm.
Eigen::Matrix3d flange_turn() { return turn_y(-90); }

/// The wrist's middle in the plane of the links: distance forward of joint 2 and height above it, signed by the shoulder.
struct InPlane { double forward_mm, up_mm; };

InPlane wrist_in_plane(const SixAxisGeometry& g, const Joints6& j) {
  const double upper = rad_from_deg(j[1]), fore = rad_from_deg(j[1] + j[2]);
  return {g.a2_mm * std::sin(upper) + g.d4_mm * std::cos(fore) + g.a3_mm * std::sin(fore),
          g.a2_mm * std::cos(upper) - g.d4_mm * std::sin(fore) + g.a3_mm * std::cos(fore)};
}

double forearm_mm(const SixAxisGeometry& g) { return std::hypot(g.d4_mm, g.a3_mm); }
/// Between the forearm's X and the line from elbow to wrist.
double forearm_deg(const SixAxisGeometry& g) { return deg_from_rad(std::atan2(g.a3_mm, g.d4_mm)); }

struct Arm { double j1_deg, j2_deg, j3_deg; };

std::optional<Arm> solve_arm(const SixAxisGeometry& g, const Vector3d& wrist_mm, SixAxisBranch branch, double near1_deg) {
  const double away_mm = std::hypot(wrist_mm.x(), wrist_mm.y());
  const double forward_mm = branch.shoulder * away_mm - g.a1_mm, up_mm = wrist_mm.z() - g.d1_mm;
  const double distance2 = forward_mm * forward_mm + up_mm * up_mm, fore_mm = forearm_mm(g);
  const double cos_elbow = (distance2 - g.a2_mm * g.a2_mm - fore_mm * fore_mm) / (2 * g.a2_mm * fore_mm);
  if (!(std::abs(cos_elbow) <= 1)) return std::nullopt;
  const double elbow = branch.elbow * branch.shoulder * std::acos(cos_elbow);
  const double upper_elevation = std::atan2(up_mm, forward_mm) + std::atan2(fore_mm * std::sin(elbow), g.a2_mm + fore_mm * std::cos(elbow));
  double j1_deg = near1_deg;  // above joint 1 any turn of it will do
  if (away_mm > 0) j1_deg = deg_from_rad(std::atan2(branch.shoulder * wrist_mm.y(), branch.shoulder * wrist_mm.x()));
  return Arm{j1_deg, 90 - deg_from_rad(upper_elevation), forearm_deg(g) + deg_from_rad(elbow) - 90};
}

/// Joints 4 to 6 of M.
std::array<double, 3> solve_wrist(const Eigen::Matrix3d& m, int side, double near4_deg) {
  const double sine = std::hypot(m(1, 0), m(2, 0));
  const double j5 = std::atan2(side * sine, m(0, 0));
  if (sine > kWristInLine)
    return {deg_from_rad(std::atan2(side * m(1, 0), -side * m(2, 0))), deg_from_rad(j5), deg_from_rad(std::atan2(side * m(0, 1), side * m(0, 2)))};
  const double sum_deg = deg_from_rad(std::atan2(m(2, 1), m(1, 1)));  // j4 + j6, or j4 - j6 where joint 5 is turned back
  return {near4_deg, deg_from_rad(j5), m(0, 0) > 0 ? sum_deg - near4_deg : near4_deg - sum_deg};
}

Eigen::Matrix3d arm_turn(double j1_deg, double j23_deg) { return turn_z(j1_deg) * turn_y(j23_deg); }

class SixAxis : public Robot {
 public:
  explicit SixAxis(RobotSettings& s)
      : geometry_{s.number("d1_mm", 400), s.number("a1_mm", 150), s.length("a2_mm", 600),
                  s.number("a3_mm", 120), s.length("d4_mm", 620), s.number("d6_mm", 100)},
        home_deg_(s.list("home_deg", {0, 0, 0, 0, 90, 0})) {}
  int joint_count() const override { return 6; }
  std::uint32_t axes() const override { return 7u << axis::kX | 7u << axis::kA; }

  std::string forward(std::span<const double> joint, AxisVector& axis_uu) const override {
    const FlangePose pose = six_axis_forward(geometry_, of_arm(joint));
    const Angles angles = angles_of(pose.orientation);
    for (int i = 0; i < 3; ++i) axis_uu[static_cast<std::size_t>(axis::kX + i)] = pose.position_mm(i);
    axis_uu[axis::kA] = angles.a_deg;
    axis_uu[axis::kB] = angles.b_deg;
    axis_uu[axis::kC] = angles.c_deg;
    return {};
  }
  std::string inverse(const AxisVector& axis_uu, std::span<const double> near, std::span<double> joint) const override {
    const Joints6 near_deg = of_arm(near);
    const FlangePose pose{{axis_uu[axis::kX], axis_uu[axis::kY], axis_uu[axis::kZ]},
                          rotation({axis_uu[axis::kA], axis_uu[axis::kB], axis_uu[axis::kC]})};
    const auto solution = six_axis_inverse(geometry_, pose, six_axis_branch(geometry_, near_deg), near_deg);
    if (!solution) return "the target is out of the arm's reach in the branch that it is in";
    for (std::size_t i = 0; i < 6; ++i) joint[i] = (*solution)[i] - home_deg_[i];
    return {};
  }

 private:
  Joints6 of_arm(std::span<const double> joint) const {
    Joints6 arm_deg{};
    for (std::size_t i = 0; i < 6; ++i) arm_deg[i] = joint[i] + home_deg_[i];
    return arm_deg;
  }
  SixAxisGeometry geometry_;
  std::vector<double> home_deg_;
};

}  // namespace

FlangePose six_axis_forward(const SixAxisGeometry& g, const Joints6& j) {
  const InPlane wrist = wrist_in_plane(g, j);
  const Eigen::Matrix3d turn = arm_turn(j[0], j[1] + j[2]) * turn_x(j[3]) * turn_y(j[4]) * turn_x(j[5]);
  const Vector3d wrist_mm = turn_z(j[0]) * Vector3d(g.a1_mm + wrist.forward_mm, 0, g.d1_mm + wrist.up_mm);
  return {wrist_mm + turn * Vector3d(g.d6_mm, 0, 0), turn * flange_turn()};
}

SixAxisBranch six_axis_branch(const SixAxisGeometry& g, const Joints6& j) {
  SixAxisBranch branch;
  branch.shoulder = g.a1_mm + wrist_in_plane(g, j).forward_mm < 0 ? -1 : 1;
  const double elbow_deg = std::remainder(j[2] + 90 - forearm_deg(g), 360);
  branch.elbow = elbow_deg * branch.shoulder < 0 ? -1 : 1;
  branch.wrist = std::remainder(j[4], 360) < 0 ? -1 : 1;
  return branch;
}

std::optional<Joints6> six_axis_inverse(const SixAxisGeometry& g, const FlangePose& pose, SixAxisBranch branch, const Joints6& near_deg) {
  const Vector3d wrist_mm = pose.position_mm + g.d6_mm * pose.orientation.col(2);
  const auto arm = solve_arm(g, wrist_mm, branch, near_deg[0]);
  if (!arm) return std::nullopt;
  const Eigen::Matrix3d m = arm_turn(arm->j1_deg, arm->j2_deg + arm->j3_deg).transpose() * pose.orientation * flange_turn().transpose();
  const auto wrist = solve_wrist(m, branch.wrist, near_deg[3]);
  Joints6 joint_deg{arm->j1_deg, arm->j2_deg, arm->j3_deg, wrist[0], wrist[1], wrist[2]};
  for (std::size_t i = 0; i < 6; ++i) joint_deg[i] = turned_near(joint_deg[i], near_deg[i]);
  const bool finite = std::all_of(joint_deg.begin(), joint_deg.end(), [](double deg) { return std::isfinite(deg); });
  return finite ? std::optional(joint_deg) : std::nullopt;
}

std::array<std::optional<Joints6>, 8> six_axis_inverses(const SixAxisGeometry& g, const FlangePose& pose, const Joints6& near_deg) {
  std::array<std::optional<Joints6>, 8> solutions;
  for (std::size_t i = 0; i < 8; ++i)
    solutions[i] = six_axis_inverse(g, pose, {(i & 4) ? -1 : 1, (i & 2) ? -1 : 1, (i & 1) ? -1 : 1}, near_deg);
  return solutions;
}

std::unique_ptr<Robot> make_six_axis(RobotSettings& settings) { return std::make_unique<SixAxis>(settings); }

}  // namespace pmac::kinematics::stock
