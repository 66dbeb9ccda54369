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

/// Takes the columns once, then rows (row-major, a multiple of the column count).
struct RowSink {
  std::function<void(const std::vector<std::string>& columns)> begin;
  std::function<void(std::span<const double> rows)> rows;
};

/// Columns: time_s, Motor[n].DesPos by motor number, then axes: X where one coordinate system has motors, &2.X where several have.
/// The columns are fixed when kHeldValues values have come in or at finish(); a motor that moves for the first time before that
/// has its column from the start.
class Recorder : public runtime::SampleSink {
 public:
  static constexpr std::size_t kHeldValues = 500'000;

  explicit Recorder(runtime::Machine& machine) : machine_(machine) {}
  void add_sink(RowSink sink) { sinks_.push_back(std::move(sink)); }

  void take(const runtime::SampleBlock& block) override;
  /// Hands over what is held. Call once at the end of the run.
  void finish();

  /// Values of a row; valid from the first begin().
  std::size_t width() const { return 1 + motors_.size() + axes_.size(); }

  /// Motors that moved for the first time when the columns were fixed already.
  const std::vector<int>& late_motors() const { return late_motors_; }

 private:
  struct AxisColumn { int coord; int axis; };
  void take_new_motors(std::span<const int> motors);
  void fix_columns();
  void emit_held();
  void emit(std::span<const double> motor_rows, std::size_t count);

  runtime::Machine& machine_;
  std::vector<RowSink> sinks_;
  std::vector<int> motors_;
  std::vector<int> late_motors_;
  std::vector<AxisColumn> axes_;
  std::vector<double> held_;        // rows of time and motors
  bool fixed_ = false;
  std::vector<double> out_;
};

}  // namespace pmac::tool
