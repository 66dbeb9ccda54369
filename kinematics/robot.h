// Stock robots behind one interface: joints to axes and back, in closed form or by a bounded solver. A robot is chosen by name and
// by settings (lengths in mm, angles in degrees); stock/robots.def lists them. Nothing here knows programs, motors or time.
//
//     std::string problem;
//     const auto robot = make_robot("hexapod", settings, problem);     // null, and why
//     problem = robot->inverse(pose, near, joints);                    // empty: solved
#pragma once

#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kinematics/kinematics.h"

namespace pmac::kinematics {

/// Indices of the axes that stock robots serve.
namespace axis {
inline constexpr int kA = 0, kB = 1, kC = 2, kX = 6, kY = 7, kZ = 8;
inline constexpr std::uint32_t bit(int index) { return 1u << index; }
}  // namespace axis

/// One robot: a fixed geometry. Both maps are functions of their arguments alone.
class Robot {
 public:
  virtual ~Robot() = default;
  virtual int joint_count() const = 0;
  /// Axes of a pose, as a mask of axis indices.
  virtual std::uint32_t axes() const = 0;
  /// joint: [joint_count()]. Sets the axes of axes() and no others. Answers why there is no pose, or empty.
  virtual std::string forward(std::span<const double> joint, AxisVector& axis_uu) const = 0;
  /// near: [joint_count()], the joints before this pose on a path. A robot with several solutions answers the one of the same
  /// branch; without one (it says so in its file) near is not used. Answers why there is no solution, or empty.
  virtual std::string inverse(const AxisVector& axis_uu, std::span<const double> near, std::span<double> joint) const = 0;
};

/// Named numbers that a robot is made from. Reading one tells its default; whatever is wrong is collected in problem().
class RobotSettings {
 public:
  void set(const std::string& name, std::vector<double> values) { values_[name] = std::move(values); }
  /// One number.
  double number(const std::string& name, double standard);
  /// One number above 0.
  double length(const std::string& name, double standard);
  /// 1 or -1.
  double side(const std::string& name, double standard);
  /// As many numbers as the standard has.
  std::vector<double> list(const std::string& name, std::vector<double> standard);
  /// Why the settings do not describe a robot, or empty; after all have been read, a name that nobody read too.
  std::string problem() const;
  /// What has been read, with the standards.
  const std::map<std::string, std::vector<double>>& standards() const { return known_; }

 private:
  void refuse(const std::string& why);
  std::map<std::string, std::vector<double>> values_, known_;
  std::string problem_;
};

/// A row of stock/robots.def.
struct RobotKind {
  std::string_view name, joints, axes, text;
  std::unique_ptr<Robot> (*make)(RobotSettings&);
};
std::span<const RobotKind> robot_kinds();

/// The robot of that name; null with the problem where the name or a setting is wrong.
std::unique_ptr<Robot> make_robot(std::string_view name, RobotSettings settings, std::string& problem);

}  // namespace pmac::kinematics
