#include "runtime/tool/robots.h"

#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "kinematics/robot.h"
#include "runtime/gather/output_file.h"
#include "runtime/tool/load.h"

namespace pmac::tool {
namespace {

using kinematics::Robot;
using kinematics::RobotSettings;

constexpr const char* kMotorUnits = "motor_mu";

/// What is wrong with an option, for the user.
struct Refused : std::runtime_error { using std::runtime_error::runtime_error; };

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == separator) parts.emplace_back();
    else parts.back() += c;
  }
  return parts;
}

double number_from(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) throw Refused("'" + text + "' is not a number");
  return value;
}

using Values = std::map<std::string, std::vector<double>>;

Values values_from_text(const std::string& text) {
  Values values;
  for (const std::string& part : split(text, ',')) {
    const std::size_t equals = part.find('=');
    if (equals == std::string::npos || equals == 0) throw Refused("'" + part + "' is no setting; write NAME=VALUE, or the name of a .json file");
    std::vector<double>& numbers = values[part.substr(0, equals)];
    numbers.clear();
    for (const std::string& number : split(part.substr(equals + 1), '/')) numbers.push_back(number_from(number));
  }
  return values;
}

Values values_from_file(const std::string& name) {
  std::string bytes;
  if (!read_file(name, bytes)) throw Refused("cannot read " + name + ": " + std::strerror(errno));
  const auto json = nlohmann::json::parse(bytes, nullptr, false, true);
  if (!json.is_object()) throw Refused(name + " is not a JSON object of settings");
  Values values;
  for (const auto& [key, value] : json.items()) {
    const bool list = value.is_array() && !value.empty();
    for (const auto& number : list ? value : nlohmann::json::array({value})) {
      if (!number.is_number()) throw Refused(name + ": '" + key + "' is neither a number nor a list of numbers");
      values[key].push_back(number.get<double>());
    }
  }
  return values;
}

struct Choice {
  int coord = 0;
  std::string name;
  Values values;
};

Choice choice_from(const std::string& text) {
  const std::size_t equals = text.find('='), colon = text.find(':');
  if (equals == std::string::npos || (colon != std::string::npos && colon < equals)) throw Refused("write N=ROBOT, with N the coordinate system");
  Choice choice;
  const double coord = number_from(text.substr(text.starts_with('&') ? 1 : 0, equals - (text.starts_with('&') ? 1 : 0)));
  if (!(coord >= 0 && coord < bytecode::kMaxCoords) || coord != std::floor(coord)) throw Refused(fmt::format("coordinate systems are 0 to {}", bytecode::kMaxCoords - 1));
  choice.coord = static_cast<int>(coord);
  choice.name = text.substr(equals + 1, colon == std::string::npos ? std::string::npos : colon - equals - 1);
  if (colon == std::string::npos) return choice;
  const std::string settings = text.substr(colon + 1);
  choice.values = settings.ends_with(".json") ? values_from_file(settings) : values_from_text(settings);
  return choice;
}

/// Takes motor_mu out of the settings.
std::vector<double> motor_units(Values& values) {
  const auto given = values.find(kMotorUnits);
  if (given == values.end()) return {1.0};
  std::vector<double> units = given->second;
  for (const double unit : units)
    if (unit == 0 || !std::isfinite(unit)) throw Refused("'motor_mu' must not be 0");
  values.erase(given);
  return units;
}

void set_robot(const std::string& text, runtime::Machine& machine) {
  Choice choice = choice_from(text);
  std::vector<double> units = motor_units(choice.values);
  RobotSettings settings;
  for (const auto& [name, numbers] : choice.values) settings.set(name, numbers);
  std::string problem;
  std::shared_ptr<const Robot> robot = kinematics::make_robot(choice.name, settings, problem);
  if (!robot) throw Refused(problem);
  const auto joints = static_cast<std::size_t>(robot->joint_count());
  if (units.size() != 1 && units.size() != joints)
    throw Refused(fmt::format("'motor_mu' has {} numbers and needs 1 or {}", units.size(), joints));
  machine.set_robot(choice.coord, std::move(robot), std::move(units));
}

}  // namespace

int set_robots(const RunOptions& options, runtime::Machine& machine) {
  for (const std::string& text : options.robots) {
    try {
      set_robot(text, machine);
    } catch (const Refused& refused) {
      std::fprintf(stderr, "pmac-run: --kinematics %s: %s\n", text.c_str(), refused.what());
      return kExitUsage;
    }
  }
  return kExitOk;
}

int list_robots() {
  for (const kinematics::RobotKind& kind : kinematics::robot_kinds()) {
    RobotSettings settings;
    kind.make(settings);
    fmt::print("{}: {}\n  axes {}; joints {}\n", kind.name, kind.text, kind.axes, kind.joints);
    for (const auto& [name, standard] : settings.standards()) fmt::print("  {}={}\n", name, fmt::join(standard, "/"));
  }
  fmt::print("every robot: motor_mu=1 (motor units per mm or degree of a joint; one number, or one a joint)\n");
  runtime::flush_standard_output();
  return kExitOk;
}

}  // namespace pmac::tool
