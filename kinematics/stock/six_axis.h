// Six-axis arm with a spherical wrist, in closed form, with all its branches.
//
//   joint 1 turns about Z, 2 and 3 about Y, 4 about X, 5 about Y, 6 about X; all 0: upper arm up, forearm and flange along X
//
//              a3 _o----d4----o--d6--| flange: its Z looks back into the arm, joint 6 turns it
//                | |  forearm  wrist
//                  | a2                      axes: X Y Z of the flange's middle, orientation Rz(C) Ry(B) Rx(A); A0 B0: looks down
//          a1  o___|
//          d1  |
//             ===  base
//
// Source: D. L. Pieper, The kinematics of manipulators under computer control, 1968; J. J. Craig, Introduction to Robotics, section 4.6.
#pragma once

#include <array>
#include <optional>

#include "kinematics/robot.h"
#include "kinematics/stock/geometry.h"

namespace pmac::kinematics::stock {

using Joints6 = std::array<double, 6>;  // deg

struct SixAxisGeometry { double d1_mm = 400, a1_mm = 150, a2_mm = 600, a3_mm = 120, d4_mm = 620, d6_mm = 100; };

struct FlangePose { Eigen::Vector3d position_mm; Eigen::Matrix3d orientation; };

/// Which of the eight solutions: each 1 or -1. They change only where the arm is singular.
struct SixAxisBranch {
  int shoulder = 1;  // 1: the wrist is in front of joint 1
  int elbow = 1;     // 1: the elbow is above the line from shoulder to wrist (front)
  int wrist = 1;     // sign of joint 5
};

FlangePose six_axis_forward(const SixAxisGeometry&, const Joints6& joint_deg);
/// The branch that the joints are in; at a singular place 1.
SixAxisBranch six_axis_branch(const SixAxisGeometry&, const Joints6& joint_deg);
/// The solution of a branch, each joint on the turn nearest to near_deg. Where joints 4 and 6 are in line joint 4 stays at near_deg.
/// nullopt: out of reach, or not a number.
std::optional<Joints6> six_axis_inverse(const SixAxisGeometry&, const FlangePose&, SixAxisBranch, const Joints6& near_deg);
/// Solutions by 4 * (shoulder < 0) + 2 * (elbow < 0) + (wrist < 0).
std::array<std::optional<Joints6>, 8> six_axis_inverses(const SixAxisGeometry&, const FlangePose&, const Joints6& near_deg);

}  // namespace pmac::kinematics::stock
