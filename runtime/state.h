// Inside the runtime: everything that one simulated controller is. The stages that work on it are functions and classes in files of
// their own: host.cpp (what programs reach), online.cpp (commands), schedule.cpp (time), coordinate/ (programs that move).
#pragma once

#include <array>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "compiler/bytecode/element.h"
#include "runtime/coordinate/coord_system.h"
#include "runtime/element_store.h"
#include "runtime/gather_unit.h"
#include "runtime/interpreter/interpreter.h"
#include "runtime/io/io_space.h"
#include "runtime/io/pointer_table.h"
#include "runtime/machine.h"
#include "runtime/motor.h"
#include "runtime/runner.h"

namespace pmac::runtime {

class Tracer;

/// A PLC program and its scan state.
struct Plc {
  std::unique_ptr<Runner> runner;
  bool active = false, running = false;
  OpenBlock block;                       // the move block that its scan is collecting
};

/// A line of commands waiting for its time.
struct TimedCommand { double time_ms; std::string text; };

/// A cmd "..." of a program, executed at the end of the pass that queued it. sender: see command_addresses.
struct QueuedCommand { int sender; std::string text; bytecode::SourceLine source; };

/// What & and # address in the command lines of one sender.
struct Addresses { int coord = 1, motor = 1; };

/// An axis definition in force.
struct SavedAxis { int coord = 0, motor = 0; bytecode::AxisDefinition definition; };

/// What save keeps and $$$ brings back (reset.cpp).
struct Configuration {
  std::vector<std::pair<ElementAddress, double>> elements;
  std::vector<SavedAxis> axes;
  PointerTable pointers;
  std::map<std::uint32_t, ProgramHandle> progs, subprogs, plc_programs;
  std::vector<ProgramHandle> forward, inverse;       // by coordinate system
};

/// What stopped a motor at a servo interrupt. value_mu: following error, actual or commanded position; of a trigger its place (raw).
struct ServoTrip {
  enum class Kind { kFollowingError, kAmplifier, kPlusSwitch, kMinusSwitch, kPlusPosition, kMinusPosition, kTrigger };
  int motor = 0;
  Kind kind{};
  double value_mu = 0;
};

struct Machine::State {
  explicit State(MachineOptions options);
  ~State();

  MachineOptions options;
  ElementStore elements;
  std::vector<double> p, i_values;
  IoSpace io;
  PointerTable pointers;
  std::array<Motor, bytecode::kMaxMotors> motors;
  std::vector<std::unique_ptr<CoordSystem>> coords;
  std::array<Plc, bytecode::kMaxPlcs> plcs;
  std::unique_ptr<Runner> online;                    // the command thread: files, -e, --at, console
  std::unique_ptr<Host> host;
  std::unique_ptr<Tracer> tracer;                    // absent: nobody wants a trace
  std::map<std::uint32_t, ProgramHandle> progs, subprogs, plc_programs;
  std::vector<std::string> files;                    // of all modules
  std::shared_ptr<const bytecode::Module> loading;   // module whose load script is executing
  GatherUnit gather;
  int echo = 0;                                      // how answers look: bit 0, without names
  std::map<int, SavedAxis> axis_definitions;         // by motor, the last one given
  std::unique_ptr<Configuration> saved;
  enum class Reset { kNone, kSaved, kFactory };
  Reset pending_reset = Reset::kNone;
  bool programs_execute = false;                     // a reset waits until they do not

  // time
  std::int64_t tick = -1;                            // last servo interrupt that has been sampled; -1: none yet
  double now_ms = 0;                                 // last event
  double last_background_ms = 0;
  std::vector<TimedCommand> timed;                   // ascending time
  std::deque<QueuedCommand> queued;
  std::map<int, Addresses> command_addresses;        // by sender_key()
  std::vector<SampleSink*> sinks;
  std::vector<int> block_motors;                     // of sample_to(), kept so that a block costs no allocation
  std::vector<double> block_times;                   // servo ticks of the block
  std::vector<double> block_rows, block_path, block_actual, block_home;
  std::vector<ServoTrip> trips;                      // of the last servo interrupt, until service() has acted on them

  bool runs_free = false;                            // see free_run.h

  // bookkeeping
  std::uint64_t instructions = 0;
  std::uint64_t random_state = 0x9e3779b97f4a7c15ull;
  bool any_fault = false, any_refused = false;
  const QueuedCommand* executing_queued = nullptr;   // the cmd "..." that is being executed
  int last_error = 0;                                // number of the last refusal, as in error #20; 0: none
  std::optional<bytecode::SourceLine> assignment_source;  // of the synchronous assignment that is being performed
  std::map<std::pair<std::int32_t, std::int32_t>, std::set<std::string>> warned;   // texts by file and line
  std::vector<double> online_locals;                 // L variables of the command lines
  double idle_since_ms = 0;
  bool is_idle = true;

  /// Sys.ServoPeriod and Sys.RtIntPeriod, fixed from the first servo interrupt on.
  double servo_period_ms = elements.get(bytecode::ElementId::kSysServoPeriod);
  std::int64_t rti_cycles = 1;
  mutable double rti_asked_ms = -1, rti_answer_ms = 0;   // the last question of next_rti_ms(), asked several times an event
  mutable std::int64_t rti_asked_cycles = 0;             // 0: forgotten
  double period_ms() const { return servo_period_ms; }
  double rti_period_ms() const { return servo_period_ms * static_cast<double>(rti_cycles); }
  double tick_ms(std::int64_t k) const { return static_cast<double>(k) * period_ms(); }
  /// First real-time interrupt after time_ms (strictly).
  double next_rti_ms(double time_ms) const;
  /// First real-time interrupt at or after time_ms.
  double rti_at_or_after_ms(double time_ms) const;
  CoordSystem& coord(int number) { return *coords[static_cast<std::size_t>(number)]; }

  void report_fault(const FaultRecord& record);
  void answer(const std::string& text);
  void warn(bytecode::SourceLine source, const std::string& text);
  void refuse(const std::string& text, const std::string& reason);
  std::string place(bytecode::SourceLine source) const;
  /// Runs a program to its end or budget on the command thread.
  void run_load_script(ProgramHandle program);
  void execute_queued_commands();
  void execute_queued(const QueuedCommand& next);
  Runner* sender_of(const QueuedCommand& queued_command);
  static int sender_key(const Runner& runner) { return static_cast<int>(runner.kind) * 100 + runner.number; }
  bool executes(bytecode::ProgramKind kind, std::uint32_t number) const;
  void install(ProgramHandle handle);
  void load(bytecode::Module module);
  void command(std::string_view text, std::string_view name);
  /// Stores what a synchronous assignment stores.
  void perform(const SyncEntry& entry, CoordSystem& from);

  // reset.cpp
  void save();
  /// Resets now, or as soon as no program is in the middle of its execution.
  void request_reset(bool factory);
  void reset_now();

  // free_run.cpp
  /// For all that looks at motors, or changes what acts next: samples up to now that have been left out are made.
  void catch_up() {
    if (runs_free) end_free_run();
  }
  void end_free_run();

  // schedule.cpp
  RunOutcome run(const RunLimits& limits);
  double next_event_ms(double limit_ms);
  /// Answers the time that has been reached: time_ms, or earlier where a servo has tripped.
  double sample_to(double time_ms);
  void command_rows();
  int follow_rows(std::vector<double>& actual);
  void deliver(const SampleBlock& block);
  void service(double time_ms);
  /// The rest of a service: what coordinate systems from `first` on do, then commands and PLC programs.
  void service_from(int first, double time_ms);
  void scan_plcs(double time_ms);
  void scan(int plc, double time_ms);
  void finish_scan(int plc, const RunResult& result);
  /// One source line of a PLC program that is not running.
  void step_plc(int plc);
  void update_idle(double time_ms);
  bool anything_runs() const;
};

/// Control verbs of programs and command lines (online.cpp). refusal: filled where the controller would answer an error.
Flow execute_control(Machine::State& state, Runner& runner, bytecode::ControlVerb verb, std::span<const double> arguments,
                     std::string& refusal);

/// Reports of command lines (answer.cpp). report() answers a refusal or empty.
bool is_report(bytecode::ControlVerb verb);
std::string report(Machine::State& state, Runner& runner, bytecode::ControlVerb verb, std::span<const double> arguments);
/// "name=value", or the value alone as echo wants it.
void answer_value(Machine::State& state, const std::string& name, const std::string& value);
/// vers, echo 7, list prog 5 and their kind (system_command.cpp). Answers a refusal or empty.
std::string execute_system_command(Machine::State& state, Thread& thread, std::string_view text);

/// pread and its kin (axis_queries.cpp): axis values of a coordinate system to D(axis index), their mask to D32 of the thread.
/// Answers a refusal or empty. wanted_axes: their mask; nan: all.
std::string read_axes(Machine::State& state, int coord, bytecode::ControlVerb verb, double wanted_axes, Thread& thread);

/// Value of a status element at the present time, or of a stored one (status.cpp).
double read_element_value(Machine::State& state, Runner& runner, const ElementAddress& address);

std::unique_ptr<Host> make_host(Machine::State& state);

}  // namespace pmac::runtime
