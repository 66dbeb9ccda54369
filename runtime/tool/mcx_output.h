// What a register script leaves behind: the table of pulses, the picture, the JSON object, the statistics.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "runtime/drives/mcx514/chip.h"
#include "runtime/gather/table_writer.h"
#include "runtime/tool/options.h"

namespace pmac::tool {

/// Axes of the table and the report: those that drives use, else X and Y.
std::vector<std::size_t> shown_axes(const drives::mcx514::Chip& chip);

/// Rows time_s, X, Y, ...: one a pulse event, as they happen; memory stays bounded.
class PulseTable {
 public:
  /// Throws OutputError.
  PulseTable(const std::string& file, std::vector<std::size_t> axes);
  void add(double time_s, const drives::mcx514::AxisCounts& position);
  void finish();

 private:
  void flush();
  std::unique_ptr<runtime::TableWriter> writer_;
  std::vector<std::size_t> axes_;
  std::vector<double> rows_;
};

/// Keeps so many points of the pulses as a picture can show, however many there are.
class PulsePicture {
 public:
  explicit PulsePicture(std::vector<std::size_t> axes) : axes_(std::move(axes)) {}
  void add(double time_s, const drives::mcx514::AxisCounts& position, double error);
  /// Path, error and positions into a .svg, .png or .html file. Throws OutputError.
  void draw(const std::string& file, const std::string& title) const;

 private:
  struct Point { double time_s, error_low, error_high; drives::mcx514::AxisCounts position; };
  void halve();
  std::vector<std::size_t> axes_;
  std::vector<Point> points_;
  Point last_{};
  std::uint64_t events_in_point_ = 0, events_a_point_ = 1;
};

/// How the run ended: "idle", "fault", "time-limit", "interrupted".
std::string pulse_json(const drives::mcx514::Chip& chip, const std::string& file, const std::string& status, JsonDetail detail);
std::string pulse_text(const drives::mcx514::Chip& chip);

}  // namespace pmac::tool
