// The note's dialog "Circle Setup": an arc as straight segments, and the two ways to make its table.
//
// Source: application note "Make Circles", CCircleSetup::BuildTable() and the walk through its spreadsheet.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "runtime/drives/silverlode/table.h"

namespace pmac::drives::silverlode {

struct CircleSetup {
  std::int64_t segments = 72;
  double radius = 4000;                 // user units
  double start_angle_deg = 0;           // counter-clockwise from the X axis
  double offset_x = 0, offset_y = 0;    // user units: the first point of the arc
  double distance_angle_deg = 360;      // its sign is the direction
  double velocity = 1000;               // user units/s, tangential
  double scale_x = 1, scale_y = 1;      // counts per user unit
  double min_slice_s = 0;               // 0: none
  std::vector<AxisLimits> limits;       // X, Y and theta where there is a knife
  std::optional<double> knife_counts_deg;  // third axis: a knife that points along the cut, counts per degree

  std::size_t axis_count() const { return knife_counts_deg ? 3 : 2; }
};

inline constexpr std::int64_t kMostSegments = 1'000'000;

/// What is wrong with the setup, or nothing.
std::optional<std::string> problem_of(const CircleSetup& setup);

/// Centre of the arc, user units.
struct Center { double x, y; };
Center center_of(const CircleSetup& setup);

/// The note's arithmetic as it is printed, with its roundings, and the terminating entry that it leaves out (ceil of the ramp + 1
/// ticks). The setup has no problem.
Sheet build_literal(const CircleSetup& setup);

/// The corrected builder: whole even ramps and whole slices, so that the table closes. The setup has no problem. The reason where the
/// limits cannot be kept in the ranges of the servo.
std::variant<Sheet, std::string> build_closed(const CircleSetup& setup);

}  // namespace pmac::drives::silverlode
