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
// Motion stops (x = 0) where the direction changes at once: at corners that are not blended, and at the ends of a sequence
// without ramps. A step in speed alone is taken up by x. Where the program itself rests, x is free. Method: Pham and Pham, "A new approach to time-optimal path parameterization based on
// reachability analysis" (2018).
#pragma once

#include <deque>
#include <vector>

#include "runtime/motion/rate_limits.h"

namespace pmac::motion {

class Lookahead {
 public:
  /// limits: [motor]. window: segments that are always known beyond what is committed, >= 1.
  Lookahead(std::vector<MotorLimits> limits, int window);

  /// The next segment; appends those that are now committed. Amortised constant cost.
  void add(Segment segment, std::vector<TimedSegment>& out);
  /// The path ends here: commits everything. The next segment begins a new path.
  void finish(std::vector<TimedSegment>& out);

  /// Segments that are not yet committed.
  int waiting() const { return static_cast<int>(intervals_.size()); }
  /// As many as it takes before anything is committed.
  int needed() const { return window_ + chunk_; }

 private:
  struct Interval {
    Segment segment;
    double scale;               // x counts in units of 1/scale^2
    RateLimits limits;
    double start_bound = 1;     // of x at its start: limits of both neighbours, 0 where motion has to stop
    double beta = 0;            // of x at its start
  };
  double scale_of(const Segment& segment) const;
  void split_last();
  void backward(double end_beta);
  void commit(int count, double end_beta, std::vector<TimedSegment>& out);
  bool emit_with_switch(const Interval& interval, double x0, double x1, std::vector<TimedSegment>& out) const;
  double start_bound(const RateLimits& limits, double scale) const;

  std::vector<MotorLimits> limits_;
  int window_, chunk_;
  std::deque<Interval> intervals_;
  int planned_ = 0;             // intervals whose beta comes from an earlier backward pass
  double rate2_ = 0;            // x at the start of the first interval
  bool at_start_ = true;
};

}  // namespace pmac::motion
