// --trace: the machine's trace records as text, one line each, on standard output or in a file that keeps its name only when whole.
//
//          time   thread   program        place and text of the line                    what it assigned
//       0.000000  &1       prog 1         move.pmc:6: P1 = P1 + 1                    -> P1 = 4
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "runtime/gather/output_file.h"
#include "runtime/machine.h"
#include "runtime/tool/options.h"
#include "runtime/trace.h"

namespace pmac::tool {

class TraceWriter {
 public:
  using SourceText = std::function<std::optional<std::string>(const std::string& file, int line)>;

  /// Does nothing where the options want no trace. Throws runtime::OutputError where the file cannot be created.
  TraceWriter(const RunOptions& options, SourceText source_text);
  /// Asks the machine for records.
  void attach(runtime::MachineOptions& machine);
  /// place: "file:line" of a record.
  void write(const runtime::TraceRecord& record, const std::string& file, const std::string& place);
  /// Says what was left out, and gives the file its name. False: it could not be written, which has been said.
  bool finish();

 private:
  std::string line_text(const runtime::TraceRecord& record, const std::string& file) const;
  void put(const std::string& line);
  void fail(const std::exception& error);

  const RunOptions& options_;
  SourceText source_text_;
  std::unique_ptr<runtime::OutputFile> file_;
  std::uint64_t written_ = 0;
  bool failed_ = false;
};

}  // namespace pmac::tool
