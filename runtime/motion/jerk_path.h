// The path as the jerk-limiting lookahead sees it: over its own length sigma (in the space of the motors, mu), not over programmed time.
// Straight lines then have no second derivative, however the program ramps along them, and the program is a ceiling of the speed:
//
//   v <= |dq/ds|   (never ahead of the program: at rate 1 this is its own speed)
//
// Cells are short enough that the derivatives of the motors' positions change evenly over one. A cell may end in a stop: where the program
// rests, and where the path turns too sharply to be run through.
#pragma once

#include <deque>
#include <vector>

#include "runtime/motion/velocity_steps.h"

namespace pmac::motion {

/// A place on the path: dq/dsigma and its derivative of every motor, and squares of speeds there.
struct PathPlace {
  std::vector<double> tangent;        // [motor]
  std::vector<double> curvature_mu;   // [motor] 1/mu
  double max_speed2 = 0;              // mu^2/ms^2: the program's and the motors' limits of speed
  double steady_speed2 = 0;           // about the highest that the other limits leave as well
  bool rests = false;                 // of the program: the derivatives are those a little away
};

struct PathCell {
  double length_mu = 0;               // along the path
  double from_ms = 0, to_ms = 0;      // programmed time in the segment
  std::size_t segment = 0;            // number, from the start of the path on
  PathPlace start, end;
  bool is_straight = false;
  double inv_accel_ms2_mu = 0, inv_jerk_ms3_mu = 0;   // of the tightest motor along the tangents; 0: off
  /// Small steps of acceleration there that jerk is reserved for: over the jerk limit times a servo period, and over the square of the speed.
  double start_step_mu2 = 0, end_step_mu2 = 0;   // ms^2/mu^2
  double accel_share = 1;             // part of the acceleration limits that may be used: steps in direction take the rest
  bool stops = false;                 // motion comes to rest at its end
};

/// The largest small step, over the jerk limit times a servo period.
inline constexpr double kMostReservedStep = 0.6;
/// Part of the jerk limit that a small step of acceleration leaves: in one third difference of samples much of it is felt.
inline double jerk_share_beside(double step) { return 1 - 0.75 * (step < kMostReservedStep ? step : kMostReservedStep); }

class JerkPath {
 public:
  /// Bends so small that running through them cannot be seen at servo rate are places to stop at.
  JerkPath(std::vector<MotorLimits> limits, double servo_period_ms);

  void clear();
  /// False where the segment does not move: then nothing is added but a stop.
  bool add(PreparedSegment prepared);
  void stop_here();
  /// Forgets the cells before this one, and segments that no cell needs.
  void forget_before(std::size_t cell);

  bool empty() const { return cells_.empty(); }
  std::size_t first_cell() const { return first_cell_; }
  std::size_t cell_end() const { return first_cell_ + cells_.size(); }
  const PathCell& cell(std::size_t i) const { return cells_[i - first_cell_]; }
  const Segment& segment(std::size_t i) const { return segments_[i - first_segment_]; }
  const std::vector<MotorLimits>& limits() const { return limits_; }

  /// Programmed time in its segment of a place so far from the start of the cell. Exact to rounding.
  double programmed_ms(std::size_t cell, double offset_mu) const;

 private:
  PathPlace place(const Segment& segment, double at_ms, double toward_ms, double share) const;
  void judge(PathCell& cell) const;
  void reserve_for_step(PathCell& before, PathCell& cell) const;
  bool bends_unevenly(const PathPlace& from, const PathPlace& middle, const PathPlace& to, double length_mu) const;
  void add_cells(const Segment& segment, double from_ms, double to_ms, double share, double start_speed2, int halvings);
  void add_cell(const Segment& segment, double from_ms, double to_ms, double share, double start_speed2);
  std::vector<MotorLimits> limits_;
  double servo_period_ms_;
  double unfelt_mu_ = 0, unfelt_mu_ms_ = 0;   // length and speed that cannot be seen at servo rate
  std::deque<PathCell> cells_;
  std::deque<Segment> segments_;
  std::size_t first_cell_ = 0, first_segment_ = 0;
};

}  // namespace pmac::motion
