// --emit=: the records of a stage as text on standard output, one line each, as they are made.
#pragma once

#include <string>

#include "runtime/machine.h"
#include "runtime/tool/recorder.h"

namespace pmac::tool {

class Emitter {
 public:
  /// stage: empty, commands, path, segments, lookahead or servo.
  explicit Emitter(std::string stage) : stage_(std::move(stage)) {}
  void attach(runtime::MachineObservers& observers);
  void attach(runtime::Machine& machine, Recorder& recorder);

 private:
  std::string stage_;
};

}  // namespace pmac::tool
