// The two-link arm of the vendor's kinematics example (links 400 and 300 mm), motors in degrees.
#pragma once

#include <cmath>
#include <numbers>
#include <utility>

#include "tests/unit/motion/scenario.h"

namespace pmac::motion::test {

inline constexpr double kDegree = std::numbers::pi / 180;

inline std::pair<double, double> scara_forward(double shoulder_deg, double elbow_deg) {
  const double a = shoulder_deg * kDegree, b = (shoulder_deg + elbow_deg) * kDegree;
  return {400 * std::cos(a) + 300 * std::cos(b), 400 * std::sin(a) + 300 * std::sin(b)};
}

inline PipelineConfig scara_config() {
  PipelineConfig config;
  config.map.motors = {1, 2};
  config.limits.resize(2);
  config.map.inverse = [](const AxisVector& axis, double* motor, SourceLine source) -> std::optional<runtime::Fault> {
    const double x = axis[kX], y = axis[kY], r2 = x * x + y * y;
    const double cos_elbow = (r2 - 250000) / 240000;
    if (!(std::abs(cos_elbow) < 0.996)) return runtime::Fault{runtime::FaultKind::kInverseKinematics, source, "out of reach"};
    motor[1] = std::acos(cos_elbow) / kDegree;
    motor[0] = (std::atan2(y, x) - std::acos((r2 + 70000) / (800 * std::sqrt(r2)))) / kDegree;
    return std::nullopt;
  };
  return config;
}

}  // namespace pmac::motion::test
