#include "runtime/drives/silverlode/table.h"

#include <cmath>

#include <fmt/format.h>

#include "runtime/drives/silverlode/units.h"

namespace pmac::drives::silverlode {
namespace {

std::string out_of_range(const std::string& what, std::size_t entry, double value, double most, const std::string& remedy) {
  return fmt::format("entry {}: {} {:.0f} is beyond {:.0f}; {}", entry, what, value, most, remedy);
}

/// 2^31 itself stands for 4000 rpm and is sent as 2^31 - 1.
double clamped_velocity(double svu) { return svu == static_cast<double>(kMostVelocity) + 1 ? static_cast<double>(kMostVelocity) : svu; }

std::variant<AxisMove, std::string> move_from(const Sheet& sheet, std::size_t axis, std::size_t entry) {
  const AxisColumns& columns = sheet.axis[axis];
  const double vel = clamped_velocity(std::abs(columns.motor_vel[entry])), acc = std::abs(columns.motor_acc[entry]);
  const std::string of = " of " + sheet.axes[axis];
  if (!(vel <= static_cast<double>(kMostVelocity)))
    return out_of_range("velocity" + of + " in SVU", entry, vel, static_cast<double>(kMostVelocity), "a servo reaches 4000 rpm, lower the speed");
  if (!(acc <= static_cast<double>(kMostAcceleration)))
    return out_of_range("acceleration" + of + " in SAU", entry, acc, static_cast<double>(kMostAcceleration), "lower the acceleration limit");
  const bool backwards = columns.motor_vel[entry] < 0;
  return AxisMove{static_cast<std::int32_t>(backwards ? -kFarPosition : kFarPosition), static_cast<std::int32_t>(acc), static_cast<std::int32_t>(vel)};
}

}  // namespace

std::int64_t Table::ticks() const {
  std::int64_t sum = 0;
  for (const Entry& entry : entries) sum += duration_ticks(entry.ticks);
  return sum;
}

Sheet empty_sheet(std::vector<std::string> axes, std::size_t segments) {
  Sheet sheet;
  sheet.axes = std::move(axes);
  const std::vector<double> zeros(segments + 2, 0.0);
  sheet.time_vel_max = sheet.time_acc_max = sheet.time_min = sheet.run_time = sheet.motor_time = zeros;
  sheet.axis.assign(sheet.axes.size(), {zeros, zeros, zeros, zeros, zeros, zeros, zeros, zeros, zeros});
  return sheet;
}

std::variant<Table, std::string> table_from(const Sheet& sheet) {
  const std::size_t last = sheet.segments() + 1;
  Table table;
  table.axes = sheet.axes;
  for (const AxisColumns& columns : sheet.axis) {
    table.start_counts.push_back(columns.position.front());
    table.end_counts.push_back(columns.position[last - 1]);
  }
  for (std::size_t i = 1; i <= last; ++i) {
    const double ticks = sheet.motor_time[i];
    if (!(ticks >= 0 && ticks <= static_cast<double>(kMostTicks)))
      return out_of_range("time in ticks", i, ticks, static_cast<double>(kMostTicks), "raise the speed or the number of segments");
    Entry entry{static_cast<std::int32_t>(ticks), {}};
    for (std::size_t a = 0; a < sheet.axes.size(); ++a) {
      const auto move = move_from(sheet, a, i);
      if (const auto* why = std::get_if<std::string>(&move)) return *why;
      entry.axis.push_back(std::get<AxisMove>(move));
    }
    table.entries.push_back(std::move(entry));
  }
  return table;
}

}  // namespace pmac::drives::silverlode
