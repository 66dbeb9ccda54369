#include "runtime/tool/mcx_output.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace pmac::tool {

using namespace drives::mcx514;
using nlohmann::ordered_json;

namespace {

constexpr std::size_t kRowsAtOnce = 4096;

std::string name_of(std::size_t axis) { return std::string(1, kAxisNames[axis]); }

AxisCounts all_pulses(const Chip& chip) {
  AxisCounts sum{};
  for (const DriveRecord& drive : chip.drives())
    for (std::size_t axis = 0; axis < sum.size(); ++axis) sum[axis] += drive.pulses[axis];
  return sum;
}

std::uint64_t all_events(const Chip& chip) {
  std::uint64_t sum = 0;
  for (const DriveRecord& drive : chip.drives()) sum += drive.events;
  return sum;
}

std::vector<int> all_quadrants(const Chip& chip) {
  std::vector<int> all;
  for (const DriveRecord& drive : chip.drives()) all.insert(all.end(), drive.quadrants.begin(), drive.quadrants.end());
  return all;
}

/// nullopt where some drive was not followed event by event, or none has a curve.
std::optional<ErrorRange> worst_error(const Chip& chip) {
  std::optional<ErrorRange> worst;
  for (const DriveRecord& drive : chip.drives()) {
    if (!drive.error) return std::nullopt;
    if (!worst) worst = ErrorRange{};
    *worst = {std::min(worst->low, drive.error->low), std::max(worst->high, drive.error->high)};
  }
  return worst;
}

ordered_json by_axis(const std::vector<std::size_t>& axes, const AxisCounts& counts) {
  ordered_json j = ordered_json::object();
  for (const std::size_t axis : axes) j[name_of(axis)] = counts[axis];
  return j;
}

ordered_json error_json(const std::optional<ErrorRange>& error) {
  if (!error) return nullptr;
  return {{"min", error->low}, {"max", error->high}};
}

std::vector<std::size_t> axes_of(std::uint32_t mask) {
  std::vector<std::size_t> axes;
  for (std::size_t axis = 0; axis < kAxes; ++axis)
    if ((mask >> axis & 1u) != 0) axes.push_back(axis);
  return axes;
}

ordered_json drive_json(const DriveRecord& drive) {
  const std::vector<std::size_t> axes = axes_of(drive.axes);
  const Command* command = find_command(drive.code);
  ordered_json j;
  j["line"] = drive.place.line;
  j["command"] = fmt::format("{:02X}h", drive.code);
  j["meaning"] = command == nullptr ? "" : std::string(command->meaning);
  j["start_s"] = seconds(drive.start);
  j["end_s"] = seconds(drive.end);
  j["start"] = by_axis(axes, drive.start_position);
  j["end"] = by_axis(axes, drive.end_position);
  j["events"] = drive.events;
  j["pulses"] = by_axis(axes, drive.pulses);
  j["octants"] = drive.quadrants;
  j["stop"] = stop_text(drive.stop);
  j["error_pulses"] = error_json(drive.error);
  return j;
}

}  // namespace

std::vector<std::size_t> shown_axes(const Chip& chip) {
  std::vector<std::size_t> axes = axes_of(chip.axes_used());
  return axes.empty() ? std::vector<std::size_t>{0, 1} : axes;
}

PulseTable::PulseTable(const std::string& file, std::vector<std::size_t> axes) : axes_(std::move(axes)) {
  std::vector<std::string> columns{"time_s"};
  for (const std::size_t axis : axes_) columns.push_back(name_of(axis));
  writer_ = runtime::make_table_writer(*runtime::table_format_of(file), file, columns);
  rows_.reserve(kRowsAtOnce * columns.size());
}

void PulseTable::add(double time_s, const AxisCounts& position) {
  rows_.push_back(time_s);
  for (const std::size_t axis : axes_) rows_.push_back(static_cast<double>(position[axis]));
  if (rows_.size() >= kRowsAtOnce * (1 + axes_.size())) flush();
}

void PulseTable::flush() {
  writer_->append(rows_);
  rows_.clear();
}

void PulseTable::finish() {
  flush();
  writer_->finish();
}

std::string pulse_json(const Chip& chip, const std::string& file, const std::string& status, JsonDetail detail) {
  const std::vector<std::size_t> axes = shown_axes(chip);
  ordered_json j;
  j["status"] = status;
  j["file"] = file;
  j["time_s"] = seconds(chip.now());
  j["positions"] = by_axis(axes, chip.position());
  j["pulses"] = by_axis(axes, all_pulses(chip));
  j["events"] = all_events(chip);
  j["octants"] = all_quadrants(chip);
  j["stop"] = chip.drives().empty() ? "nothing was driven" : std::string(stop_text(chip.drives().back().stop));
  j["error_pulses"] = error_json(worst_error(chip));
  if (detail == JsonDetail::kMoves) {
    j["drives"] = ordered_json::array();
    for (const DriveRecord& drive : chip.drives()) j["drives"].push_back(drive_json(drive));
    j["reads"] = ordered_json::array();
    for (const ReadRecord& read : chip.reads())
      j["reads"].push_back({{"line", read.place.line}, {"time_s", seconds(read.time)}, {"register", fmt::format("RR{}", read.reg)}, {"value", fmt::format("{:04X}h", read.value)}});
  }
  j["faults"] = ordered_json::array();
  for (const ChipEvent& event : chip.events())
    if (event.is_error) j["faults"].push_back({{"line", event.place.line}, {"time_s", seconds(event.time)}, {"text", event.text}});
  return j.dump(2) + "\n";
}

std::string pulse_text(const Chip& chip) {
  std::string text = fmt::format("time                    {:>18.9f} s\nevents                  {:>18}\n", seconds(chip.now()), all_events(chip));
  const AxisCounts pulses = all_pulses(chip);
  for (const std::size_t axis : shown_axes(chip))
    text += fmt::format("axis {}                  {:>18} pulses, position {}\n", name_of(axis), pulses[axis], chip.position()[axis]);
  if (const auto error = worst_error(chip)) text += fmt::format("error                   {:>+9.4f} {:>+8.4f} pulses from the ideal curve\n", error->low, error->high);
  for (const DriveRecord& drive : chip.drives()) {
    const Command* command = find_command(drive.code);
    text += fmt::format("line {:>5}: {:02X}h {}, {:.9f} s, {} events, ended by {}", drive.place.line, drive.code, command == nullptr ? "" : command->meaning,
                        seconds(drive.end - drive.start), drive.events, stop_text(drive.stop));
    if (!drive.quadrants.empty()) text += fmt::format(", quadrants {} to {}", drive.quadrants.front(), drive.quadrants.back());
    text += "\n";
  }
  for (const ReadRecord& read : chip.reads()) text += fmt::format("line {:>5}: RR{} = {:04X}h at {:.9f} s\n", read.place.line, read.reg, read.value, seconds(read.time));
  return text;
}

}  // namespace pmac::tool
