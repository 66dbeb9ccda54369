#include "runtime/tool/kin_check.h"
#include "runtime/gather/output_file.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <optional>
#include <random>
#include <stdexcept>

#include <unistd.h>

#include <Eigen/Dense>
#include <fmt/format.h>

namespace pmac::tool {
namespace {

using motion::AxisVector;
using MotorVector = std::array<double, bytecode::kMaxMotors>;

constexpr double kStep = 1e-5;              // of the differences, in ranges
constexpr std::size_t kMaxReasons = 8;
constexpr int kSearchSteps = 40;

struct Refused : std::runtime_error { using std::runtime_error::runtime_error; };

bool is_angle(int axis) {
  const std::string_view name = bytecode::axis_name(axis);
  return name == "A" || name == "B" || name == "C" || name == "AA" || name == "BB" || name == "CC";
}

double number_from(const std::string& text, const std::string& option) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) throw Refused("--kin-range " + option + ": '" + text + "' is not a number");
  return value;
}

/// Ranges of the options for a coordinate system.
std::vector<AxisRange> ranges_from(const std::vector<std::string>& options, int coord) {
  std::vector<AxisRange> ranges;
  for (const std::string& option : options) {
    std::string text = option;
    if (const std::size_t dot = text.find('.'); text.starts_with('&') && dot != std::string::npos) {
      if (number_from(text.substr(1, dot - 1), option) != coord) continue;
      text = text.substr(dot + 1);
    }
    const std::size_t equals = text.find('='), colon = text.find(':');
    if (equals == std::string::npos || colon == std::string::npos || colon < equals) throw Refused("--kin-range " + option + ": write AXIS=LOW:HIGH");
    AxisRange range{bytecode::axis_index_from_name(text.substr(0, equals)), number_from(text.substr(equals + 1, colon - equals - 1), option),
                    number_from(text.substr(colon + 1), option)};
    if (range.axis < 0) throw Refused("--kin-range " + option + ": there is no such axis");
    if (!(range.low_uu < range.high_uu)) throw Refused("--kin-range " + option + ": LOW must be below HIGH");
    std::erase_if(ranges, [&](const AxisRange& other) { return other.axis == range.axis; });
    ranges.push_back(range);
  }
  return ranges;
}

/// How far it is, on a terminal.
class Progress {
 public:
  explicit Progress(bool shown) : shown_(shown) {}
  void show(int done, int all) {
    const auto now = std::chrono::steady_clock::now();
    if (!shown_ || now - last_ < std::chrono::milliseconds(200)) return;
    last_ = now;
    std::fprintf(stderr, "\r%d of %d poses ", done, all);
  }
  void clear() const {
    if (shown_) std::fprintf(stderr, "\r                              \r");
  }

 private:
  bool shown_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

/// One coordinate system under check.
class Check {
 public:
  Check(runtime::Machine& machine, int coord, const KinCheckOptions& options) : machine_(machine), options_(options), random_(options.seed) {
    result_.coord = coord;
    result_.samples = options.samples;
    result_.seed = options.seed;
    result_.tolerance_uu = options.tolerance_uu;
    result_.condition_limit = options.condition;
    motors_ = machine.kinematic_motors(coord);
    low_mu_.fill(1e300);
    high_mu_.fill(-1e300);
  }

  KinCheckResult run(Progress& progress) {
    result_.ranges = ranges_from(options_.ranges, result_.coord);
    result_.by_motors = result_.ranges.empty();
    if (result_.by_motors) read_motor_ranges();
    else refuse_unknown_ranges();
    for (int i = 0; i < options_.samples; ++i) {
      progress.show(i, options_.samples);
      if (const auto pose = result_.by_motors ? pose_by_motors() : std::optional(pose_in_ranges())) check_error(*pose);
    }
    for (int i = 0; i < result_.solved; ++i) {
      progress.show(i, result_.solved);
      check_condition(solved_pose(i));
    }
    improve_worst_condition();
    sort_reasons();
    return std::move(result_);
  }

 private:
  double uniform(double low, double high) { return low + (high - low) * (static_cast<double>(random_() >> 11) * 0x1p-53); }

  std::vector<double> values(const AxisVector& pose) const {
    std::vector<double> values;
    for (const AxisRange& range : result_.ranges) values.push_back(pose[static_cast<std::size_t>(range.axis)]);
    return values;
  }

  void refuse_unknown_ranges() {
    MotorVector home{};
    AxisVector ignored{};
    (void)machine_.axes_from_motors(result_.coord, home, ignored);  // tells the machine the axes of the routine
    const std::uint32_t known = machine_.axes_of(result_.coord);
    std::uint32_t ranged = 0;
    for (const AxisRange& range : result_.ranges) {
      ranged |= 1u << range.axis;
      if (known != 0 && !(known >> range.axis & 1u))
        throw Refused(fmt::format("--kin-range: axis {} is no axis of coordinate system {}", bytecode::axis_name(range.axis), result_.coord));
    }
    for (int axis = 0; axis < bytecode::kAxisCount; ++axis)
      if (known >> axis & ~ranged >> axis & 1u)
        throw Refused(fmt::format("coordinate system {}: give a --kin-range for axis {} too", result_.coord, bytecode::axis_name(axis)));
  }

  AxisVector pose_in_ranges() {
    AxisVector pose{};
    for (const AxisRange& range : result_.ranges) pose[static_cast<std::size_t>(range.axis)] = uniform(range.low_uu, range.high_uu);
    return pose;
  }

  void read_motor_ranges() {
    for (const int motor : motors_) {
      const auto limit = machine_.motor_range_mu(motor);
      if (!limit)
        throw Refused(fmt::format("coordinate system {}: nothing says where to look; give --kin-range AXIS=LOW:HIGH, or set Motor[{}].MinPos and MaxPos", result_.coord, motor));
      motor_ranges_mu_.push_back(*limit);
    }
  }

  /// The forward map of random motor positions; the ranges are those that the poses cover.
  std::optional<AxisVector> pose_by_motors() {
    MotorVector motor_mu{};
    for (std::size_t m = 0; m < motors_.size(); ++m) motor_mu[static_cast<std::size_t>(motors_[m])] = uniform(motor_ranges_mu_[m].first, motor_ranges_mu_[m].second);
    AxisVector pose{};
    std::string why;
    if (!machine_.axes_from_motors(result_.coord, motor_mu, pose, &why)) {
      add_out_of_reach("forward: " + why, nullptr);
      return std::nullopt;
    }
    if (result_.ranges.empty())
      for (int axis = 0; axis < bytecode::kAxisCount; ++axis)
        if (machine_.axes_of(result_.coord) >> axis & 1u) result_.ranges.push_back({axis, 1e300, -1e300});
    widen(result_.ranges, pose);
    return pose;
  }

  static void widen(std::vector<AxisRange>& box, const AxisVector& pose) {
    for (AxisRange& side : box) {
      side.low_uu = std::min(side.low_uu, pose[static_cast<std::size_t>(side.axis)]);
      side.high_uu = std::max(side.high_uu, pose[static_cast<std::size_t>(side.axis)]);
    }
  }

  AxisVector solved_pose(int i) const {
    AxisVector pose{};
    const std::size_t width = result_.ranges.size();
    for (std::size_t a = 0; a < width; ++a) pose[static_cast<std::size_t>(result_.ranges[a].axis)] = solved_[static_cast<std::size_t>(i) * width + a];
    return pose;
  }

  void add_out_of_reach(const std::string& reason, const AxisVector* pose) {
    auto& groups = result_.out_of_reach;
    auto group = std::find_if(groups.begin(), groups.end(), [&](const OutOfReach& g) { return g.reason == reason; });
    if (group == groups.end() && groups.size() >= kMaxReasons) group = groups.end() - 1;
    if (group == groups.end()) group = groups.insert(groups.end(), OutOfReach{groups.size() + 1 < kMaxReasons ? reason : "other reasons", 0, {}, {}});
    ++group->count;
    if (!pose) return;
    if (group->box.empty()) {
      for (const AxisRange& range : result_.ranges) group->box.push_back({range.axis, 1e300, -1e300});
      group->first_uu = values(*pose);
    }
    widen(group->box, *pose);
  }

  void check_error(const AxisVector& pose) {
    MotorVector motor_mu{};
    if (const auto fault = machine_.motors_from_axes(result_.coord, pose, motor_mu)) {
      const std::size_t colon = fault->detail.find(": ");
      return add_out_of_reach(colon == std::string::npos ? fault->detail : fault->detail.substr(colon + 2), &pose);
    }
    AxisVector back{};
    std::string why;
    if (!machine_.axes_from_motors(result_.coord, motor_mu, back, &why)) return add_out_of_reach("forward of the inverse: " + why, &pose);
    ++result_.solved;
    const std::vector<double> row = values(pose);
    solved_.insert(solved_.end(), row.begin(), row.end());
    for (const int motor : motors_) {
      const auto m = static_cast<std::size_t>(motor);
      low_mu_[m] = std::min(low_mu_[m], motor_mu[m]);
      high_mu_[m] = std::max(high_mu_[m], motor_mu[m]);
    }
    for (const AxisRange& range : result_.ranges) note_error(pose, range.axis, back[static_cast<std::size_t>(range.axis)]);
  }

  void note_error(const AxisVector& pose, int axis, double back_uu) {
    double error = back_uu - pose[static_cast<std::size_t>(axis)];
    if (is_angle(axis)) error = std::remainder(error, 360);
    error = std::isfinite(error) ? std::abs(error) : HUGE_VAL;
    if (result_.worst_axis >= 0 && !(error > result_.worst_error_uu)) return;
    result_.worst_error_uu = error;
    result_.worst_axis = axis;
    result_.worst_uu = values(pose);
  }

  /// Condition number at a pose; nullopt where a neighbour has no solution.
  std::optional<double> condition(const AxisVector& pose) {
    Eigen::MatrixXd jacobian(motors_.size(), result_.ranges.size());
    for (std::size_t a = 0; a < result_.ranges.size(); ++a) {
      const AxisRange& range = result_.ranges[a];
      const double step_uu = kStep * (range.high_uu - range.low_uu);
      if (!(step_uu > 0)) return std::nullopt;
      AxisVector below = pose, above = pose;
      below[static_cast<std::size_t>(range.axis)] -= step_uu;
      above[static_cast<std::size_t>(range.axis)] += step_uu;
      MotorVector from{}, to{};
      if (machine_.motors_from_axes(result_.coord, below, from) || machine_.motors_from_axes(result_.coord, above, to)) return std::nullopt;
      for (std::size_t m = 0; m < motors_.size(); ++m) {
        const auto motor = static_cast<std::size_t>(motors_[m]);
        const double covered_mu = std::max(high_mu_[motor] - low_mu_[motor], 1e-300);
        jacobian(static_cast<Eigen::Index>(m), static_cast<Eigen::Index>(a)) = (to[motor] - from[motor]) / (2 * kStep) / covered_mu;
      }
    }
    const Eigen::VectorXd size = Eigen::JacobiSVD<Eigen::MatrixXd>(jacobian).singularValues();
    const double smallest = size(size.size() - 1);
    return smallest > 0 ? size(0) / smallest : HUGE_VAL;
  }

  void check_condition(const AxisVector& pose) {
    const auto number = condition(pose);
    if (!number) {
      ++result_.at_edge;
      return;
    }
    result_.singular += *number > options_.condition;
    note_condition(pose, *number);
  }

  bool note_condition(const AxisVector& pose, double number) {
    if (!(number > result_.worst_condition)) return false;
    result_.worst_condition = number;
    result_.worst_condition_uu = values(pose);
    worst_pose_ = pose;
    return true;
  }

  /// From the worst pose along the axes while it gets worse, in steps that are halved where it does not.
  void improve_worst_condition() {
    if (result_.worst_condition == 0) return;
    double part = 0.05;
    for (int i = 0; i < kSearchSteps; ++i) {
      bool better = false;
      for (const AxisRange& range : result_.ranges)
        for (const double side : {-1.0, 1.0}) {
          AxisVector pose = worst_pose_;
          double& value = pose[static_cast<std::size_t>(range.axis)];
          value = std::clamp(value + side * part * (range.high_uu - range.low_uu), range.low_uu, range.high_uu);
          if (const auto number = condition(pose)) better = note_condition(pose, *number) || better;
        }
      if (!better) part /= 2;
    }
  }

  void sort_reasons() {
    std::stable_sort(result_.out_of_reach.begin(), result_.out_of_reach.end(), [](const auto& a, const auto& b) { return a.count > b.count; });
  }

  runtime::Machine& machine_;
  const KinCheckOptions& options_;
  std::mt19937_64 random_;
  KinCheckResult result_;
  std::vector<int> motors_;
  std::vector<std::pair<double, double>> motor_ranges_mu_;
  std::vector<double> solved_;          // rows of values()
  AxisVector worst_pose_{};
  MotorVector low_mu_{}, high_mu_{};   // covered by the solutions
};

std::vector<int> coords_with_kinematics(const runtime::Machine& machine) {
  std::vector<int> coords;
  for (const int coord : machine.coords_in_use())
    if (machine.has_kinematics(coord)) coords.push_back(coord);
  return coords;
}

}  // namespace

int check_kinematics(const RunOptions& options, runtime::Machine& machine) {
  const std::vector<int> coords = coords_with_kinematics(machine);
  if (coords.empty()) {
    std::fprintf(stderr, "pmac-run: --kin-check: no motor of any coordinate system is defined ->I\n");
    return kExitUsage;
  }
  std::vector<KinCheckResult> results;
  try {
    Progress progress(!options.quiet && isatty(STDERR_FILENO) != 0);
    for (const int coord : coords) results.push_back(Check(machine, coord, options.kin_check).run(progress));
    progress.clear();
  } catch (const Refused& refused) {
    std::fprintf(stderr, "pmac-run: %s\n", refused.what());
    return kExitUsage;
  }
  const bool json = options.json != JsonDetail::kNone;
  if (json) std::fputs(kin_check_json(results).c_str(), stdout);
  for (const KinCheckResult& result : results)
    if (!json) std::fputs(kin_check_text(result).c_str(), stdout);
  runtime::flush_standard_output();
  const bool ok = std::all_of(results.begin(), results.end(), [](const KinCheckResult& r) { return r.ok(); });
  return ok && !machine.any_refused() ? kExitOk : kExitFault;
}

}  // namespace pmac::tool
