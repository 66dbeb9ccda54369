// The way into the trajectory runtime: one coordinate system's hops 5 to 9. The owner adds motion commands as the program
// calculates them and ends the sequence where motion has to stop; the pipeline blends, segments, maps to motors, plans
// times and answers motor positions at any time up to its horizon. It streams: memory is bounded by the lookahead window,
// never by the length of the program.
//
//   add() -> planner (path pieces, axis space) -> segmenter (motor space) -> lookahead (time) -> sample()
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "runtime/motion/types.h"

namespace pmac::motion {

class LinePath;
struct PathPiece;
struct Segment;
struct TimedSegment;

/// Called with each record as its stage finishes it, for --emit=path|segments|lookahead. Any may be empty.
struct StageObservers {
  std::function<void(const PathPiece&)> path;
  std::function<void(const Segment&)> segment;
  std::function<void(const TimedSegment&)> timed_segment;
};

class Pipeline {
 public:
  Pipeline();
  ~Pipeline();
  Pipeline(Pipeline&&) noexcept;
  Pipeline& operator=(Pipeline&&) noexcept;

  /// Forgets everything and stands at rest at start_uu (motors at start_mu, as the map gives it) at start_time_ms.
  /// Commands added later begin at start_time_ms, or when the sequence before has ended, whichever is later.
  void reset(const PipelineConfig& config, const AxisVector& start_uu, double start_time_ms);

  void observe(StageObservers observers);

  /// Hop 5: the next command. The fault is the command's own (no circle, non-finite target, ...); the pipeline then stands
  /// as before the call. Faults of later stages (kinematics of a segment) come out of add() or end_sequence(); nothing more is
  /// then produced until reset(). With lookahead the motion comes to rest on the path before the place that failed; without, it
  /// ends at horizon_ms() with the velocity that sample() gives there.
  [[nodiscard]] std::optional<runtime::Fault> add(const MotionCommand& command);

  /// Where a corner rule or NoBlend asks for a stop between the last command added and this one: the dwell that a corner rule adds there.
  std::optional<double> stop_by_rule_ms(const MotionCommand& next) const;

  /// The last command added comes to rest with its td and tsd; what follows is a new sequence. Harmless when at rest.
  [[nodiscard]] std::optional<runtime::Fault> end_sequence();

  /// Not before this time: start of the next sequence (a dwell's or rapid move's end). Only at rest, after end_sequence().
  void set_earliest_start(double time_ms);

  /// A rapid move or jog has brought the axes elsewhere. Only at rest.
  void set_position(const AxisVector& position_uu);

  /// How many commands are known beyond the one that executes at time_ms (0: none).
  int commands_ahead(double time_ms) const;
  /// With lookahead: true while less is known beyond time_ms than lookahead_segments times the segment time, and a quarter.
  /// Asked for the next tick, adding while it says so keeps horizon_ms() ahead of that tick.
  bool wants_more_segments(double time_ms) const;

  /// The program need not be calculated on before this time, at which fewer than `commands` commands are known beyond the
  /// executing one, or less than the lookahead window, as far as can be told now. Any time for lack of both: -inf.
  double enough_until_ms(int commands) const;

  /// Everything added is complete and its motion ends at or before time_ms.
  bool at_rest(double time_ms) const;
  /// Positions are final up to here (a sequence that has not been ended may go on beyond). Grows with add() and end_sequence().
  double horizon_ms() const;
  /// End of the motion that has been ended; the time at which the motors come to rest. Valid after end_sequence().
  double end_ms() const;

  /// From here commands that are plain lines, with all but id, source, axes and target as in `like`, can be added to what this answers, until
  /// close_lines(); nothing else may be added meanwhile. Nobody is told when synchronous assignments of these lines are due. nullptr: they are
  /// no such lines (line_path.h), or not now.
  LinePath* open_lines(const MotionCommand& like);
  void close_lines();
  /// Forgets what samples have passed, as add() does.
  void prune();

  /// Motor positions at these times, all from oldest_ms() to horizon_ms(); fastest where they ascend. Each is that of its time alone,
  /// whatever the others. position_mu: [motor][time], motor order of the map. velocity_mu_ms: same shape, or empty. Does not allocate.
  void sample(std::span<const double> time_ms, std::span<double> position_mu, std::span<double> velocity_mu_ms);
  /// The same at one time.
  void sample(double time_ms, std::span<double> position_mu, std::span<double> velocity_mu_ms) { sample({&time_ms, 1}, position_mu, velocity_mu_ms); }
  /// Goes on as if it had been sampled at time_ms; what is known behind it by the history of the set-up can still be sampled.
  void pass(double time_ms);

  /// The same at one time, out of the way of sample().
  void peek(double time_ms, std::span<double> position_mu) const;

  /// Positions are known from here on: the last sample, or what the history of the set-up adds to it.
  double oldest_ms() const;
  /// From here amount_ms of programmed time lead to time_ms; oldest_ms() where less is known.
  double history_start_ms(double time_ms, double amount_ms) const;

  /// Source line of the command that executes at time_ms (as last sampled); SourceLine{} at rest.
  SourceLine executing_source(double time_ms) const;

  /// Axis position that commands have been calculated to (target of the last one).
  const AxisVector& calculated_position() const;

  /// Timings that have become final since the last call, in order of id; then forgets them. Appends to out.
  void take_timings(std::vector<MoveTiming>& out);
  /// The same for the times of synchronous assignments, which are known earlier.
  void take_sync_times(std::vector<SyncTime>& out);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pmac::motion
