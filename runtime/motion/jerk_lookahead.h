// Hop 8 with limited jerk: the same path, run through so that every motor keeps its limits of speed, acceleration and jerk. Straight lines
// are run in the seven phases that are fastest; on curves the path's own jerk is taken from the limit first. Where the path's curvature
// steps (a line meets an arc without a ramp) no motion but a stop could limit the jerk: the acceleration limit is kept, and the step is noted
// in the timed segment (jerk_step). How it is planned: jerk_plan.h.
#pragma once

#include <deque>
#include <vector>

#include "runtime/motion/jerk_plan.h"
#include "runtime/motion/time_law.h"

namespace pmac::motion {

class JerkLookahead : public TimeLaw {
 public:
  /// As Lookahead (lookahead.h).
  JerkLookahead(std::vector<MotorLimits> limits, double window_ms, double servo_period_ms);

  void add(Segment segment, std::vector<TimedSegment>& out) override;
  void finish(std::vector<TimedSegment>& out) override;

  double planned_ms() const override { return known_ms_ - reached_ms_; }
  double needed_ms() const override { return window_ms_ + chunk_ms_; }
  double window_ms() const override { return window_ms_; }

 private:
  struct Rest { std::size_t cell; Segment segment; };   // stands there for the segment's time, before the cell begins
  void take(PreparedSegment prepared, std::vector<TimedSegment>& out);
  bool go_on(std::vector<TimedSegment>& out);
  bool pass_by_rest(std::vector<TimedSegment>& out);
  bool enter_next_cell(std::vector<TimedSegment>& out);
  void adapt_step();
  void emit(const PathState& from, const JerkStep& step, const PathState& to, std::vector<TimedSegment>& out);
  void emit_part(std::size_t cell, double from_mu, double to_mu, double speed_from, double speed_to, double duration_ms,
                 std::vector<TimedSegment>& out);
  void note_step(std::size_t before, std::size_t after, double speed, TimedSegment& segment) const;
  bool at_stop() const;

  double window_ms_, chunk_ms_, servo_period_ms_, longest_step_ms_;
  VelocitySteps steps_;
  std::vector<PreparedSegment> prepared_;
  JerkPath path_;
  JerkPlan plan_;
  PathState state_;
  std::deque<Rest> rests_;
  bool entered_ = false;              // state_ lies in a cell
  double known_ms_ = 0, reached_ms_ = 0;
  double carry_ms_ = 0;               // time of parts that are too short to be segments of their own
  std::size_t step_cell_ = 0;         // the last cell that parts were emitted of
  bool has_emitted_ = false;
  int steps_in_cell_ = 0;
};

}  // namespace pmac::motion
