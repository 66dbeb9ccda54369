// Hop 8: the same path, times stretched until every motor limit holds. Time-optimal path parametrisation: x = (ds/dt)^2 over
// programmed time s is a quadratic polynomial between the nodes, never above 1, and as large as the limits allow (rate_limits.h).
// A backward pass over the known segments gives the largest x at each node from which motion can still stop (beta); a forward
// pass then takes the largest reachable x below it.
//
//    x |    beta ____            the window ends in a stop that is always possible;
//      |   ..../     \___        what is committed never depends on segments that are not yet known
//      |  /x..........   \.
//      | /                 \ 0
//      +---------------------- s
//       committed | window
//
// Where motors run straight at a constant programmed speed x may rise, stay and fall within one segment, however long that is. Where the
// path's velocity steps, velocity_steps.h has said what to do. Where the program itself rests, x is free. Method: Pham and Pham, "A new
// approach to time-optimal path parameterization based on reachability analysis" (2018).
#pragma once

#include <vector>

#include "runtime/motion/ring.h"
#include "runtime/motion/segment_division.h"
#include "runtime/motion/time_law.h"
#include "runtime/motion/velocity_steps.h"

namespace pmac::motion {

class Lookahead : public TimeLaw {
 public:
  /// limits: [motor]. window_ms: programmed time that is always known beyond what is committed (LHDistance * SegMoveTime; in
  /// time, because nodes at corners and in arcs make some segments shorter).
  Lookahead(std::vector<MotorLimits> limits, double window_ms, double servo_period_ms);

  void add(Segment segment, std::vector<TimedSegment>& out) override;
  void finish(std::vector<TimedSegment>& out) override;

  double planned_ms() const override { return known_ms_; }
  double needed_ms() const override { return window_ms_ + chunk_ms_; }
  double window_ms() const override { return window_ms_; }

 private:
  /// A segment of which parts are still to be committed.
  struct Whole {
    Segment segment;
    double accel_share = 1;
    int parts = 0;              // not yet committed
  };
  /// A part of a segment, as far as planning needs it: its motion is made of the segment when it is committed.
  struct Interval {
    std::uint64_t whole = 0;    // its segment, counted from the first
    Stretch stretch{0, 0};      // of its segment
    double speed_ratio2 = 1;    // x at the end of the interval before is this times x at its start
    double start_bound = 1;     // of x at its start: limits of both neighbours, 0 where motion has to stop
    RateCourse last;            // beta at its start, and how motion slows down from there
    RateLimits limits;
  };
  struct Start { double speed_ratio, max_rate; bool stops; };   // of a segment
  int known() const { return static_cast<int>(intervals_.size()); }
  Whole& whole_of(const Interval& interval) { return wholes_[interval.whole - first_whole_]; }
  const Whole& whole_of(const Interval& interval) const { return wholes_[interval.whole - first_whole_]; }
  void append(PreparedSegment prepared);
  Interval& append_interval(const Stretch& stretch, const Start& start);
  void bound_start(Interval& interval, const Start& start);
  void find_limits(Interval& interval) const;
  double end_beta_of(int i, double end_beta) const;
  void rest(Segment segment, std::vector<TimedSegment>& out);
  void end_path(std::vector<TimedSegment>& out);
  void split_last();
  void backward(double end_beta);
  void commit_first(double end_beta, std::vector<TimedSegment>& out);
  void emit(const Interval& interval, const RateCourse& course, bool may_switch, std::vector<TimedSegment>& out);
  void emit_even(const Interval& interval, double x0, double x1, std::vector<TimedSegment>& out) const;
  bool emit_with_switch(const Interval& interval, double x0, double x1, std::vector<TimedSegment>& out);
  void emit_part(const Interval& interval, const Stretch& stretch, const RateCourse& course, std::vector<TimedSegment>& out) const;

  std::vector<MotorLimits> limits_;
  double window_ms_, chunk_ms_;
  VelocitySteps steps_;
  std::vector<PreparedSegment> prepared_;
  Division division_;
  Ring<Whole> wholes_;
  std::uint64_t first_whole_ = 0;
  Ring<Interval> intervals_;
  RateLimits first_limits_, second_limits_;   // of the parts that emit_with_switch() tries
  double known_ms_ = 0;         // their programmed time
  int planned_ = 0;             // intervals whose beta comes from an earlier backward pass
  double rate2_ = 0;            // x at the start of the first interval
  RateCourse last_course_;      // the latest that was committed
  bool at_start_ = true;
};

}  // namespace pmac::motion
