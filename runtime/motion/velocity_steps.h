// Where the velocity of the path steps - at corners without a blend, at changes of feed rate without a ramp - the lookahead has
// three answers, decided here before it plans:
//
//   the speed alone steps         the rate of programmed time steps the other way, motion goes on evenly
//   the direction steps a little  sampled every servo period h the step is an acceleration of up to |dv|/h; the rate is kept so
//                                 low that this takes a part of the limit, and the rest is left for the motion around it
//   the direction steps a lot     motion stops
//
// Polylines of short blocks without ramps are the second kind. A second difference of the samples at t weighs a step at t_k
// with max(0, 1 - |t_k - t|/h), and t_k - t is at least the programmed time between them divided by the rate r. So the steps
// take, at the worst t,
//
//      max over t of  sum_k |dv_k| max(0, r - |s_k - s|/h) / h        which grows with r; r is made to fit
//
// Segments are held back until the steps shortly after them are known.
#pragma once

#include <limits>
#include <vector>

#include "runtime/motion/ring.h"
#include "runtime/motion/segment.h"

namespace pmac::motion {

struct PreparedSegment {
  Segment segment;
  bool stops_at_start = false;      // the rate is zero at its start
  double speed_ratio = 1;           // speed at its start to speed at the end of the one before, at equal rates
  double max_start_rate = std::numeric_limits<double>::infinity();
  double accel_share = 1;           // part of the acceleration limits that this segment may use
};

class VelocitySteps {
 public:
  /// servo_period_ms 0: every step in direction is a stop.
  VelocitySteps(std::vector<MotorLimits> limits, double servo_period_ms);

  void add(Segment segment, std::vector<PreparedSegment>& out);
  /// The path ends here; the next segment begins a new one.
  void finish(std::vector<PreparedSegment>& out);

 private:
  struct Step {
    double place_ms = 0;                   // programmed time
    Row<double> change_mu_ms;             // [motor], absolute, at full rate
    double own_rate = 0;                  // allowed with the steps around it
    bool is_gentle = false;
  };
  struct Ends { double start_speed, end_speed; bool moves_at_start, moves_at_end; };
  static Ends ends_of(const Segment& segment);
  void compare(const Segment& before, const Ends& before_ends, PreparedSegment& after, const Ends& after_ends);
  void decide_steps(double known_ms);
  double rate_that_fits(std::size_t at) const;
  double share_taken(std::size_t motor, std::size_t at, double rate) const;
  double lowest_rate_near(std::size_t at) const;
  void release(double known_ms, std::vector<PreparedSegment>& out);
  void hand_on(PreparedSegment whole, std::vector<PreparedSegment>& out) const;
  bool has_gentle_step(double from_ms, double to_ms) const;
  PreparedSegment* starting_at(double place_ms);

  std::vector<MotorLimits> limits_;
  double period_ms_;
  Ring<PreparedSegment> held_;
  Ends last_ends_{};                      // of the newest
  Ring<Step> steps_;                      // of the held segments and shortly before
  std::size_t rated_ = 0, decided_ = 0;   // steps_ before these have a rate, are decided
};

/// The motors do not stand still at the start (at_end false) or end of the segment at full rate.
bool is_moving(const Segment& segment, bool at_end);

}  // namespace pmac::motion
