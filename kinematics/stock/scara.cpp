// SCARA arm in closed form.
//
//            o wrist          r^2 = x^2 + y^2
//           / L2              E  = (r^2 - L1^2 - L2^2) / (2 L1 L2) = cos(elbow)
//    elbow o                  q  = angle at the shoulder between upper arm and r (law of cosines)
//         / L1
//        o shoulder
#include <cmath>
#include <numbers>

#include "kinematics/kinematics.h"

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

}  // namespace pmac::kinematics
