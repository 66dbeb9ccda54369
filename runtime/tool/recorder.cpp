#include "runtime/tool/recorder.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

namespace pmac::tool {

void Recorder::take(const runtime::SampleBlock& block) {
  if (sinks_.empty()) return;
  if (held_.capacity() == 0) held_.reserve(kHeldValues + kHeldValues / 8);
  take_new_motors(block.motors);
  std::vector<std::size_t> row_of(motors_.size());
  for (std::size_t m = 0; m < motors_.size(); ++m)
    row_of[m] = static_cast<std::size_t>(std::find(block.motors.begin(), block.motors.end(), motors_[m]) - block.motors.begin());
  for (int k = 0; k < block.count; ++k) {
    held_.push_back(block.time_ms(k) / 1000.0);
    for (std::size_t row : row_of) held_.push_back(block.at(static_cast<int>(row), k));
  }
  if (!fixed_ && held_.size() >= kHeldValues) fix_columns();
  if (fixed_) emit_held();
}

/// In pieces, so that what waited for the columns is not in memory twice.
void Recorder::emit_held() {
  constexpr std::size_t kRows = 4096;
  const std::size_t width = 1 + motors_.size(), rows = held_.size() / width;
  for (std::size_t first = 0; first < rows; first += kRows) {
    const std::size_t count = std::min(kRows, rows - first);
    emit(std::span<const double>(held_).subspan(first * width, count * width), count);
  }
  held_.clear();
}

void Recorder::take_new_motors(std::span<const int> motors) {
  for (int motor : motors) {
    if (std::find(motors_.begin(), motors_.end(), motor) != motors_.end()) continue;
    if (fixed_) {
      if (std::find(late_motors_.begin(), late_motors_.end(), motor) == late_motors_.end()) late_motors_.push_back(motor);
      continue;
    }
    const auto at = std::upper_bound(motors_.begin(), motors_.end(), motor) - motors_.begin();
    const std::size_t old_width = 1 + motors_.size();
    std::vector<double> wider;
    for (std::size_t row = 0; row < held_.size(); row += old_width) {
      const auto first = held_.begin() + static_cast<std::ptrdiff_t>(row);
      wider.insert(wider.end(), first, first + 1 + at);
      wider.push_back(0.0);  // it has not moved yet
      wider.insert(wider.end(), first + 1 + at, first + static_cast<std::ptrdiff_t>(old_width));
    }
    held_ = std::move(wider);
    motors_.insert(motors_.begin() + at, motor);
  }
}

void Recorder::fix_columns() {
  fixed_ = true;
  const std::vector<int> coords = machine_.coords_in_use();
  std::vector<std::string> names{"time_s"};
  for (int motor : motors_) names.push_back(fmt::format("Motor[{}].DesPos", motor));
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

void Recorder::emit(std::span<const double> motor_rows, std::size_t count) {
  const std::size_t width = 1 + motors_.size();
  std::array<double, bytecode::kMaxMotors> motor_mu{};
  motion::AxisVector axis_uu{};
  out_.clear();
  for (std::size_t row = 0; row < count; ++row) {
    const std::span<const double> values = motor_rows.subspan(row * width, width);
    out_.insert(out_.end(), values.begin(), values.end());
    for (std::size_t m = 0; m < motors_.size(); ++m) motor_mu[static_cast<std::size_t>(motors_[m])] = values[1 + m];
    int mapped = -1;
    for (const AxisColumn& column : axes_) {
      if (column.coord != mapped) machine_.axes_from_motors(column.coord, motor_mu, axis_uu);
      mapped = column.coord;
      out_.push_back(axis_uu[static_cast<std::size_t>(column.axis)]);
    }
  }
  for (const RowSink& sink : sinks_)
    if (sink.rows) sink.rows(out_);
}

void Recorder::finish() {
  if (!fixed_) fix_columns();
  emit_held();
}

}  // namespace pmac::tool
