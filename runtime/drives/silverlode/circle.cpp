#include "runtime/drives/silverlode/circle.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "runtime/drives/silverlode/path_table.h"
#include "runtime/drives/silverlode/units.h"

namespace pmac::drives::silverlode {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kLongSlice_ticks = 100'000;     // from here on half a velocity unit is more than a thousandth of a count

std::vector<std::string> axis_names(const CircleSetup& setup) {
  return setup.knife_counts_deg ? std::vector<std::string>{"X", "Y", "theta"} : std::vector<std::string>{"X", "Y"};
}

double radians(double degrees) { return 2 * kPi * degrees / 360; }

/// Circumference, arc, time and slice: cells C32 to C35.
void fill_cells(Sheet& sheet, const CircleSetup& setup) {
  sheet.circumference = std::abs(2 * setup.radius * kPi);
  sheet.arc = sheet.circumference * std::abs(setup.distance_angle_deg / 360);
  sheet.time_s = sheet.arc / setup.velocity;
  sheet.slice_s = sheet.time_s / static_cast<double>(setup.segments);
}

/// Direction of the path, which the knife follows: a quarter turn ahead of the radius.
double knife_angle_deg(const CircleSetup& setup, double angle_deg) { return angle_deg + (setup.distance_angle_deg > 0 ? 90 : -90); }

void fill_points(Sheet& sheet, const CircleSetup& setup) {
  const Center center = center_of(setup);
  const double n = static_cast<double>(setup.segments);
  for (std::size_t i = 0; i <= sheet.segments(); ++i) {
    const double angle_deg = setup.start_angle_deg + setup.distance_angle_deg * static_cast<double>(i) / n;
    const double cosine = std::cos(radians(angle_deg)), sine = std::sin(radians(angle_deg));
    sheet.angle_deg.push_back(angle_deg);
    sheet.cosine.push_back(cosine);
    sheet.sine.push_back(sine);
    sheet.axis[0].position[i] = (cosine * setup.radius + center.x) * setup.scale_x;
    sheet.axis[1].position[i] = (sine * setup.radius + center.y) * setup.scale_y;
    if (setup.knife_counts_deg) sheet.axis[2].position[i] = knife_angle_deg(setup, angle_deg) * *setup.knife_counts_deg;
  }
  for (auto* column : {&sheet.angle_deg, &sheet.cosine, &sheet.sine}) column->push_back(column->back());
}

/// The terminating entry stands where the last segment ends. dx of 0 and n+1 stay 0.
void fill_deltas(Sheet& sheet) {
  const std::size_t n = sheet.segments();
  for (AxisColumns& axis : sheet.axis) {
    for (std::size_t i = 1; i <= n; ++i) axis.delta[i] = axis.position[i] - axis.position[i - 1];
    axis.position[n + 1] = axis.position[n];
  }
}

Sheet begin_sheet(const CircleSetup& setup) {
  Sheet sheet = empty_sheet(axis_names(setup), static_cast<std::size_t>(setup.segments));
  fill_cells(sheet, setup);
  fill_points(sheet, setup);
  fill_deltas(sheet);
  return sheet;
}

/// Tvx and Tvm (H, I, K), and the velocities for that time (L, M).
void literal_times_of_velocity(Sheet& sheet, const CircleSetup& setup, std::size_t i) {
  double most = std::max(sheet.rounded_slice_s, setup.min_slice_s);
  for (std::size_t a = 0; a < sheet.axis.size(); ++a) {
    AxisColumns& axis = sheet.axis[a];
    axis.time_vel[i] = std::abs(axis.delta[i] / counts_s_from_rpm(setup.limits[a].max_speed_rpm));
    most = std::max(most, axis.time_vel[i]);
  }
  sheet.time_vel_max[i] = most;
  for (AxisColumns& axis : sheet.axis) axis.vel_of_time_vel[i] = axis.delta[i] / most;
}

/// Tax and Tam (O, P, R): the time to reach the velocity from rest. The terminating entry has the ramp of the last segment.
void literal_times_of_acceleration(Sheet& sheet, const CircleSetup& setup, std::size_t i) {
  const std::size_t from = std::min(i, sheet.segments());
  for (std::size_t a = 0; a < sheet.axis.size(); ++a) {
    AxisColumns& axis = sheet.axis[a];
    axis.time_acc[i] = std::abs(axis.vel_of_time_vel[from] / counts_s_from_rpm(setup.limits[a].max_accel_rpm_s));
    sheet.time_acc_max[i] = std::max(sheet.time_acc_max[i], axis.time_acc[i]);
  }
}

/// Tmin and RunTime (S, T), then velocity and acceleration (U to X).
void literal_motion(Sheet& sheet, std::size_t i) {
  const double ramp = sheet.time_acc_max[i];
  if (i <= sheet.segments()) {
    const double next_ramp = sheet.time_acc_max[i + 1];
    sheet.time_min[i] = std::max({sheet.time_vel_max[i], ramp, next_ramp / 2 + ramp / 2});
    sheet.run_time[i] = sheet.time_min[i] - next_ramp / 2 + ramp / 2;
  } else {
    sheet.run_time[i] = ramp;
  }
  for (AxisColumns& axis : sheet.axis) {
    axis.velocity[i] = i <= sheet.segments() ? axis.delta[i] / sheet.time_min[i] : 0;
    axis.acceleration[i] = (axis.vel_of_time_vel[i] - axis.vel_of_time_vel[i - 1]) / ramp;
  }
}

/// The casts to long of the note's program (AA to AE).
void literal_units(Sheet& sheet, std::size_t i) {
  const bool terminates = i > sheet.segments();
  sheet.motor_time[i] = terminates ? std::ceil(sheet.run_time[i] / kTick_s) + 1 : std::trunc(sheet.run_time[i] / kTick_s);
  for (AxisColumns& axis : sheet.axis) {
    axis.motor_vel[i] = std::trunc(svu_from_counts_s(axis.velocity[i]));
    axis.motor_acc[i] = std::trunc(sau_from_counts_s2(axis.acceleration[i]));
  }
}

std::optional<std::string> problem_of_limits(const CircleSetup& setup) {
  if (setup.limits.size() != setup.axis_count()) return fmt::format("{} axes need as many limits of speed and acceleration", setup.axis_count());
  for (std::size_t a = 0; a < setup.limits.size(); ++a) {
    const std::string axis = axis_names(setup)[a];
    if (!(setup.limits[a].max_speed_rpm > 0 && std::isfinite(setup.limits[a].max_speed_rpm))) return "the greatest speed of " + axis + " must be above 0 rpm";
    if (!(setup.limits[a].max_accel_rpm_s > 0 && std::isfinite(setup.limits[a].max_accel_rpm_s))) return "the greatest acceleration of " + axis + " must be above 0 rpm/s";
  }
  return std::nullopt;
}

/// Positions beyond the one that stands for "never reached" cannot be told from it.
std::optional<std::string> problem_of_range(const CircleSetup& setup) {
  const Center center = center_of(setup);
  const double most = static_cast<double>(kFarPosition);
  const double x = (std::abs(center.x) + setup.radius) * std::abs(setup.scale_x), y = (std::abs(center.y) + setup.radius) * std::abs(setup.scale_y);
  const double theta = (std::abs(setup.start_angle_deg) + std::abs(setup.distance_angle_deg) + 90) * std::abs(setup.knife_counts_deg.value_or(0));
  if (std::max({x, y, theta}) < most) return std::nullopt;
  return fmt::format("the arc leaves the range of the servos, {:.0f} counts either side of 0; lower radius, offset or scale", most);
}

}  // namespace

Center center_of(const CircleSetup& setup) {
  return {setup.offset_x - setup.radius * std::cos(radians(setup.start_angle_deg)), setup.offset_y - setup.radius * std::sin(radians(setup.start_angle_deg))};
}

std::optional<std::string> problem_of(const CircleSetup& setup) {
  if (setup.segments < 1 || setup.segments > kMostSegments) return fmt::format("the number of segments must be 1 to {}", kMostSegments);
  for (const double value : {setup.radius, setup.start_angle_deg, setup.offset_x, setup.offset_y, setup.distance_angle_deg, setup.velocity, setup.scale_x, setup.scale_y,
                             setup.min_slice_s, setup.knife_counts_deg.value_or(0)})
    if (!std::isfinite(value)) return "every number must be finite";
  if (!(setup.radius > 0)) return "the radius must be above 0";
  if (!(setup.velocity > 0)) return "the tangential velocity must be above 0";
  if (setup.distance_angle_deg == 0) return "the distance angle must not be 0";
  if (setup.scale_x == 0 || setup.scale_y == 0) return "a scale of 0 moves nothing; give counts per user unit";
  if (setup.knife_counts_deg == 0.0) return "a knife with 0 counts per degree does not turn";
  if (setup.min_slice_s < 0) return "the minimum slice must not be negative";
  const double step_deg = std::abs(setup.distance_angle_deg) / static_cast<double>(setup.segments);
  if (std::fmod(step_deg, 360) == 0) return "every segment ends where it starts; give more segments";
  if (auto why = problem_of_limits(setup)) return why;
  return problem_of_range(setup);
}

Sheet build_literal(const CircleSetup& setup) {
  Sheet sheet = begin_sheet(setup);
  const double rounded_ticks = std::trunc(sheet.slice_s * kNoteTicksPerSecond);
  sheet.rounded_slice_s = rounded_ticks * kTick_s;
  const std::size_t n = sheet.segments();
  for (std::size_t i = 1; i <= n; ++i) literal_times_of_velocity(sheet, setup, i);
  for (std::size_t i = 1; i <= n + 1; ++i) literal_times_of_acceleration(sheet, setup, i);
  for (std::size_t i = 1; i <= n + 1; ++i) literal_motion(sheet, i);
  for (std::size_t i = 1; i <= n + 1; ++i) literal_units(sheet, i);
  return sheet;
}

std::variant<Sheet, std::string> build_closed(const CircleSetup& setup) {
  Sheet sheet = begin_sheet(setup);
  PathTable path;
  path.slice_ticks.assign(sheet.segments() + 1, std::max(1.0, std::round(sheet.slice_s / kTick_s)));
  path.least_slice_ticks = std::ceil(setup.min_slice_s / kTick_s - 1e-9);
  path.limits = setup.limits;
  path.makes_up = std::max(path.slice_ticks.back(), path.least_slice_ticks) > kLongSlice_ticks;
  sheet.rounded_slice_s = path.slice_ticks.back() * kTick_s;
  if (auto why = fill_closed(sheet, path)) return *why;
  return sheet;
}

}  // namespace pmac::drives::silverlode
