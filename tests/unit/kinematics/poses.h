// Seeded random poses in the reach of the stock robots with their standard settings.
#pragma once

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "kinematics/robot.h"

namespace pmac::kinematics::test {

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double operator()(double low, double high) { return low + (high - low) * (static_cast<double>(engine_() >> 11) * 0x1p-53); }

 private:
  std::mt19937_64 engine_;
};

inline AxisVector pose(double x, double y, double z, double a = 0, double b = 0, double c = 0) {
  AxisVector axes{};
  axes[axis::kX] = x;
  axes[axis::kY] = y;
  axes[axis::kZ] = z;
  axes[axis::kA] = a;
  axes[axis::kB] = b;
  axes[axis::kC] = c;
  return axes;
}

/// A pose that the robot reaches, away from its singular ones.
inline AxisVector random_pose(const std::string& robot, Random& random) {
  const auto around = [&](double low, double high) {
    const double r = random(low, high), turn = random(-3.1, 3.1);
    return std::pair(r * std::cos(turn), r * std::sin(turn));
  };
  if (robot == "scara" || robot == "two_link") {
    const auto [x, y] = around(130, 680);  // elbow between 17 and 153 degrees
    return robot == "scara" ? pose(x, y, random(0, 500), 0, 0, random(-170, 170)) : pose(x, y, 0);
  }
  if (robot == "linear_delta") {
    const auto [x, y] = around(0, 120);
    return pose(x, y, random(-400, -200));
  }
  if (robot == "rotary_delta") {
    const auto [x, y] = around(0, 150);
    return pose(x, y, random(-500, -320));
  }
  if (robot == "hexapod")
    return pose(random(-40, 40), random(-40, 40), random(270, 340), random(-12, 12), random(-12, 12), random(-15, 15));
  if (robot == "five_axis_table") return pose(random(-200, 200), random(-200, 200), random(-100, 100), random(-110, 30), 0, random(-350, 350));
  if (robot == "five_axis_head" || robot == "five_axis_head_table")
    return pose(random(-200, 200), random(-200, 200), random(-100, 100), 0, random(-90, 90), random(-350, 350));
  if (robot == "six_axis") {
    const double side = random(-1, 1) < 0 ? -1 : 1;
    return pose(random(500, 900), random(-300, 300), random(300, 800), random(-40, 40), side * random(2, 40), random(-150, 150));
  }
  if (robot == "corexy") return pose(random(-200, 200), random(-200, 200), 0);
  return pose(0, 0, random(-5, 5), random(-2, 2), random(-2, 2), 0);  // three_jack_mirror
}

inline std::unique_ptr<Robot> standard_robot(const std::string& name) {
  std::string problem;
  return make_robot(name, {}, problem);
}

/// Largest difference on the axes of the mask; angles modulo a turn.
inline double difference(const AxisVector& a, const AxisVector& b, std::uint32_t mask) {
  double worst = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!(mask >> i & 1u)) continue;
    const double d = a[i] - b[i];
    worst = std::max(worst, std::abs(i <= 2 ? std::remainder(d, 360) : d));
  }
  return worst;
}

}  // namespace pmac::kinematics::test
