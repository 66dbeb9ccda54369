// Hop 8: the same path, times stretched until every motor limit holds. Time-optimal path parametrisation: x = (ds/dt)^2 over
// programmed time s is piecewise linear between the segments' ends, never above 1, and as large as the limits allow.
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
// Where the path's velocity steps, velocity_steps.h has said what to do. Where the program itself rests, x is free. Method: Pham and Pham, "A new approach to time-optimal path parameterization based on
// reachability analysis" (2018).
#pragma once

#include <vector>

#include "runtime/motion/rate_limits.h"
#include "runtime/motion/ring.h"
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
  struct Interval {
    Segment segment;
    double accel_share = 1;
    RateLimits limits;
    double speed_ratio2 = 1;    // x at the end of the interval before is this times x at its start
    double start_bound = 1;     // of x at its start: limits of both neighbours, 0 where motion has to stop
    double beta = 0;            // of x at its start
    bool may_be_divided = false;
  };
  int known() const { return static_cast<int>(intervals_.size()); }
  void append(PreparedSegment prepared);
  void append_part(PreparedSegment prepared, RateLimits limits, bool may_be_divided);
  void divide_interval(const Interval& whole, std::vector<Interval>& parts);
  bool is_slowed(int i, double end_beta) const;
  void plan(double end_beta);
  void divide_first(double end_beta);
  void push(Interval interval);
  void rest(Segment segment, std::vector<TimedSegment>& out);
  void end_path(std::vector<TimedSegment>& out);
  void split_last();
  void backward(double end_beta);
  void commit_first(double end_beta, std::vector<TimedSegment>& out);
  bool emit_with_switch(const Interval& interval, double x0, double x1, std::vector<TimedSegment>& out) const;

  std::vector<MotorLimits> limits_;
  double window_ms_, chunk_ms_;
  VelocitySteps steps_;
  std::vector<PreparedSegment> prepared_;
  std::vector<double> part_ends_ms_;
  Ring<Interval> intervals_;
  std::vector<Interval> taken_out_;
  double known_ms_ = 0;         // their programmed time
  int planned_ = 0;             // intervals whose beta comes from an earlier backward pass
  double rate2_ = 0;            // x at the start of the first interval
  bool at_start_ = true;
};

}  // namespace pmac::motion
