// The way into the runtime: one simulated controller. Load modules, give commands, run simulated time, take the samples.
//
//     Machine machine(options);
//     machine.add_sink(&statistics);
//     machine.load(std::move(module));            // executes its load script
//     machine.command("&1 b1r");
//     RunOutcome outcome = machine.run(limits);
//
// Time is simulated and comes from the machine alone: the same input gives the same samples, bit by bit.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "compiler/bytecode/bytecode.h"
#include "runtime/fault.h"
#include "runtime/gather_unit.h"
#include "runtime/motion/types.h"
#include "runtime/servo/activity.h"
#include "runtime/servo/servo.h"

namespace pmac::motion {
struct StageObservers;
}
namespace pmac::kinematics {
class AxisMap;
class Robot;
}

namespace pmac::runtime {

struct TraceRecord;
enum class TraceDetail { kNone, kLines, kInstructions };

/// Compiles a line of on-line commands, or says why not (the controller's error text). `name` appears as the file.
using OnlineCompiler = std::function<std::variant<bytecode::Module, std::string>(std::string_view text, std::string_view name)>;

/// A move, dwell, delay, jog or home, complete.
struct MoveRecord {
  std::string_view mode;        // linear, rapid, circle1, ..., dwell, delay, jog, home
  bytecode::SourceLine source;
  int coord = -1;               // -1: a motor's own move
  int motor = -1;
  double start_ms = 0, end_ms = 0;
  double length = 0;            // axis units along the path, 0 for dwell and delay; motor units for a jog
  std::string_view time_rule = {};                        // what a block's time comes from: F, tm, ...; empty for others
  std::vector<motion::GoverningShare> governed = {};      // longest first; only with MachineOptions::note_governing
};

/// A write by a program that changed a point of a simulated card.
struct OutputChange {
  double time_ms = 0;
  std::string name;             // declared name of the pointer, or its address
  double value = 0;
  bytecode::SourceLine source;
};

struct FaultRecord {
  double time_ms = 0;
  int coord = -1, plc = -1;
  Fault fault;
  int motor = -1;               // whose fault it is, where it is one motor's
};

/// With limit_jerk: a place where the path's acceleration steps, as where a line meets an arc. ratio: the jerk that this is at servo rate,
/// in limits of the motor for which that is most.
struct JerkJoin { double time_ms = 0; int coord = -1; bytecode::SourceLine source; double ratio = 0; };

/// What the owner wants to hear. Any may be empty.
struct MachineObservers {
  std::function<void(const std::string&)> answer;            // reports of on-line commands, [send N] lines
  std::function<void(const std::string& text, const std::string& reason)> refused;  // on-line commands refused
  std::function<void(bytecode::SourceLine, const std::string& text)> warning;   // once a source line and text
  std::function<void(const MoveRecord&)> move;
  std::function<void(const OutputChange&)> output;
  std::function<void(const FaultRecord&)> fault;
  std::function<void(int coord, const motion::MotionCommand&)> motion_command;
  std::function<void(const JerkJoin&)> jerk_join;
  std::function<void(const TraceRecord&)> trace;              // trace.h; with MachineOptions::trace
  std::function<void(double time_ms)> progress;               // now and then while running
};

struct MachineOptions {
  motion::FineInterpolation fine = motion::FineInterpolation::kThrough;
  motion::RampRule ramp_rule = motion::RampRule::kPower;
  bool limit_jerk = false;              // lookahead keeps Motor[].InvJmax as well
  bool note_governing = false;                                // of every move, for reports
  OnlineCompiler compile_online;                              // cmd "...", --at, console
  /// A line of a source file, for list; empty where the owner has no source.
  std::function<std::optional<std::string>(const std::string& file, int line)> source_text;
  MachineObservers observers;
  TraceDetail trace = TraceDetail::kNone;
  std::uint64_t trace_limit = 1'000'000;                      // records; the run goes on without
  std::uint64_t max_instructions = 20'000'000'000;            // of a whole run
  bool free_runs = true;                                      // false: servo samples are made event by event (the same ones)
};

enum class RunEnd { kIdle, kUntil, kTimeLimit, kBudget, kInterrupted };

struct RunLimits {
  std::optional<double> until_ms;   // run exactly to here; absent: until idle for idle_ms
  double max_ms = 3'600'000;
  double idle_ms = 10;
  std::function<bool()> interrupted;
  std::function<bool()> over_budget;  // of the owner: the run ends as at the limit of instructions
  bool more_follows = false;        // another run goes on from here: nothing is closed or sampled beyond the end
};

struct RunOutcome {
  RunEnd end = RunEnd::kIdle;
  double time_ms = 0;
  std::int64_t ticks = 0;
  std::uint64_t instructions = 0;
  /// Where every running program stood, for a message at a limit: "prog 1 at loop.pmc:3".
  std::vector<std::string> running;
};

class Machine {
 public:
  explicit Machine(MachineOptions options);
  ~Machine();
  Machine(const Machine&) = delete;

  /// Takes over the module and executes its load scripts at the present time. The module must have passed verify().
  void load(bytecode::Module module);
  /// Compiles and executes a line of on-line commands now.
  void command(std::string_view text, std::string_view name = "command");
  /// The same at a simulated time.
  void at(double time_ms, std::string text);

  /// Takes samples from the first tick (time 0) on. Before run().
  void add_sink(SampleSink* sink);
  /// Takes what programs gather (Gather.Enable). Before run().
  void set_gather_sink(GatherSink sink);
  void observe_stages(int coord, motion::StageObservers observers);

  RunOutcome run(const RunLimits& limits);

  double time_ms() const;
  double servo_period_ms() const;
  /// Source file names by SourceLine::file, over all loaded modules.
  const std::vector<std::string>& files() const;
  std::string place(bytecode::SourceLine source) const;   // "file:line"
  bool any_fault() const;
  bool any_refused() const;

  /// Motors of every coordinate system, ascending; and those that have moved besides.
  std::vector<int> motors_in_use() const;
  /// Coordinate systems that have motors.
  std::vector<int> coords_in_use() const;
  /// Axes of a coordinate system that have motors, as a mask; and their positions for motor positions by motor number
  /// (the forward map). False where the forward routine has no solution.
  std::uint32_t axes_of(int coord) const;
  bool axes_from_motors(int coord, std::span<const double> motor_mu, motion::AxisVector& axis_uu, std::string* why = nullptr);
  /// The linear map of a coordinate system; null where a routine or a robot has a part in the forward map.
  const kinematics::AxisMap* linear_axes(int coord) const;
  /// Motor positions of an axis position, into motor_mu by motor number; the fault where there is none.
  std::optional<Fault> motors_from_axes(int coord, const motion::AxisVector& axis_uu, std::span<double> motor_mu);
  /// A stock robot in place of the kinematic routines of a coordinate system: its motors ->I, ascending, are the joints, each with its
  /// motor units per mm or degree (one number for all, or one a joint).
  void set_robot(int coord, std::shared_ptr<const kinematics::Robot> robot, std::vector<double> motor_mu_per_joint);
  /// The coordinate system has motors ->I.
  bool has_kinematics(int coord) const;
  /// Motors ->I of a coordinate system, ascending.
  std::vector<int> kinematic_motors(int coord) const;
  /// Motor[].MinPos and MaxPos; nullopt where they are no range.
  std::optional<std::pair<double, double>> motor_range_mu(int motor) const;

  /// What a motor does at a tick of the block that the sinks are being given, and the limits that hold for it.
  MotorActivity activity(int motor, double time_ms) const;

  struct State;

 private:
  std::unique_ptr<State> state_;
};

}  // namespace pmac::runtime
