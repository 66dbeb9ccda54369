// The columns of a sheet under the letters of the note's spreadsheet, and its check columns.
#include <array>
#include <cmath>

#include "runtime/drives/silverlode/table.h"
#include "runtime/drives/silverlode/units.h"

namespace pmac::drives::silverlode {
namespace {

/// Letters of X, Y and theta.
using Letters = std::array<const char*, 3>;

class ColumnList {
 public:
  explicit ColumnList(const Sheet& sheet) : sheet_(sheet) {}

  /// The same number in every row.
  void add_cell(const char* letters, const char* name, double value) { columns_.push_back({letters, name, false, std::vector<double>(sheet_.motor_time.size(), value)}); }
  void add(const char* letters, const char* name, const std::vector<double>& values) {
    if (!values.empty()) columns_.push_back({letters, name, false, values});
  }
  void add_axis(const Letters& letters, const std::string& name, std::size_t a, const std::vector<double>& values, bool theta_inferred = true) {
    if (a < letters.size()) columns_.push_back({letters[a], name + "_" + sheet_.axes[a], theta_inferred && a == 2, values});
  }
  /// One column an axis.
  void add_axes(const Letters& letters, const char* name, std::vector<double> AxisColumns::* values) {
    for (std::size_t a = 0; a < sheet_.axis.size(); ++a) add_axis(letters, name, a, sheet_.axis[a].*values);
  }

  std::vector<Column> take() { return std::move(columns_); }

 private:
  const Sheet& sheet_;
  std::vector<Column> columns_;
};

/// What the servo makes of the entries: the columns AH to BB, both terms of the ramp's distance scaled.
struct Checks {
  std::vector<double> accel_time, slew_time, distance_accel, distance_slew, covered, total_time, final_position;
};

Checks checks_of(const Sheet& sheet, const AxisColumns& axis) {
  const std::vector<double> zeros(sheet.motor_time.size(), 0.0);
  Checks c{zeros, zeros, zeros, zeros, zeros, zeros, zeros};
  c.final_position[0] = axis.position[0];
  for (std::size_t i = 1; i < sheet.motor_time.size(); ++i) {
    const double v0 = axis.motor_vel[i - 1], v1 = axis.motor_vel[i], a = axis.motor_acc[i], delay = sheet.motor_time[i];
    const double t = c.accel_time[i] = a == 0 ? 0 : (v1 - v0) / a;
    c.slew_time[i] = delay - t;
    c.distance_accel[i] = (v0 * t + a * t * (t + 1) / 2) / kUnitsPerCount;
    c.distance_slew[i] = c.slew_time[i] * v1 / kUnitsPerCount;
    c.covered[i] = c.distance_accel[i] + c.distance_slew[i];
    c.total_time[i] = c.total_time[i - 1] + delay;
    c.final_position[i] = c.final_position[i - 1] + c.covered[i];
  }
  return c;
}

void add_checks(ColumnList& list, const Sheet& sheet) {
  for (std::size_t a = 0; a < sheet.axis.size(); ++a) {
    const Checks c = checks_of(sheet, sheet.axis[a]);
    list.add_axis({"AH", "AO", "AV"}, "accel_time", a, c.accel_time, false);
    list.add_axis({"AI", "AP", "AW"}, "slew_time", a, c.slew_time, false);
    list.add_axis({"AJ", "AQ", "AX"}, "covered_dist_acc", a, c.distance_accel, false);
    list.add_axis({"AK", "AR", "AY"}, "covered_dist_slew", a, c.distance_slew, false);
    list.add_axis({"AL", "AS", "AZ"}, "total_covered_distance", a, c.covered, false);
    list.add_axis({"AM", "AT", "BA"}, "total_time", a, c.total_time, false);
    list.add_axis({"AN", "AU", "BB"}, "final_position", a, c.final_position, false);
  }
}

void add_motion(ColumnList& list, const Sheet& sheet) {
  for (std::size_t a = 0; a < sheet.axis.size(); ++a) {
    list.add_axis({"U", "W", "Y"}, "V", a, sheet.axis[a].velocity);
    list.add_axis({"V", "X", "Z"}, "A", a, sheet.axis[a].acceleration);
  }
  list.add("AA", "motorTime", sheet.motor_time);
  for (std::size_t a = 0; a < sheet.axis.size(); ++a) {
    list.add_axis({"AB", "AD", "AF"}, "motorVel", a, sheet.axis[a].motor_vel);
    list.add_axis({"AC", "AE", "AG"}, "motorAcc", a, sheet.axis[a].motor_acc);
  }
}

}  // namespace

std::vector<Column> columns_of(const Sheet& sheet) {
  ColumnList list(sheet);
  if (!sheet.angle_deg.empty()) {
    list.add_cell("C32", "circumference", sheet.circumference);
    list.add_cell("C33", "arc", sheet.arc);
    list.add_cell("C34", "time", sheet.time_s);
    list.add_cell("C35", "TimeSlice", sheet.slice_s);
    list.add_cell("M2", "Ts", sheet.rounded_slice_s);
    list.add("", "a", sheet.angle_deg);
    list.add("E38", "cosa", sheet.cosine);
    list.add("F38", "sina", sheet.sine);
  }
  list.add_axes({"B", "C", "D"}, "position", &AxisColumns::position);
  list.add_axes({"E", "F", "G"}, "d", &AxisColumns::delta);
  list.add_axes({"H", "I", "J"}, "Tv", &AxisColumns::time_vel);
  list.add("K", "Tvm", sheet.time_vel_max);
  list.add_axes({"L", "M", "N"}, "Vv", &AxisColumns::vel_of_time_vel);
  list.add_axes({"O", "P", "Q"}, "Ta", &AxisColumns::time_acc);
  list.add("R", "Tam", sheet.time_acc_max);
  list.add("S", "Tmin", sheet.time_min);
  list.add("T", "RunTime", sheet.run_time);
  add_motion(list, sheet);
  add_checks(list, sheet);
  return list.take();
}

}  // namespace pmac::drives::silverlode
