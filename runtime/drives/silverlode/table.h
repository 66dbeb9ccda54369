// The interpolation table: what every servo is sent for each segment, and the work sheet that it was calculated on, which is the
// application note's spreadsheet column by column.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace pmac::drives::silverlode {

/// What one servo executes in one entry, as sent.
struct AxisMove {
  std::int32_t pos = 0;      // counts; +-kFarPosition gives the direction alone
  std::int32_t acc = 0;      // SAU, 0 .. 2^30 - 1; 0 holds the velocity
  std::int32_t vel = 0;      // SVU, 0 .. 2^31 - 1
};

struct Entry {
  std::int32_t ticks = 0;    // until the next entry is loaded
  std::vector<AxisMove> axis;
};

/// Servo cycles that an entry counts: one of 0 ticks is replaced at the next cycle.
inline std::int64_t duration_ticks(std::int32_t ticks) { return ticks > 0 ? ticks : 1; }

struct Table {
  std::vector<std::string> axes;       // "X", "Y", "theta"
  std::vector<double> start_counts;    // [axis], where the servos stand at rest
  std::vector<double> end_counts;      // [axis], where they should come to rest
  std::vector<Entry> entries;          // the last one brings every axis to rest
  std::int64_t ticks() const;
};

/// Speed and acceleration of one axis that the table keeps.
struct AxisLimits {
  double max_speed_rpm = 0;
  double max_accel_rpm_s = 0;
};

/// Columns of one axis. Index 0 is the start (at rest), 1..n the segments, n+1 the terminating entry (at rest again).
struct AxisColumns {
  std::vector<double> position, delta;             // counts
  std::vector<double> time_vel;                    // s, Tvx
  std::vector<double> vel_of_time_vel;             // counts/s, Vvx
  std::vector<double> time_acc;                    // s, Tax
  std::vector<double> velocity, acceleration;      // counts/s, counts/s^2: Vx, Ax
  std::vector<double> motor_vel, motor_acc;        // SVU, SAU with their sign, whole numbers
};

/// A table on its way: the note's spreadsheet.
struct Sheet {
  std::vector<std::string> axes;
  double circumference = 0, arc = 0, time_s = 0, slice_s = 0, rounded_slice_s = 0;  // C32 to C35, M2; a circle's
  std::vector<double> angle_deg, cosine, sine;     // a circle's; empty for others
  std::vector<double> time_vel_max, time_acc_max, time_min, run_time;  // s: Tvm, Tam, Tmin, RunTime
  std::vector<double> motor_time;                  // ticks, whole numbers
  std::vector<AxisColumns> axis;

  std::size_t segments() const { return motor_time.size() - 2; }
};

/// An empty sheet for n segments.
Sheet empty_sheet(std::vector<std::string> axes, std::size_t segments);

/// The entries of a sheet in the integer ranges of the servo; what does not fit and the remedy otherwise.
std::variant<Table, std::string> table_from(const Sheet& sheet);

/// A column with the letters of the note's spreadsheet. `inferred`: the note does not print the letters; they are the gaps between
/// the columns of X and Y, which the three-axis spreadsheet leaves for theta.
struct Column {
  std::string letters, name;
  bool inferred = false;
  std::vector<double> values;      // [0 .. n+1]
};

/// Every column of the sheet, in the order of the spreadsheet, and the check columns AH to BB: what the servo makes of the entries.
std::vector<Column> columns_of(const Sheet& sheet);

}  // namespace pmac::drives::silverlode
