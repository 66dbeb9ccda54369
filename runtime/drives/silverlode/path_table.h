// The corrected builder: from corner points and slices of time to a table that closes, for any number of axes.
//
// An entry is one ramp at constant acceleration and then a stretch at constant speed; ramps are centred on the corners:
//
//     speed    ____________              T[i]     time from corner i-1 to corner i
//             /            \_________    ramp[i]  the change of speed at corner i-1, half of it before the corner
//            /                       \   entry i runs from the start of ramp[i] to the start of ramp[i+1]
//        corner 0        corner 1    corner 2
//
// All times are whole ticks and all ramps even, so nothing is rounded and the distances add up to the corners exactly. Slices grow until
// every change of speed fits into the limits: forwards from rest, backwards from rest, until nothing grows.
//
// Source: application note "Make Circles" (method); the planning and the rounding are this project's.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "runtime/drives/silverlode/table.h"

namespace pmac::drives::silverlode {

struct PathTable {
  std::vector<double> slice_ticks;      // [1..n] wanted time of each segment, whole, at least 1; not used with ramp_ticks
  double least_slice_ticks = 0;
  std::vector<AxisLimits> limits;       // [axis]
  /// [1..n+1] length of each ramp, whole and even; each slice is then the mean of its two ramps, there is no stretch at constant speed, and
  /// who gives them has seen to the limits. Empty: as short as the limits allow.
  std::vector<double> ramp_ticks;
  /// Each entry makes up for what rounding cost the entries before it.
  bool makes_up = false;
};

/// Fills every column after position and delta. Returns why there is no such table, or nothing.
std::optional<std::string> fill_closed(Sheet& sheet, const PathTable& path);

}  // namespace pmac::drives::silverlode
