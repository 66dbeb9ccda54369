#include "runtime/drives/silverlode/path_table.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "runtime/drives/silverlode/units.h"

namespace pmac::drives::silverlode {
namespace {

constexpr int kMostRounds = 100'000;
constexpr double kSlack = 1e-9;          // relative, for numbers that are whole but for their last bits

/// Speed and acceleration limits in counts/tick and counts/tick^2.
struct TickLimits { double speed, accel; };

/// Working arrays: [axis][segment] distances, [segment] slices, [corner] ramps; all in ticks and counts.
class Planner {
 public:
  Planner(const Sheet& sheet, const PathTable& path);

  std::optional<std::string> plan();
  /// The given ramps, and slices that they fill.
  void adopt(const std::vector<double>& ramp_ticks);

  std::vector<double> least_slice, slice, ramp;
  std::vector<TickLimits> limits;

  double velocity(std::size_t axis, std::size_t i) const { return i == 0 || i > n_ ? 0 : sheet_.axis[axis].delta[i] / slice[i]; }
  /// Time that the change of speed at the start of entry i needs at least.
  double least_ramp(std::size_t i) const;

 private:
  bool grow_forwards();
  bool grow_backwards();
  bool grow(std::size_t i, std::size_t neighbour);
  double next_feasible(std::size_t axis, std::size_t i, std::size_t neighbour) const;
  void set_ramps();
  bool make_room_for_ramps();

  const Sheet& sheet_;
  const PathTable& path_;
  std::size_t n_;
};

Planner::Planner(const Sheet& sheet, const PathTable& path) : sheet_(sheet), path_(path), n_(sheet.segments()) {
  for (const AxisLimits& limit : path.limits)
    limits.push_back({counts_s_from_rpm(limit.max_speed_rpm) * kTick_s, counts_s_from_rpm(limit.max_accel_rpm_s) * kTick_s * kTick_s});
  least_slice.assign(n_ + 2, 0.0);
  for (std::size_t i = 1; i <= n_ && path.ramp_ticks.empty(); ++i) {
    least_slice[i] = std::max({path.slice_ticks[i], path.least_slice_ticks, 1.0});
    for (std::size_t a = 0; a < limits.size(); ++a)
      least_slice[i] = std::max(least_slice[i], std::ceil(std::abs(sheet.axis[a].delta[i]) / limits[a].speed * (1 - kSlack)));
  }
  slice = least_slice;
  ramp.assign(n_ + 3, 0.0);
}

/// The smallest slice from the present one on in which the change of speed against the neighbour fits, as far as one axis is
/// concerned: |d / T - v| <= A T. Where it does not hold, T lies below the upper root of A T^2 +- v T -+ d = 0.
double Planner::next_feasible(std::size_t axis, std::size_t i, std::size_t neighbour) const {
  const double accel = limits[axis].accel, present = slice[i];
  double d = sheet_.axis[axis].delta[i], v = velocity(axis, neighbour);
  if (d / present < v) d = -d, v = -v;
  if (d / present - v <= accel * present * (1 + kSlack)) return present;
  const double root = std::sqrt(std::max(0.0, v * v + 4 * accel * d));
  const double upper = v <= 0 ? (root - v) / (2 * accel) : 2 * d / (root + v);
  return std::max(present + 1, std::ceil(upper * (1 - kSlack)));
}

bool Planner::grow(std::size_t i, std::size_t neighbour) {
  bool grown = false;
  for (bool again = true; again;) {
    again = false;
    for (std::size_t a = 0; a < limits.size(); ++a) {
      const double wanted = next_feasible(a, i, neighbour);
      if (wanted > slice[i]) slice[i] = wanted, again = grown = true;
    }
    if (slice[i] > static_cast<double>(kMostTicks)) return grown;
  }
  return grown;
}

bool Planner::grow_forwards() {
  bool grown = false;
  for (std::size_t i = 1; i <= n_; ++i) grown |= grow(i, i - 1);
  return grown;
}

bool Planner::grow_backwards() {
  bool grown = false;
  for (std::size_t i = n_; i >= 1; --i) grown |= grow(i, i + 1);
  return grown;
}

double Planner::least_ramp(std::size_t i) const {
  double ticks = 0;
  for (std::size_t a = 0; a < limits.size(); ++a)
    ticks = std::max(ticks, std::abs(velocity(a, i) - velocity(a, i - 1)) / limits[a].accel);
  return ticks;
}

void Planner::set_ramps() {
  for (std::size_t i = 1; i <= n_ + 1; ++i) ramp[i] = 2 * std::ceil(least_ramp(i) / 2 * (1 - kSlack));
}

/// Slices that the rounding to even ramps has made too short by a tick or two.
bool Planner::make_room_for_ramps() {
  bool grown = false;
  for (std::size_t i = 1; i <= n_; ++i) {
    const double needed = (ramp[i] + ramp[i + 1]) / 2;
    if (needed > slice[i]) slice[i] = needed, grown = true;
  }
  return grown;
}

void Planner::adopt(const std::vector<double>& ramp_ticks) {
  std::copy(ramp_ticks.begin(), ramp_ticks.end(), ramp.begin());
  for (std::size_t i = 1; i <= n_; ++i) slice[i] = least_slice[i] = (ramp[i] + ramp[i + 1]) / 2;
}

std::optional<std::string> Planner::plan() {
  for (int round = 0; round < kMostRounds; ++round) {
    const bool forwards = grow_forwards(), backwards = grow_backwards();
    if (*std::max_element(slice.begin(), slice.end()) > static_cast<double>(kMostTicks))
      return "a segment would take more ticks than a queue entry can count; raise the limits or the number of segments";
    if (forwards || backwards) continue;
    set_ramps();
    if (!make_room_for_ramps()) return std::nullopt;
  }
  return fmt::format("the times of the segments do not settle in {} rounds; change the limits or the number of segments", kMostRounds);
}

void fill_times(Sheet& sheet, const Planner& plan) {
  const std::size_t n = sheet.segments();
  for (std::size_t i = 1; i <= n + 1; ++i) {
    const double run_ticks = i <= n ? plan.slice[i] - plan.ramp[i + 1] / 2 + plan.ramp[i] / 2 : plan.ramp[i];
    sheet.time_vel_max[i] = plan.least_slice[i] * kTick_s;
    sheet.time_acc_max[i] = plan.ramp[i] * kTick_s;
    sheet.time_min[i] = plan.slice[i] * kTick_s;
    sheet.run_time[i] = run_ticks * kTick_s;
    sheet.motor_time[i] = i <= n ? run_ticks : run_ticks + 1;
  }
}

void fill_motion(Sheet& sheet, const Planner& plan) {
  const std::size_t n = sheet.segments();
  for (std::size_t a = 0; a < sheet.axis.size(); ++a) {
    AxisColumns& axis = sheet.axis[a];
    for (std::size_t i = 1; i <= n + 1; ++i) {
      axis.velocity[i] = plan.velocity(a, i) / kTick_s;
      const double change = axis.velocity[i] - axis.velocity[i - 1];
      axis.acceleration[i] = plan.ramp[i] > 0 ? change / sheet.time_acc_max[i] : 0;
      axis.time_acc[i] = std::abs(change) * kTick_s * kTick_s / plan.limits[a].accel;
      if (i > n) continue;
      axis.time_vel[i] = std::abs(axis.delta[i]) / plan.limits[a].speed * kTick_s;
      axis.vel_of_time_vel[i] = axis.delta[i] / sheet.time_vel_max[i];
    }
  }
}

/// The rate that covers a change of speed in a ramp, never below it: a rate that is too low would not reach the speed.
double whole_rate(double change_svu, double ramp_ticks, double exact_sau) {
  if (change_svu == 0 && ramp_ticks == 0) return 0;
  const double rate = std::max(std::ceil(std::abs(exact_sau)), std::ceil(std::abs(change_svu) / ramp_ticks));
  return std::copysign(rate, change_svu != 0 ? change_svu : exact_sau);
}

void round_units(Sheet& sheet, const Planner& plan) {
  for (AxisColumns& axis : sheet.axis)
    for (std::size_t i = 1; i < axis.velocity.size(); ++i) {
      axis.motor_vel[i] = std::round(svu_from_counts_s(axis.velocity[i]));
      const double change = axis.motor_vel[i] - axis.motor_vel[i - 1];
      axis.motor_acc[i] = whole_rate(change, plan.ramp[i], sau_from_counts_s2(axis.acceleration[i]));
    }
}

/// Distance that the servo covers in an entry, 2^-26 counts: v first, then the position, every tick.
double covered_units(double from_svu, double to_svu, double rate, double ticks) {
  if (rate == 0) return from_svu * ticks;
  const double full = std::min(ticks, std::floor(std::abs(to_svu - from_svu) / rate));
  const double signed_rate = std::copysign(rate, to_svu - from_svu);
  return from_svu * full + signed_rate * full * (full + 1) / 2 + (ticks - full) * to_svu;
}

/// As round_units, with the speed of each entry corrected by what is missing to its corner.
void round_units_making_up(Sheet& sheet, const Planner& plan) {
  const std::size_t n = sheet.segments();
  for (AxisColumns& axis : sheet.axis) {
    double position = std::round(axis.position[0] * kUnitsPerCount);
    for (std::size_t i = 1; i <= n; ++i) {
      const double before = axis.motor_vel[i - 1];
      const double corner = axis.position[i] * kUnitsPerCount;
      const double ramp = plan.ramp[i], ticks = sheet.motor_time[i];
      // position + before * ramp + (v - before) * (ramp + 1) / 2 + v * (ticks - ramp) + v * (next_ramp - 1) / 2 = corner
      const double wanted = (corner - position - before * (ramp - 1) / 2) / plan.slice[i];
      axis.motor_vel[i] = std::abs(axis.delta[i]) > 0 || before != 0 ? std::round(wanted) : 0;
      const double change = axis.motor_vel[i] - before;
      axis.motor_acc[i] = ramp > 0 ? std::copysign(std::ceil(std::abs(change) / ramp), change) : change;
      position += covered_units(before, axis.motor_vel[i], std::abs(axis.motor_acc[i]), ticks);
    }
    const double change = -axis.motor_vel[n];
    axis.motor_acc[n + 1] = plan.ramp[n + 1] > 0 ? std::copysign(std::ceil(std::abs(change) / plan.ramp[n + 1]), change) : change;
  }
}

}  // namespace

std::optional<std::string> fill_closed(Sheet& sheet, const PathTable& path) {
  Planner planner(sheet, path);
  if (!path.ramp_ticks.empty()) planner.adopt(path.ramp_ticks);
  else if (auto why = planner.plan()) return why;
  fill_times(sheet, planner);
  fill_motion(sheet, planner);
  if (path.makes_up) round_units_making_up(sheet, planner);
  else round_units(sheet, planner);
  return std::nullopt;
}

}  // namespace pmac::drives::silverlode
