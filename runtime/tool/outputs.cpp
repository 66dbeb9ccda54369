#include "runtime/tool/outputs.h"

#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>

#include "runtime/gather/plot.h"

namespace pmac::tool {

std::string unknown_ending(const RunOptions& options) {
  for (const std::string& file : {options.record, options.gather, options.drive_record})
    if (!file.empty() && !runtime::table_format_of(file)) return file;
  for (const std::string& file : options.plots)
    if (!runtime::plot_format_of(file)) return file;
  return {};
}

std::string clashing_file(const RunOptions& options) {
  std::vector<std::string> outputs{options.record, options.gather, options.drive_record};
  if (options.trace != "-") outputs.push_back(options.trace);
  outputs.insert(outputs.end(), options.plots.begin(), options.plots.end());
  const auto same = [](const std::string& a, const std::string& b) {
    std::error_code ignored;
    return a == b || std::filesystem::equivalent(a, b, ignored);
  };
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    if (outputs[i].empty()) continue;
    for (const std::string& input : options.files)
      if (same(outputs[i], input)) return outputs[i];
    for (std::size_t k = i + 1; k < outputs.size(); ++k)
      if (same(outputs[i], outputs[k])) return outputs[i];
  }
  return {};
}

namespace {

/// Most samples that the run can have, one a servo cycle up to the first at or after its end; 0 where nobody knows, or for more than a file
/// should be laid out for beforehand.
std::uint64_t known_samples(const RunOptions& options, double period_ms) {
  constexpr double kMost = 1e9;
  if (!options.until_s || options.console) return 0;
  const double stop_ms = std::min(*options.until_s, options.max_time_s) * 1000.0;
  if (!(stop_ms >= 0 && stop_ms / period_ms < kMost)) return 0;
  auto tick = static_cast<std::uint64_t>(stop_ms / period_ms);
  while (tick > 0 && static_cast<double>(tick - 1) * period_ms >= stop_ms) --tick;
  while (static_cast<double>(tick) * period_ms < stop_ms) ++tick;
  return tick + 1;
}

}  // namespace

Outputs::Outputs(const RunOptions& options, runtime::Machine& machine, Recorder& recorder) : options_(options) {
  if (!options.record.empty()) record(machine, recorder);
  if (!options.gather.empty()) gather(machine);
  if (!options.plots.empty() && options.drive.empty()) keep_for_plots(recorder);  // with --drive its own picture
}

void Outputs::fail(const std::string& message) {
  if (!failed_) std::fprintf(stderr, "pmac-run: %s\n", message.c_str());
  failed_ = true;
}

void Outputs::record(runtime::Machine& machine, Recorder& recorder) {
  recorder.add_sink({[this, &machine](const std::vector<std::string>& columns) {
                       try {
                         record_ = runtime::make_table_writer(*runtime::table_format_of(options_.record), options_.record, columns,
                                                              known_samples(options_, machine.servo_period_ms()));
                       } catch (const std::exception& e) { fail(e.what()); }
                     },
                     {},
                     [this](std::span<const std::span<const double>> columns) {
                       try {
                         if (record_ && !failed_) record_->append_columns(columns);
                       } catch (const std::exception& e) { fail(e.what()); }
                     }});
}

void Outputs::gather(runtime::Machine& machine) {
  machine.set_gather_sink({[this](const std::vector<std::string>& columns) {
                             try {
                               gather_ = runtime::make_table_writer(*runtime::table_format_of(options_.gather), options_.gather, columns);
                             } catch (const std::exception& e) { fail(e.what()); }
                           },
                           [this](std::span<const double> row) {
                             try {
                               if (gather_ && !failed_) gather_->append(row);
                             } catch (const std::exception& e) { fail(e.what()); }
                           }});
}

void Outputs::keep_for_plots(Recorder& recorder) {
  recorder.add_sink({[this](const std::vector<std::string>& columns) {
                       plot_columns_ = columns;
                       plot_values_.resize(columns.size());
                     },
                     [this](std::span<const double> rows) {
                       const std::size_t width = plot_columns_.size();
                       for (std::size_t i = 0; i < rows.size(); i += width) keep_row(rows.subspan(i, width));
                     }});
}

/// A picture of a long run needs no more points than it has pixels: where they get too many, every second one goes.
void Outputs::keep_row(std::span<const double> row) {
  constexpr std::size_t kMostPoints = 1'000'000;
  last_row_.assign(row.begin(), row.end());
  if (plot_rows_++ % plot_stride_ != 0) return;
  for (std::size_t column = 0; column < row.size(); ++column) plot_values_[column].push_back(row[column]);
  if (plot_values_[0].size() < kMostPoints) return;
  plot_stride_ *= 2;
  for (std::vector<double>& values : plot_values_) {
    for (std::size_t i = 0; i < values.size() / 2; ++i) values[i] = values[2 * i];
    values.resize(values.size() / 2);
  }
}

bool Outputs::finish() {
  try {
    if (record_ && !failed_) record_->finish();
    if (gather_ && !failed_) gather_->finish();
    if (!options_.gather.empty() && !gather_ && !failed_)
      std::fprintf(stderr, "pmac-run: nothing was gathered, %s is not written; set Gather.Enable = 2 in the program\n", options_.gather.c_str());
    if (!options_.plots.empty() && options_.drive.empty() && !failed_) draw();
  } catch (const std::exception& e) {
    fail(e.what());
  }
  return !failed_;
}

/// Curves of the picture: the axes; the motors where no axis is defined. The path panel shows the first two axes.
void Outputs::draw() {
  if (plot_stride_ > 1)
    for (std::size_t column = 0; column < last_row_.size(); ++column) plot_values_[column].push_back(last_row_[column]);
  runtime::PlotData data;
  const auto is_motor = [](const std::string& name) { return name.starts_with("Motor["); };
  const bool axes = std::any_of(plot_columns_.begin() + 1, plot_columns_.end(), [&](const auto& name) { return !is_motor(name); });
  data.length_unit = axes ? "" : "motor units";
  data.time_s = std::move(plot_values_[0]);
  for (std::size_t c = 1; c < plot_columns_.size(); ++c)
    if (is_motor(plot_columns_[c]) != axes) data.curves.push_back({plot_columns_[c], std::move(plot_values_[c])});
  const auto index_of = [&](const char* name) {
    const auto at = std::find_if(data.curves.begin(), data.curves.end(), [&](const auto& curve) { return curve.name == name; });
    return static_cast<std::size_t>(at - data.curves.begin());
  };
  if (axes && index_of("X") < data.curves.size() && index_of("Y") < data.curves.size()) data.path = {index_of("X"), index_of("Y")};
  else if (axes && data.curves.size() >= 2) data.path = {0, 1};
  for (const std::string& file : options_.plots) runtime::draw(data, *runtime::plot_format_of(file), file);
}

}  // namespace pmac::tool
