// Settings of stock robots and their table.
#include "kinematics/robot.h"

#include <algorithm>
#include <cmath>

#include "kinematics/stock/makers.h"

namespace pmac::kinematics {

void RobotSettings::refuse(const std::string& why) {
  if (problem_.empty()) problem_ = why;
}

std::vector<double> RobotSettings::list(const std::string& name, std::vector<double> standard) {
  known_.insert_or_assign(name, standard);
  const auto given = values_.find(name);
  if (given == values_.end()) return standard;
  const auto finite = [](double value) { return std::isfinite(value); };
  if (!std::all_of(given->second.begin(), given->second.end(), finite)) refuse("'" + name + "' is not a finite number");
  if (given->second.size() == standard.size()) return given->second;
  refuse("'" + name + "' has " + std::to_string(given->second.size()) + " numbers and needs " + std::to_string(standard.size()));
  return standard;
}

double RobotSettings::number(const std::string& name, double standard) { return list(name, {standard})[0]; }

double RobotSettings::length(const std::string& name, double standard) {
  const double value = number(name, standard);
  if (!(value > 0)) refuse("'" + name + "' must be above 0");
  return value;
}

double RobotSettings::side(const std::string& name, double standard) {
  const double value = number(name, standard);
  if (value != 1 && value != -1) refuse("'" + name + "' is 1 or -1");
  return value;
}

std::string RobotSettings::problem() const {
  if (!problem_.empty()) return problem_;
  for (const auto& [name, values] : values_) {
    if (known_.contains(name)) continue;
    std::string names;
    for (const auto& [other, standard] : known_) names += (names.empty() ? "" : ", ") + other;
    return "there is no setting '" + name + "'; " + (names.empty() ? "this robot has none" : "there are " + names);
  }
  return {};
}

std::span<const RobotKind> robot_kinds() {
  static constexpr RobotKind kKinds[] = {
#define ROBOT(maker, name, joints, axes, text) {name, joints, axes, text, stock::make_##maker},
#include "kinematics/stock/robots.def"
#undef ROBOT
  };
  return kKinds;
}

std::unique_ptr<Robot> make_robot(std::string_view name, RobotSettings settings, std::string& problem) {
  std::string names;
  for (const RobotKind& kind : robot_kinds()) {
    names += (names.empty() ? "" : ", ") + std::string(kind.name);
    if (kind.name != name) continue;
    std::unique_ptr<Robot> robot = kind.make(settings);
    problem = settings.problem();
    return problem.empty() ? std::move(robot) : nullptr;
  }
  problem = "there is no robot '" + std::string(name) + "'; there are " + names;
  return nullptr;
}

}  // namespace pmac::kinematics
