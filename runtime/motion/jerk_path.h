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

/// A place on the path: dq/dsigma and its derivative of every motor, and the square of the highest speed there.
struct PathPlace {
  std::vector<double> tangent;        // [motor]
  std::vector<double> curvature_mu;   // [motor] 1/mu
  double max_speed2 = 0;              // mu^2/ms^2
};

struct PathCell {
  double from_mu = 0, length_mu = 0;  // along the path
  double from_ms = 0, to_ms = 0;      // programmed time in the segment
  std::size_t segment = 0;            // number, from the start of the path on
  PathPlace start, end;
  std::vector<double> curvature_rate; // [motor] 1/mu^2
  double accel_share = 1;             // part of the acceleration limits that may be used: steps in direction take the rest
  bool stops = false;                 // motion comes to rest at its end
  double end_mu() const { return from_mu + length_mu; }
};

/// Where something is: a cell, and the length along the path.
struct CellPoint { std::size_t cell = 0; double at_mu = 0; };

class JerkPath {
 public:
  /// Sharper bends than a speed can make felt at servo rate are not told from a bend that sharp.
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

  /// Programmed time in its segment of a place in the cell. Exact to rounding.
  double programmed_ms(std::size_t cell, double at_mu) const;

 private:
  PathPlace place(const Segment& segment, double at_ms, double toward_ms, double share) const;
  void add_cells(const Segment& segment, double from_ms, double to_ms, double share, double start_speed2, int halvings);
  void add_cell(const Segment& segment, double from_ms, double to_ms, double share, double start_speed2);
  std::vector<MotorLimits> limits_;
  double sharpest_mu_ = 1e300, sharpest_rate_ = 1e300;   // of curvature, 1/mu, and of its rate, 1/mu^2
  std::deque<PathCell> cells_;
  std::deque<Segment> segments_;
  std::size_t first_cell_ = 0, first_segment_ = 0;
  double end_mu_ = 0;
};

}  // namespace pmac::motion
