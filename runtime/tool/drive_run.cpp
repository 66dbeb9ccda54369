#include "runtime/tool/drive_run.h"

#include <algorithm>

#include <fmt/format.h>

#include "runtime/gather/error_plot.h"
#include "runtime/gather/table_writer.h"
#include "runtime/motion/path.h"

namespace pmac::tool {
namespace {

constexpr std::size_t kShownEvents = 100;

drives::DriveContext context_of(runtime::Machine& machine) {
  drives::DriveContext context;
  context.motors_from_axes = [&machine](int coord, const motion::AxisVector& axis_uu, std::span<double> motor_mu) -> std::optional<std::string> {
    const auto fault = machine.motors_from_axes(coord, axis_uu, motor_mu);
    return fault ? std::optional(fault->detail) : std::nullopt;
  };
  context.place = [&machine](bytecode::SourceLine source) { return machine.place(source); };
  return context;
}

/// Columns time_s, for every axis its position and where it was to be, and the distance from the path, in counts.
void write_record(const drives::Execution& execution, const std::string& file) {
  std::vector<std::string> columns{"time_s"};
  for (const std::string& axis : execution.axes) columns.push_back(axis + ".counts");
  for (const std::string& axis : execution.axes) columns.push_back(axis + ".commanded");
  columns.push_back("error_counts");
  const auto writer = runtime::make_table_writer(*runtime::table_format_of(file), file, columns);
  std::vector<double> row;
  for (std::size_t i = 0; i < execution.times_s.size(); ++i) {
    row.assign(1, execution.times_s[i]);
    for (const auto& axis : execution.position_counts) row.push_back(axis[i]);
    for (const auto& axis : execution.commanded_counts) row.push_back(axis[i]);
    row.push_back(execution.error_counts[i]);
    writer->append(row);
  }
  writer->finish();
}

/// Path and error of the first two axes; of one axis the error alone.
void draw_pictures(const drives::Execution& execution, const RunOptions& options) {
  if (options.plots.empty()) return;
  if (execution.times_s.size() < 2 || execution.error_counts.size() != execution.times_s.size()) {
    std::fprintf(stderr, "pmac-run: the simulated drive did not move, there is no picture\n");
    return;
  }
  runtime::ErrorPlotData data;
  data.title = "simulated drive: " + options.drive;
  data.error_name = "distance from the path";
  data.time_s = execution.times_s;
  data.error = execution.error_counts;
  if (execution.axes.size() >= 2) {
    data.x_name = execution.axes[0], data.y_name = execution.axes[1];
    data.x = execution.position_counts[0], data.y = execution.position_counts[1];
    data.commanded_x = execution.commanded_counts[0], data.commanded_y = execution.commanded_counts[1];
  }
  for (const std::string& file : options.plots) runtime::draw(data, *runtime::plot_format_of(file), file);
}

}  // namespace

int DriveRun::set_up(runtime::Machine& machine) {
  if (options_.drive.empty()) return kExitOk;
  auto made = drives::make_drive(options_.drive, options_.drive_settings, context_of(machine));
  if (const std::string* why = std::get_if<std::string>(&made)) {
    std::fprintf(stderr, "pmac-run: --drive: %s\n", why->c_str());
    return kExitUsage;
  }
  drive_ = std::move(std::get<std::unique_ptr<drives::Drive>>(made));
  return kExitOk;
}

motion::StageObservers DriveRun::observed(int coord, motion::StageObservers stages) {
  if (!drive_) return stages;
  stages.path = [this, coord, printed = std::move(stages.path)](const motion::PathPiece& piece) {
    if (printed) printed(piece);
    drive_->take(coord, piece);
  };
  return stages;
}

void DriveRun::print_frames() const {
  drive_->frames([](const drives::Frame& frame) { std::printf("%s\n", fmt::format("{:.6f} {}", frame.time_s, frame.text).c_str()); });
}

void DriveRun::report_events() const {
  const auto& events = execution_->events;
  for (std::size_t i = 0; i < std::min(events.size(), kShownEvents); ++i)
    std::fprintf(stderr, "%s: %s at %.6f s: %s\n", options_.drive.c_str(), events[i].is_error ? "error" : "note", events[i].time_s, events[i].text.c_str());
  if (events.size() > kShownEvents) std::fprintf(stderr, "%s: and %zu more; --json tells all of them\n", options_.drive.c_str(), events.size() - kShownEvents);
}

int DriveRun::finish() {
  if (!drive_) return kExitOk;
  if (const auto why = drive_->encode()) {
    refusal_ = *why;
    std::fprintf(stderr, "pmac-run: --drive %s: %s\n", options_.drive.c_str(), why->c_str());
    return kExitFault;
  }
  if (options_.emit == "frames") print_frames();
  execution_ = drive_->execute();
  report_events();
  try {
    if (!options_.drive_record.empty()) write_record(*execution_, options_.drive_record);
    draw_pictures(*execution_, options_);
  } catch (const runtime::OutputError& e) {
    std::fprintf(stderr, "pmac-run: %s\n", e.what());
    return kExitUsage;
  }
  const bool failed = std::any_of(execution_->events.begin(), execution_->events.end(), [](const auto& event) { return event.is_error; });
  return failed ? kExitFault : kExitOk;
}

std::string drive_text(const DriveRun& run) {
  if (!run.execution()) return {};
  std::string text = fmt::format("simulated drive: {:.6f} s\n", run.execution()->time_s);
  for (const drives::Figure& figure : run.execution()->figures) text += fmt::format("{:<32} {:>15.6g}\n", figure.name, figure.value);
  return text;
}

}  // namespace pmac::tool
