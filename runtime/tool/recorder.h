// Servo samples as table rows: time, motor positions, and the axis positions that the forward map makes of them. The same rows feed
// --record, --plot and --emit=servo.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "runtime/machine.h"
#include "runtime/servo/servo.h"

namespace pmac::tool {

/// Takes the columns once, then rows (row-major, a multiple of the column count), or values column by column. Any may be empty.
struct RowSink {
  std::function<void(const std::vector<std::string>& columns)> begin;
  std::function<void(std::span<const double> rows)> rows;
  std::function<void(std::span<const std::span<const double>> columns)> columns = {};
};

/// Columns: time_s, Motor[n].DesPos (and Motor[n].ActPos on request) by motor number, then axes: X where one coordinate system has motors, &2.X where several have.
/// The columns are fixed when kHeldValues values have come in or at finish(); a motor that moves for the first time before that
/// has its column from the start.
class Recorder : public runtime::SampleSink {
 public:
  static constexpr std::size_t kHeldValues = 500'000;

  /// with_actual: Motor[n].ActPos behind every Motor[n].DesPos.
  explicit Recorder(runtime::Machine& machine, bool with_actual = false) : machine_(machine), per_motor_(with_actual ? 2 : 1) {}
  void add_sink(RowSink sink) { sinks_.push_back(std::move(sink)); }

  bool has_sinks() const { return !sinks_.empty(); }

  void take(const runtime::SampleBlock& block) override;
  /// Hands over what is held. Call once at the end of the run.
  void finish();

  /// Values of a row; valid from the first begin().
  std::size_t width() const { return motor_width() + axes_.size(); }

  /// Motors that moved for the first time when the columns were fixed already.
  const std::vector<int>& late_motors() const { return late_motors_; }

 private:
  struct AxisColumn { int coord; int axis; };
  std::size_t motor_width() const { return 1 + per_motor_ * motors_.size(); }
  std::size_t held_rows() const { return held_.empty() ? 0 : held_[0].size(); }
  bool asks_routines() const;
  void take_new_motors(std::span<const int> motors);
  void fix_columns();
  void emit_held();
  void emit(std::size_t first, std::size_t count);
  void map_axes(std::size_t first, std::size_t count);
  void map_linear_axes(const kinematics::AxisMap& map, std::size_t first, std::size_t count, std::size_t column, std::size_t end);
  void map_axis_rows(std::size_t first, std::size_t count, std::size_t column, std::size_t end);

  runtime::Machine& machine_;
  const std::size_t per_motor_;     // columns
  std::vector<RowSink> sinks_;
  std::vector<int> motors_;
  std::vector<int> late_motors_;
  std::vector<AxisColumn> axes_;
  std::vector<std::vector<double>> held_;   // [column of time and motors][row]
  bool fixed_ = false;
  std::vector<std::vector<double>> mapped_; // [axis column][row] of what is being handed over
  std::vector<std::span<const double>> columns_;
  std::vector<double> rows_;
};

}  // namespace pmac::tool
