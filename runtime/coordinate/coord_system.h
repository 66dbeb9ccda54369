// One coordinate system: its axis definitions, its modes, the motion program it executes, and the pipeline that turns its moves into
// motor positions. It decides when the program calculates on (ahead of motion) and when it waits (dwell, rapid, jump-back rule).
//
//   idle --run--> calculating <--> waiting for room (enough moves ahead)
//                     |  dwell, rapid, loop without moves, pause, end
//                     v
//                 coming to rest --> dwelling | rapid move | next interrupt | paused | idle
//
// Everything on the path happens by the coordinate system's own clock (time_base.h); times of the pipeline and of its motors' profiles
// are that clock's, times of events are the machine's.
// Source: calculation ahead of motion, User's Manual p681-706; see docs/motion.md.
#pragma once

#include <deque>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "kinematics/kinematics.h"
#include "kinematics/robot.h"
#include "compiler/bytecode/control.h"
#include "runtime/coordinate/modal.h"
#include "runtime/coordinate/time_base.h"
#include "runtime/coordinate/transform.h"
#include "runtime/machine.h"
#include "runtime/motion/cutter_compensation.h"
#include "runtime/motion/pipeline.h"
#include "runtime/motion/profile.h"
#include "runtime/motion/ring.h"
#include "runtime/motion/spline.h"
#include "runtime/runner.h"

namespace pmac::runtime {

/// A synchronous assignment in the queue. element_address belongs to target.element where the class is kElement.
struct SyncEntry {
  bytecode::SyncTarget target;
  ElementAddress element;
  double value = 0;
  std::uint64_t move_id = 0;   // executed when this move, dwell or delay starts
  bytecode::SourceLine source;
};

/// A rapid block: where to, and which axes stop at a trigger (their distances from it).
struct RapidMove {
  AxisVector target_uu{};
  std::uint32_t trigger_axes = 0;
  AxisVector trigger_uu{};
  bytecode::SourceLine source;
};

/// pmatch, pset (axis and value), pclr, pstore or pload.
struct PositionChange { bytecode::ControlVerb verb; int axis = 0; double value = 0; };

/// A stock robot that stands in for the kinematic routines: motors ->I, ascending, are its joints.
struct StockRobot {
  std::shared_ptr<const kinematics::Robot> robot;
  std::vector<double> motor_mu_per_joint;  // [joint], or one for all
};

class CoordSystem {
 public:
  CoordSystem(Machine::State& machine, int number);
  ~CoordSystem();
  int number() const { return number_; }

  // --- set-up -------------------------------------------------------------------------------------------------------
  /// Applies an axis definition to a motor. Answers a refusal, or empty.
  std::string define(const bytecode::AxisDefinition& definition, int motor);
  const kinematics::AxisMap& map() const { return map_; }
  const std::vector<int>& motors() const { return motors_; }
  ProgramHandle forward, inverse;
  StockRobot robot;            // in place of forward and inverse, where there is one
  int lookahead_buffer = 0;    // segments of define lookahead
  ModalState modal;
  std::vector<double> q;

  // --- program control; each answers a refusal ("error #22: ...") or empty -----------------------------------------------
  std::string begin(std::uint32_t number, std::int64_t label);
  /// Starts at the pointer, or goes on after a pause or a hold.
  std::string run(double time_ms);
  std::string resume(double time_ms);
  /// cx: starts a program that is in no buffer.
  std::string execute(ProgramHandle program, double time_ms);
  /// open rotary: adds lines to program 0 of the coordinate system. One that waits for lines goes on with them.
  std::string append_rotary(ProgramHandle lines, double time_ms);
  void clear_rotary() { rotary_.clear(); }
  /// One move, dwell or delay; a program that executes is paused.
  std::string step(double time_ms);
  /// Finishes what is calculated and waits at a programmed point.
  std::string pause(double time_ms);
  std::string hold(double time_ms);
  /// Inside lookahead as fast as the motors' limits allow, otherwise a feed hold.
  std::string quick_stop(double time_ms);
  bool quick_stopped() const { return quick_stopped_ || shaping_ == Shaping::kSlower; }
  /// Runs the stored path backwards, until a quick stop, forward(), or the end of what is stored.
  std::string retrace(double time_ms);
  std::string forward_on_path(double time_ms);
  /// The path behind the place that the program has come to is run through, backwards or forwards.
  bool retracing() const { return back_ms_ < 0 || back_rate_ != 0 || shaping_ == Shaping::kBack; }
  bool runs_backwards() const { return back_rate_ < 0; }
  /// rate: 1 is 100 %. It is reached at Coord[].TimeBaseSlew.
  std::string set_time_base(double time_ms, double rate);
  const TimeBase& time_base() const { return time_base_; }
  /// A motor that belongs here gets a profile at time_ms: the clock it runs by.
  const TimeBase* clock_for_motion(double time_ms);
  void abort(double time_ms);
  /// A run-time error: aborts, sets ErrorStatus and reports. A software limit ahead inside lookahead: the motion ends on the path at the
  /// limit, then it is reported, and the program waits to be aborted.
  void fail(double time_ms, Fault fault);
  void fail_at_once(double time_ms, Fault fault);
  bool program_running() const { return phase_ != Phase::kIdle && phase_ != Phase::kPaused; }
  /// Stands, or has stood, on the path at a software limit.
  bool at_limit() const { return at_limit_; }
  /// Executing, or waiting to go on.
  bool program_active() const { return phase_ != Phase::kIdle; }
  /// Executing, and going on by itself: not held, not at 0 %.
  bool proceeding(double time_ms) const { return program_running() && (!time_base_.stands(time_ms) || next_event_ms() < kNever); }
  /// Rate at which the path is run through, below 0 backwards; 1 is 100 %.
  double path_rate(double time_ms) const { return time_base_.rate_at(time_ms) + back_rate_; }
  bool executes(const bytecode::Program* program) const;
  const Runner& runner() const { return runner_; }
  Runner& runner() { return runner_; }
  bool dwelling() const { return phase_ == Phase::kDwelling; }
  /// Where the program stands, for a message: at its calculation, or once that has ended, in motion.
  bytecode::SourceLine line_at(double time_ms) const;
  /// Where the program stood when it was aborted last; no program where it has run on since.
  struct Stand { ProgramHandle program; bytecode::SourceLine source; };
  const Stand& aborted() const { return aborted_; }

  // --- what the program asks for (called by the host) ---------------------------------------------------------------------
  Flow motion(Thread& thread, const bytecode::Instruction& instruction, std::span<const double> registers);
  /// Words of a move block, as Host::move_words() has them.
  void add_words(std::span<const std::uint8_t> words, std::span<const double> values);
  /// A move block of a PLC program: rapid whatever the mode, and nobody waits for it.
  Flow plc_move(Thread& thread, const OpenBlock& block);
  Flow queue_assignment(Thread& thread, const bytecode::SyncTarget& target, const ElementAddress& element, double value);
  void stop_program_from_inside() { stop_requested_ = true; }
  Flow pause_from_inside(Thread& thread) { return stop_item(thread, AfterRest::kPause); }
  /// home in the program: comes to rest, and the motors that were named (also: one more follows) look for their triggers together.
  Flow home_motor(Thread& thread, int motor, bool also);
  /// homez in the program: comes to rest, then the motor's position becomes 0.
  Flow home_zero(Thread& thread, int motor);
  /// Comes to rest and goes on at the next real-time interrupt.
  Flow wait_for_interrupt(Thread& thread);
  /// The same from the program: comes to rest, then it happens.
  Flow change_positions(Thread& thread, const PositionChange& change);

  // --- time ---------------------------------------------------------------------------------------------------------------
  /// Next time at which service() has something to do; kNever if none.
  double next_event_ms() const;
  /// Does everything that is due at time_ms.
  void service(double time_ms);
  /// Motors that follow the pipeline: row i of position_mu gets the samples at these servo ticks.
  bool on_path() const { return on_path_; }
  void sample(std::span<const double> time_ms, std::span<double> position_mu);
  /// The motors have followed the first kept of the samples that sample() gave for these ticks. rows: [motors of used][kept], from home.
  void follow_samples(std::span<const double> time_ms, int kept, const std::vector<int>& used, std::span<const double> rows_mu);

  // --- a free run (free_run.h) ------------------------------------------------------------------------------------------------
  /// service() has nothing to do, now or later, until somebody asks for something.
  bool sleeps() const;
  /// A program runs along its path, and all that service() will do is to calculate on: nothing that has to know where the motors are.
  bool runs_along() const;
  /// While samples are left out up to a last one at time_ms: what is stored of the path is what it would be with them.
  void pass_samples(double time_ms);
  /// Positions of at least so many ms behind the place of motion stay known without samples, or none are stored.
  bool may_pass_samples(double left_out_ms) const;
  /// Plain lines one after the other, while nobody else runs (line_run.cpp). begin_lines(): true where the program stands before such lines;
  /// then service_lines() takes the place of service() until it answers false or end_lines() is called.
  bool begin_lines();
  bool service_lines(double time_ms);
  void end_lines();
  /// When a program that runs along calculates on.
  double next_lines_ms() const { return resume_ms_; }
  const std::vector<int>& path_motors() const { return path_map_.motors; }
  /// The line whose move, dwell or wait executes at the present time.
  bytecode::SourceLine executing_source(double time_ms) const;
  /// Reports the moves that have begun and whose end is still to come: with the end that is planned where they go_on, else with time_ms.
  void report_unfinished(double time_ms, bool go_on);

  // --- positions -----------------------------------------------------------------------------------------------------------
  /// pmatch: axis positions from the motors' commanded positions. Answers a refusal or empty.
  std::string match_positions(double time_ms);
  /// pmatch, pset, pclr, pstore, pload while no program runs. Answers a refusal or empty.
  std::string change_positions(double time_ms, const PositionChange& change);
  /// For a query: axes of which the forward routine answers nan are nan. Where it has no solution all its axes are, and why says it.
  bool axes_from_motors(std::span<const double> motor_mu, AxisVector& axis_uu, std::string* why = nullptr);
  /// Positions of served_motors(), through the inverse routine where there is one. rates: with the axes' velocities for the motors'
  /// (KinVelEna), for pvt moves without segmentation.
  std::optional<Fault> motors_from_axes(const AxisVector& axis_uu, double* motor_mu, bytecode::SourceLine source,
                                        const motion::RoutineRates* rates = nullptr);
  /// There is a forward routine, or a robot.
  bool has_forward() const { return forward || robot.robot; }
  std::vector<int> served_motors() { return motor_map().motors; }
  std::uint32_t axes_with_motors() const { return map_.linear_axes() | forward_axes_; }
  /// Program coordinates: end of the last calculated move, and where the motors are commanded to be now.
  const AxisVector& calculated_position() const { return program_uu_; }
  AxisVector commanded_position(double time_ms);
  /// Where the motors are, and how far from where they are commanded to be.
  AxisVector actual_position(double time_ms);
  AxisVector following_error_uu(double time_ms);
  /// In axis units per ms, from the motors' velocities; through a forward routine that sets no KinVelAxis as a difference over one
  /// servo cycle.
  AxisVector commanded_velocity_uu_ms(double time_ms);
  void observe(motion::StageObservers observers);
  const motion::StageObservers& observers() const { return observers_; }

 private:
  enum class Shaping { kNone, kSlower, kFaster, kBack };
  enum class Phase { kIdle, kCalculating, kToRest, kDwelling, kRapid, kHoming, kSettling, kPaused };
  enum class AfterRest { kDwell, kRapid, kHome, kHomeZero, kPositions, kNextInterrupt, kSettle, kPause, kEnd, kLimit };

  // control.cpp
  std::string start(double time_ms);
  std::string start_at(const ProgramHandle& program, std::int64_t label, double time_ms);

  // rotary.cpp
  std::string start_rotary(double time_ms);
  bool goes_on_in_rotary();
  bool rotary_ends_here();
  std::string why_not_ready(bool at_rest) const;
  std::string go_on_after_pause(double time_ms, bool one_step);
  void pause_here(double time_ms);
  void note_pause(double time_ms);
  void drop_program();
  void clock_changed(double time_ms);
  std::string slope_of(bytecode::ElementId slew, double& slope_per_ms) const;

  // quick_stop.cpp
  void begin_shaping(Shaping shaping);
  bool keeps_limits(double path_ms, double step_ms);
  double step_toward(double path_ms, double last_ms, double wanted_ms);
  double step_by_slew(double last_ms, double wanted_ms) const;
  void shape_rate(double time_ms);
  void run_step(double time_ms, double step_ms);
  void end_shaping(double time_ms);
  double wanted_step_ms(double path_ms) const;

  // retrace.cpp
  double path_position(double time_ms) const;
  void forget_retrace();
  double history_wanted_ms() const;
  double stored_ms() const;

  // program.cpp
  void calculate(double time_ms);
  void go_on(double time_ms);
  double motors_end_ms() const;
  int commands_wanted() const;
  bool enough_ahead(double time_ms) const;
  double next_calculation_ms(double time_ms) const;
  std::optional<Fault> come_to_rest(double time_ms, AfterRest then);
  void at_rest(double time_ms);
  void settle_path(double time_ms);
  void finish_program();
  Flow end_block(Thread& thread);
  Flow execute_block(Thread& thread, const OpenBlock& block);
  std::optional<Fault> set_parameter(bytecode::MotionParameter parameter, double value, bytecode::SourceLine source);
  std::optional<Fault> place(motion::MotionCommand& command);
  std::optional<Fault> compensate(motion::MotionCommand& command, const AxisVector& start_uu);
  std::optional<Fault> flush_compensation();
  std::optional<Fault> add_compensated();
  std::optional<Fault> add_to_path(motion::MotionCommand& command);
  void end_compensation() { compensation_.cancel(); modal.compensation_side = 0; }
  std::optional<Fault> hand_on(motion::MotionCommand& command, const AxisVector& start_uu);
  std::optional<Fault> add_to_spline(const motion::MotionCommand& command, const AxisVector& start_uu);
  std::optional<Fault> add_spline_moves();
  std::optional<Fault> finish_spline();
  std::optional<Fault> pvt_has_ended(bytecode::SourceLine source) const;
  bool pvt_goes_on() const { return pvt_goes_on_; }
  bool pauses_here() const { return (pause_at_rest_ || (stepping_ && !step_block_)) && !pvt_goes_on(); }
  std::optional<Fault> refuse_while_compensating(std::string_view what, bytecode::SourceLine source) const;
  Flow start_blendable(Thread& thread, motion::MotionCommand& command);
  std::optional<Fault> add_blendable(motion::MotionCommand& command);
  Flow stop_item(Thread& thread, AfterRest then);
  Flow give_up(Thread& thread, Fault fault);
  void ensure_sequence(double time_ms);
  void start_dwell(double time_ms);
  void start_rapid(double time_ms);
  std::optional<Fault> rapid_move(const ModalState& modes, const OpenBlock& block, bytecode::SourceLine source, RapidMove& move);
  std::optional<Fault> move_rapid(double time_ms, const RapidMove& move);
  std::optional<Fault> rapid_parameters(double time_ms, const RapidMove& move, const motion::MotorMap& map, std::span<const double> target_mu,
                                        std::vector<motion::JogParameters>& parameters) const;
  void report_rapid(double time_ms);
  std::vector<motion::GoverningShare> rapid_governed() const;
  void start_homing(double time_ms);
  void motors_arrived(double time_ms);
  void collect_timings();
  void perform_due(double time_ms);
  void perform_up_to(std::uint64_t move_id);
  void record(const MoveRecord& move);
  void record_executed(double time_ms);
  motion::PipelineConfig config();
  motion::MotorMap motor_map();

  // line_run.cpp
  bool lines_are_plain() const;
  bool add_row();
  void record_lines(double time_ms);
  void collect_lines();

  // in_position.cpp
  bool waits_in_position() const;
  bool holds_back(const motion::MotionCommand& command);
  void settle(double time_ms, double dwell_ms);
  void go_on_settled(double time_ms);
  std::string who_is_out_of_position();

  // offsets.cpp
  std::optional<Fault> select_transform(double number, bytecode::SourceLine source);
  std::string rename_position();

  // position_limits.cpp
  bool has_position_limits() const;
  std::optional<Fault> check_targets(const AxisVector& target_uu, bytecode::SourceLine source);
  std::optional<Fault> limit_target(int motor, double& target_mu, bytecode::SourceLine source) const;
  void stop_at_limit(double time_ms, Fault fault);
  void stopped_at_limit(double time_ms);
  void hold_at_limits(std::span<double> position_mu) const;

  // positions.cpp
  AxisVector axes_at(double time_ms, bool actual);
  std::string why_no_kinematics() const;
  std::optional<AxisVector> routine_velocity_uu_ms(double time_ms);

  // kinematic_routines.cpp
  enum class Caller { kProgram, kQuery };
  std::optional<Fault> solve_inverse(const AxisVector& axis_uu, std::span<double> motor_mu, bytecode::SourceLine source,
                                     const motion::RoutineRates* rates, std::span<double> rate_mu);
  std::string inverse_routine(const AxisVector& axis_uu, std::span<double> motor_mu, const AxisVector* rate_uu, std::span<double> rate_mu);
  std::string robot_inverse(const AxisVector& axis_uu, std::span<double> motor_mu, const AxisVector* rate_uu, std::span<double> rate_mu);
  std::string solve_forward(std::span<const double> motor_mu, AxisVector& axis_uu, Caller caller);
  std::string forward_routine(std::span<const double> motor_mu, AxisVector& axis_uu, Caller caller);
  std::string robot_forward(std::span<const double> motor_mu, AxisVector& axis_uu, Caller caller);
  bool forward_rates(std::span<const double> motor_mu, std::span<const double> motor_mu_ms, AxisVector& velocity_uu_ms);
  std::string run_routine(Caller caller);
  std::string robot_does_not_fit() const;

  Machine::State& machine_;
  int number_;
  std::vector<kinematics::MotorDefinition> definitions_;
  kinematics::AxisMap map_;
  std::vector<int> motors_;
  std::uint32_t forward_axes_ = 0;
  std::vector<double> near_joint_;        // of robot: the last ones on the path, which say its branch
  Runner runner_, kinematics_;
  ProgramHandle pointed_;
  Stand aborted_;
  std::int64_t pointed_label_ = -1;
  enum class RotaryState { kNone, kExecutes, kWaits };  // kWaits: all lines are done, the next ones start at once
  std::deque<ProgramHandle> rotary_;                    // lines as they were appended; the first ones execute
  bool rotary_pointed_ = false;                         // b0
  RotaryState rotary_state_ = RotaryState::kNone;

  Phase phase_ = Phase::kIdle;
  AfterRest after_rest_ = AfterRest::kEnd;
  double resume_ms_ = kNever;       // when service() acts
  bool stop_requested_ = false, pause_requested_ = false;
  std::optional<Fault> limit_fault_;  // the path ends at a software limit
  bool at_limit_ = false;             // and has come there: it may be retraced, and only abort ends it
  bool stepping_ = false;           // pauses after one item
  bool step_block_ = false;         // between bstart and bstop
  bool pause_at_rest_ = false;      // pauses after the next pvt move that ends at rest
  std::vector<double> paused_mu_;   // [motors_]
  TimeBase time_base_;
  Shaping shaping_ = Shaping::kNone;      // quick stop, or going on after it
  bool quick_stopped_ = false;
  double shape_at_ms_ = kNever;           // next servo tick of it
  double before_path_ms_ = 0;             // path position at the last shaped tick
  std::vector<double> before_mu_, here_mu_, there_mu_;   // [path motor] at the tick before, at this one, at one that is tried
  bool shaped_by_slew_ = false;           // feed hold while retracing, and retracing without lookahead
  double back_ms_ = 0, back_from_ms_ = 0, back_rate_ = 0;  // path position less the clock's, at a time; its rate
  double retrace_to_ms_ = 0;              // path position at which retracing begins to stop

  motion::Pipeline pipeline_;
  motion::MotorMap path_map_;
  motion::StageObservers observers_;
  bool on_path_ = false, lookahead_ = false;
  double sequence_start_ms_ = 0;
  double history_ms_ = 0;              // programmed time behind motion that stays known, for retracing
  double calculated_at_ms_ = -kNever;  // last calculation pass
  int moves_without_time_ = 0;
  ProgramFrame frame_;
  AxisVector program_uu_{};     // end of the last calculated move in program coordinates
  AxisVector placed_uu_{};      // program coordinates of the pipeline's calculated position
  AxisVector calculated_uu_{};  // the pipeline's, in the coordinates of the axis definitions
  PositionChange position_change_{};
  motion::CutterCompensation compensation_;
  std::vector<motion::MotionCommand> compensated_;
  motion::Spline spline_;
  std::vector<motion::MotionCommand> spline_moves_;
  AxisVector pvt_velocity_uu_ms_{};   // at the end of the last pvt move, program coordinates
  bool pvt_goes_on_ = false;          // some of it is not 0
  OpenBlock block_;
  double dwell_ms_ = 0;
  std::optional<motion::MotionCommand> held_back_;  // waits until the motors are in position
  double settle_until_ms_ = 0, settled_dwell_ms_ = 0;
  std::vector<int> home_motors_;
  int home_motor_ = -1;
  bytecode::SourceLine item_source_;
  RapidMove rapid_;
  double item_start_ms_ = 0, rapid_start_ms_ = 0, rapid_length_uu_ = 0;
  bool rapid_open_ = false;         // its motors move; reported when they have come to rest

  /// A run of plain lines. row: the next one.
  struct LineRun {
    motion::LinePath* path = nullptr;
    const bytecode::MoveRun* run = nullptr;
    std::size_t first_row = 0, row = 0;
    std::string_view mode;
    struct Ended { std::uint64_t id; double start_ms, end_ms, length_uu; motion::TimeRule rule; bytecode::SourceLine source; };
    motion::Ring<Ended> ended;      // planned in full; reported when they end
  };
  LineRun lines_;
  int lines_wait_ = 0;              // events before the next one is tried

  std::uint64_t next_id_ = 1;
  struct PendingMove { std::uint64_t id; std::string_view mode; bytecode::SourceLine source; };
  motion::Ring<PendingMove> pending_moves_;
  std::vector<motion::MoveTiming> timings_;
  struct ExecutedMove { motion::MoveTiming timing; std::string_view mode; bytecode::SourceLine source; };
  motion::Ring<ExecutedMove> executed_;  // planned in full; reported when they end
  std::vector<double> sample_run_, path_times_ms_;   // of samples, kept so that a block costs no allocation
  std::deque<SyncEntry> sync_;
  std::vector<motion::SyncTime> sync_times_;
  std::deque<motion::SyncTime> due_;   // ascending
};

}  // namespace pmac::runtime
