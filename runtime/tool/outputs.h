// The files of a run: --record, --gather, --plot. Each gets its name only when it is complete.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "runtime/gather/table_writer.h"
#include "runtime/machine.h"
#include "runtime/tool/options.h"
#include "runtime/tool/recorder.h"

namespace pmac::tool {

class Outputs {
 public:
  /// Hooks the writers into the recorder and the machine's gathering.
  Outputs(const RunOptions& options, runtime::Machine& machine, Recorder& recorder);
  /// Completes every file; false (and a message) where one could not be written.
  bool finish();
  /// Bytes written so far.
  std::uint64_t size() const { return (record_ ? record_->size() : 0) + (gather_ ? gather_->size() : 0); }

 private:
  void record(runtime::Machine& machine, Recorder& recorder);
  void gather(runtime::Machine& machine);
  void keep_for_plots(Recorder& recorder);
  void fail(const std::string& message);
  void keep_row(std::span<const double> row);
  void draw();

  const RunOptions& options_;
  std::unique_ptr<runtime::TableWriter> record_, gather_;
  std::vector<std::string> plot_columns_;
  std::vector<std::vector<double>> plot_values_;   // [column][row]: every plot_stride_-th row
  std::size_t plot_stride_ = 1, plot_rows_ = 0;
  std::vector<double> last_row_;
  bool failed_ = false;
};

/// The first of the files whose ending is none that can be written, or empty.
std::string unknown_ending(const RunOptions& options);

/// The first output file that is an input file or another output as well, or empty.
std::string clashing_file(const RunOptions& options);

}  // namespace pmac::tool
