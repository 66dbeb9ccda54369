// The way into the drive back ends: the motion of a run goes in, as path pieces (hop 6) and servo samples (hop 9); what the drive
// hardware would be sent comes out as frames; a simulator of the drive executes the frames and says how far it was from the motion.
//
//     path pieces, samples -> take() ... encode() -> frames() -> execute() -> Execution: positions, error, events
//
// A new drive is a folder beside this file, a function that makes it, and a row of drive.def.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "compiler/bytecode/bytecode.h"
#include "runtime/motion/types.h"
#include "runtime/servo/servo.h"

namespace pmac::motion {
struct PathPiece;
}
namespace pmac::runtime {
struct MoveRecord;
}

namespace pmac::drives {

/// NAME=VALUE of --drive DRIVE:NAME=VALUE,..., in order. Each drive knows its own.
using Settings = std::vector<std::pair<std::string, std::string>>;

/// What a drive may ask the controller while it takes and encodes. Motor arrays are by motor number.
struct DriveContext {
  /// Motor positions of an axis position of a coordinate system, into motor_mu (kMaxMotors long); the reason where there is none.
  std::function<std::optional<std::string>(int coord, const motion::AxisVector& axis_uu, std::span<double> motor_mu)> motors_from_axes;
  /// "file:line", for messages.
  std::function<std::string(bytecode::SourceLine)> place;
};

/// One thing that goes over the wire or into a register.
struct Frame {
  double time_s = 0;               // when the host sends it, since the first one
  std::string text;                // printable: a line of --emit=frames
};

/// Something that happened in the simulated drive.
struct DriveEvent {
  double time_s = 0;
  bool is_error = false;           // the motion is not what was asked for: the run exits 3
  std::string text;                // a sentence without full stop
};

/// A named number of the report, in the order of the report.
struct Figure {
  std::string name;                // key of the JSON object, with its unit: "error_max_counts"
  double value = 0;
};

/// What the simulated drive did with the frames.
struct Execution {
  std::vector<std::string> axes;             // "Motor[1]"
  double time_s = 0;                         // end of the motion
  std::vector<double> times_s;               // of the rows below
  std::vector<std::vector<double>> position_counts;   // [axis][row], where the drive was
  std::vector<std::vector<double>> commanded_counts;  // [axis][row], where the motion of the run wanted it; same zero
  std::vector<double> error_counts;          // [row], distance of the position from the commanded path
  std::vector<Figure> figures;
  std::vector<DriveEvent> events;            // in order of time
};

class Drive {
 public:
  virtual ~Drive() = default;

  /// Hop 6. Pieces come in order within a coordinate system, ahead of the samples that execute them; after an abort some are never
  /// executed. Rapid moves, jogs and dwells have no pieces.
  virtual void take(int /*coord*/, const motion::PathPiece& /*piece*/) {}
  /// Hop 9, every motor in use.
  virtual void take(const runtime::SampleBlock& /*block*/) {}
  /// A move, dwell or jog is complete.
  virtual void take(const runtime::MoveRecord& /*move*/) {}

  /// Everything has been taken: makes the frames. The reason (what, and the remedy) where this drive cannot execute the motion;
  /// frames() and execute() are then not called.
  [[nodiscard]] virtual std::optional<std::string> encode() = 0;
  /// Every frame in order of sending.
  virtual void frames(const std::function<void(const Frame&)>& sink) const = 0;
  /// Executes the frames, and nothing but the frames, on the simulated drive.
  virtual Execution execute() = 0;
};

/// A drive by name, or why there is none: unknown name, unknown setting, bad value.
std::variant<std::unique_ptr<Drive>, std::string> make_drive(std::string_view name, const Settings& settings, DriveContext context);

/// The drives and their settings, a line each.
std::string drive_list();

}  // namespace pmac::drives
