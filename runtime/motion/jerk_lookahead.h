// Hop 8 with limited jerk: the same path, run through as fast as every motor's limits of speed, acceleration and jerk allow. Where the path's
// curvature steps (a line meets an arc without a ramp) no motion but a stop could limit the jerk: the acceleration limit is kept, and the
// step is noted in the timed segment (jerk_step). How it is planned: jerk_plan.h.
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
  bool enter_next_stretch(std::vector<TimedSegment>& out);
  void emit(const PlannedCell& planned, const CellMotion& motion, std::vector<TimedSegment>& out);
  void emit_part(const PlannedCell& part, double speed_from, double speed_to, double duration_ms, std::vector<TimedSegment>& out);
  void note_step(std::size_t before, std::size_t after, double speed, TimedSegment& segment) const;

  double window_ms_, chunk_ms_, servo_period_ms_;
  VelocitySteps steps_;
  std::vector<PreparedSegment> prepared_;
  JerkPath path_;
  JerkPlan plan_;
  std::deque<Rest> rests_;
  bool entered_ = false;              // motion is in a cell
  bool grew_ = false;                 // more of the path is known than the plan knows
  double known_ms_ = 0, reached_ms_ = 0;
  double carry_ms_ = 0;               // time of parts that are too short to be segments of their own
  std::size_t step_cell_ = 0;         // the last cell that parts were emitted of
  bool has_emitted_ = false;
};

}  // namespace pmac::motion
