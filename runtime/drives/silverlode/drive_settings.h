// The settings of --drive silverlode.
#pragma once

#include <algorithm>
#include <string>
#include <variant>
#include <vector>

#include "runtime/drives/drive.h"
#include "runtime/drives/silverlode/network.h"
#include "runtime/drives/silverlode/table.h"

namespace pmac::drives::silverlode {

/// Lists have one value for every axis, or one an axis in order of the motor numbers: max_speed=4000/3000.
struct DriveSettings {
  std::vector<double> max_speed_rpm{4000};
  std::vector<double> max_accel_rpm_s{30'000};
  std::vector<double> counts_per_mu{1};      // counts per motor unit; by motor, also those that never move
  double min_slice_s = 0;                    // 0: 10 ms for every axis, what the line needs
  double tolerance_counts = 0.5;             // of the table against the motion, as far as entries of min_slice reach
  std::vector<int> ids;                      // of the servos; empty: 16, 17, ...
  NetworkSetup network;

  double least_slice_s(std::size_t axes) const { return min_slice_s > 0 ? min_slice_s : 0.01 * static_cast<double>(axes); }
};

/// What is wrong: an unknown setting, a value that is none.
std::variant<DriveSettings, std::string> read_settings(const Settings& settings);

/// The value of an axis of a list.
inline double of_axis(const std::vector<double>& values, std::size_t axis) { return values[std::min(axis, values.size() - 1)]; }

}  // namespace pmac::drives::silverlode
