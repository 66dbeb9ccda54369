#include "runtime/tool/recorder.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "kinematics/kinematics.h"
#include "runtime/gather/table_writer.h"

namespace pmac::tool {
namespace {

constexpr std::size_t kRowsAtOnce = 4096;

}  // namespace

void Recorder::take(const runtime::SampleBlock& block) {
  if (sinks_.empty()) return;
  take_new_motors(block.motors);
  held_.resize(motor_width());
  const std::size_t before = held_rows();
  held_[0].resize(before + static_cast<std::size_t>(block.count));
  for (int k = 0; k < block.count; ++k) held_[0][before + static_cast<std::size_t>(k)] = block.time_ms(k) / 1000.0;
  const auto count = static_cast<std::ptrdiff_t>(block.count);
  for (std::size_t m = 0; m < motors_.size(); ++m) {
    const auto first = (std::find(block.motors.begin(), block.motors.end(), motors_[m]) - block.motors.begin()) * count;
    std::vector<double>* column = &held_[1 + per_motor_ * m];
    column->insert(column->end(), block.position_mu.begin() + first, block.position_mu.begin() + first + count);
    if (per_motor_ == 2) column[1].insert(column[1].end(), block.actual_mu.begin() + first, block.actual_mu.begin() + first + count);
  }
  if (!fixed_ && held_rows() * motor_width() >= kHeldValues) fix_columns();
  if (fixed_ && (held_rows() >= kRowsAtOnce || asks_routines())) emit_held();
}

/// Forward routines see the variables of their time.
bool Recorder::asks_routines() const {
  return std::any_of(axes_.begin(), axes_.end(), [this](const AxisColumn& column) { return !machine_.linear_axes(column.coord); });
}

void Recorder::emit_held() {
  for (std::size_t first = 0; first < held_rows(); first += kRowsAtOnce) emit(first, std::min(kRowsAtOnce, held_rows() - first));
  for (std::vector<double>& column : held_) {
    column.clear();
    if (column.capacity() > 4 * kRowsAtOnce) column.shrink_to_fit();   // what waited for the columns
  }
}

void Recorder::take_new_motors(std::span<const int> motors) {
  for (int motor : motors) {
    if (std::find(motors_.begin(), motors_.end(), motor) != motors_.end()) continue;
    if (fixed_) {
      if (std::find(late_motors_.begin(), late_motors_.end(), motor) == late_motors_.end()) late_motors_.push_back(motor);
      continue;
    }
    const auto at = std::upper_bound(motors_.begin(), motors_.end(), motor) - motors_.begin();
    const std::vector<double> not_moved_yet(held_rows(), 0.0);
    held_.resize(std::max(held_.size(), motor_width()));
    held_.insert(held_.begin() + 1 + static_cast<std::ptrdiff_t>(per_motor_) * at, per_motor_, not_moved_yet);
    motors_.insert(motors_.begin() + at, motor);
  }
}

void Recorder::fix_columns() {
  fixed_ = true;
  const std::vector<int> coords = machine_.coords_in_use();
  std::vector<std::string> names{"time_s"};
  for (int motor : motors_) {
    names.push_back(fmt::format("Motor[{}].DesPos", motor));
    if (per_motor_ == 2) names.push_back(fmt::format("Motor[{}].ActPos", motor));
  }
  for (int coord : coords) {
    const std::uint32_t axes = machine_.axes_of(coord);
    for (int axis = 0; axis < bytecode::kAxisCount; ++axis) {
      if (!(axes >> axis & 1u)) continue;
      axes_.push_back({coord, axis});
      const std::string_view name = bytecode::axis_name(axis);
      names.push_back(coords.size() == 1 ? std::string(name) : fmt::format("&{}.{}", coord, name));
    }
  }
  for (const RowSink& sink : sinks_)
    if (sink.begin) sink.begin(names);
}

/// Held rows first .. first+count-1, with their axes.
void Recorder::emit(std::size_t first, std::size_t count) {
  map_axes(first, count);
  columns_.clear();
  for (const std::vector<double>& column : held_) columns_.push_back(std::span(column).subspan(first, count));
  for (const std::vector<double>& column : mapped_) columns_.push_back(std::span(column).first(count));
  const bool as_rows = std::any_of(sinks_.begin(), sinks_.end(), [](const RowSink& sink) { return static_cast<bool>(sink.rows); });
  if (as_rows) runtime::interleave(columns_, rows_);
  for (const RowSink& sink : sinks_) {
    if (sink.columns) sink.columns(columns_);
    if (sink.rows) sink.rows(rows_);
  }
}

/// Axes of one coordinate system after the other; their columns lie side by side.
void Recorder::map_axes(std::size_t first, std::size_t count) {
  mapped_.resize(axes_.size());
  for (std::vector<double>& column : mapped_) column.resize(kRowsAtOnce);
  for (std::size_t column = 0, end = 0; column < axes_.size(); column = end) {
    while (end < axes_.size() && axes_[end].coord == axes_[column].coord) ++end;
    if (const kinematics::AxisMap* map = machine_.linear_axes(axes_[column].coord)) map_linear_axes(*map, first, count, column, end);
    else map_axis_rows(first, count, column, end);
  }
}

void Recorder::map_linear_axes(const kinematics::AxisMap& map, std::size_t first, std::size_t count, std::size_t column, std::size_t end) {
  static const std::vector<double> kAtHome(kRowsAtOnce, 0.0);
  std::vector<const double*> motor_rows;
  for (const kinematics::MotorDefinition& d : map.definitions()) {
    const auto m = static_cast<std::size_t>(std::find(motors_.begin(), motors_.end(), d.motor) - motors_.begin());
    motor_rows.push_back(m < motors_.size() ? held_[1 + per_motor_ * m].data() + first : kAtHome.data());
  }
  for (std::size_t c = column; c < end; ++c)
    if (const std::span<double> row(mapped_[c].data(), count); !map.axis_row_from_motor_rows(axes_[c].axis, motor_rows, row)) std::fill(row.begin(), row.end(), 0.0);
}

/// Through the forward routine, row by row.
void Recorder::map_axis_rows(std::size_t first, std::size_t count, std::size_t column, std::size_t end) {
  std::array<double, bytecode::kMaxMotors> motor_mu{};
  motion::AxisVector axis_uu{};
  for (std::size_t row = 0; row < count; ++row) {
    for (std::size_t m = 0; m < motors_.size(); ++m) motor_mu[static_cast<std::size_t>(motors_[m])] = held_[1 + per_motor_ * m][first + row];
    machine_.axes_from_motors(axes_[column].coord, motor_mu, axis_uu);
    for (std::size_t c = column; c < end; ++c) mapped_[c][row] = axis_uu[static_cast<std::size_t>(axes_[c].axis)];
  }
}

void Recorder::finish() {
  if (!fixed_) fix_columns();
  emit_held();
}

}  // namespace pmac::tool
