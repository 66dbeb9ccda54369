#include "runtime/tool/outputs.h"

#include <cstdio>
#include <exception>

#include "runtime/gather/plot.h"

namespace pmac::tool {

std::string unknown_ending(const RunOptions& options) {
  for (const std::string& file : {options.record, options.gather})
    if (!file.empty() && !runtime::table_format_of(file)) return file;
  for (const std::string& file : options.plots)
    if (!runtime::picture_format_of(file)) return file;
  return {};
}

Outputs::Outputs(const RunOptions& options, runtime::Machine& machine, Recorder& recorder) : options_(options) {
  if (!options.record.empty()) record(recorder);
  if (!options.gather.empty()) gather(machine);
  if (!options.plots.empty()) keep_for_plots(recorder);
}

void Outputs::fail(const std::string& message) {
  if (!failed_) std::fprintf(stderr, "pmac-run: %s\n", message.c_str());
  failed_ = true;
}

void Outputs::record(Recorder& recorder) {
  recorder.add_sink({[this](const std::vector<std::string>& columns) {
                       try {
                         record_ = runtime::make_table_writer(*runtime::table_format_of(options_.record), options_.record, columns);
                       } catch (const std::exception& e) { fail(e.what()); }
                     },
                     [this](std::span<const double> rows) {
                       try {
                         if (record_ && !failed_) record_->append(rows);
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
                       for (std::size_t i = 0; i < rows.size(); ++i) plot_values_[i % width].push_back(rows[i]);
                     }});
}

bool Outputs::finish() {
  try {
    if (record_ && !failed_) record_->finish();
    if (gather_ && !failed_) gather_->finish();
    if (!options_.gather.empty() && !gather_ && !failed_)
      std::fprintf(stderr, "pmac-run: nothing was gathered, %s is not written; set Gather.Enable = 2 in the program\n", options_.gather.c_str());
    if (!options_.plots.empty() && !failed_ && !draw()) return false;
  } catch (const std::exception& e) {
    fail(e.what());
  }
  return !failed_;
}

bool Outputs::draw() {
  runtime::PlotData data;
  for (std::size_t c = 0; c < plot_columns_.size(); ++c) data.columns.push_back({plot_columns_[c], std::move(plot_values_[c])});
  for (const std::string& file : options_.plots)
    if (const std::string problem = runtime::draw(data, file); !problem.empty()) {
      fail(problem);
      return false;
    }
  return true;
}

}  // namespace pmac::tool
