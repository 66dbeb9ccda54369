// --drive: gives the motion of a run to a drive back end, prints its frames, executes them on the simulated drive and tells how far
// that was from the motion.
#pragma once

#include <cstdio>
#include <memory>
#include <optional>
#include <string>

#include "runtime/drives/drive.h"
#include "runtime/machine.h"
#include "runtime/motion/pipeline.h"
#include "runtime/tool/options.h"

namespace pmac::tool {

class DriveRun : public runtime::SampleSink {
 public:
  explicit DriveRun(const RunOptions& options) : options_(options) {}

  /// Makes the drive that the options name, if any. Returns an exit code; messages go to standard error.
  int set_up(runtime::Machine& machine);
  bool active() const { return drive_ != nullptr; }

  /// The observers of a coordinate system's stages, and the drive's besides.
  motion::StageObservers observed(int coord, motion::StageObservers stages);
  void take(const runtime::SampleBlock& block) override { if (drive_) drive_->take(block); }
  bool takes_late() const override { return false; }
  void take(const runtime::MoveRecord& move) { if (drive_) drive_->take(move); }

  /// The run is over: encodes, prints the frames (--emit=frames), executes, writes the files. Returns an exit code; what went wrong is
  /// on standard error.
  int finish();
  /// What the simulated drive did; empty without --drive, and where the drive cannot execute the motion.
  const std::optional<drives::Execution>& execution() const { return execution_; }
  /// Why the drive cannot execute the motion; empty where it can.
  const std::string& refusal() const { return refusal_; }

 private:
  void print_frames() const;
  void report_events() const;

  const RunOptions& options_;
  std::unique_ptr<drives::Drive> drive_;
  std::optional<drives::Execution> execution_;
  std::string refusal_;
};

/// The lines of --stats.
std::string drive_text(const DriveRun& run);

}  // namespace pmac::tool
