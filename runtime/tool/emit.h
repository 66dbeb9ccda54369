// --emit=: the records of a stage as text on standard output, one line each, as they are made.
#pragma once

#include <cstdint>
#include <string>

#include "runtime/machine.h"
#include "runtime/tool/drive_run.h"
#include "runtime/tool/recorder.h"

namespace pmac::tool {

class Emitter {
 public:
  /// stage: empty, commands, path, segments, lookahead, servo, or frames, which the drive prints.
  explicit Emitter(std::string stage) : stage_(std::move(stage)) {}
  void attach(runtime::MachineObservers& observers);
  /// The observers of the stages, and those of the drive besides.
  void attach(runtime::Machine& machine, Recorder& recorder, DriveRun& drive);

  /// Bytes printed so far.
  std::uint64_t printed() const { return printed_; }

 private:
  void print(const std::string& line);
  void print_line(int coord, const std::string& header, const std::string& line);

  std::string stage_;
  int last_coord_ = -1;
  std::uint64_t printed_ = 0;
};

}  // namespace pmac::tool
