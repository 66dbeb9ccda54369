// The fastest speed along a stretch of path, from its start state to rest at its end, in which every motor keeps its limits of speed,
// acceleration and jerk. Over the path's length, with x the square of the speed and y = dx/dlength = 2 * acceleration along the path, a
// motor with the path derivatives T, K, K' accelerates by A, linear in (x, y), and has the jerk
//
//   |K x + T y / 2| <= A
//   |T a' + (3 K y / 2 + K' x) v| <= J    a' = (a_end - a_start) / t, t = length / speed: multiplied by t both sides are linear but for t
//                                         itself, which falls with x; its tangent is below it, so the limit made linear is safe
//
// x over each cell is given by one number c, the crossing of the tangents of x at its two nodes. From node to node
//
//   x |        c1 .___.____          c = x_start + (1 - w) length y_start = x_end - w length y_end
//     |         .  x2   c2           w = 1/2: x is a parabola, the acceleration changes evenly over the length; other w let it change
//     |   __.--x1                    evenly over time. w = 3/4 at a start from rest, where c = 0
//     | c0=0
//
// so that nothing but c is unknown and each condition holds at most three of them. The time is minimised by a primal-dual interior-point
// method with one pentadiagonal system a step, the conditions made linear anew in each. Boyd and Vandenberghe, "Convex Optimization", 11.7;
// Debrouwere et al., "Time-optimal path following for robots with convex-concave constraints using sequential convex programming" (2013).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace pmac::motion {

/// What one motor, or the tightest of all where the path is straight, makes of a cell.
struct ProfileRow {
  double inv_accel = 0, inv_jerk = 0;           // ms^2/mu, ms^3/mu; 0: off
  double start_tangent = 0, start_curvature = 0, middle_tangent = 0, end_tangent = 0, end_curvature = 0, curvature_rate = 0;
  bool is_straight = false;                     // no curvature
};

struct ProfileProblem {
  std::vector<double> length_mu;                // [cell], at least three
  std::vector<char> steps_at_start;             // [cell] the derivatives step from those of the cell before
  std::vector<std::size_t> first_row;           // [cell + 1]
  std::vector<ProfileRow> rows;
  std::vector<double> max_speed2;               // [node], > 0 but at rest
  std::vector<double> middle_speed2;            // [cell] the same half-way
  std::vector<double> guess_speed2;             // [node]
  double start_speed2 = 0, start_slope = 0;     // both 0: from rest
  std::size_t cells() const { return length_mu.size(); }
  void clear();
};

/// At the nodes. y is 0 at rest.
struct Profile {
  std::vector<double> speed2, slope;
  std::size_t nodes() const { return speed2.size(); }
};

/// How much a profile uses of the limits, 1 is all: the most at any node or in any cell.
struct ProfileUse { double speed2 = 0, accel = 0, jerk = 0; };
ProfileUse use_of(const ProfileProblem& problem, const Profile& profile);

/// Motion through one cell: speed is the cubic of time with these speeds and accelerations at its ends.
struct CellMotion {
  double duration_ms = 0, speed = 0, accel = 0, jerk = 0, snap = 0;   // of length at 0, mu/ms ...
  double place(double t) const { return t * (speed + t * (accel / 2 + t * (jerk / 6 + t * snap / 24))); }
  double speed_at(double t) const { return speed + t * (accel + t * (jerk / 2 + t * snap / 6)); }
};
CellMotion motion_through(double length_mu, double x0, double y0, double x1, double y1);

class ProfileSolver {
 public:
  /// gap: how near to the fastest profile, in parts of its time. False where no profile was found.
  bool solve(const ProfileProblem& problem, double gap, Profile& profile);
  /// Nearer to it, from where the last solve() ended; its problem is still there.
  bool go_on(double gap, Profile& profile);

 private:
  void start();
  void take_weights();
  void take_nodes();
  void take_times();
  template <class Visit> void each_condition(Visit visit);
  void assemble(double mu);
  bool factor_and_solve();
  double move(double mu);
  double total_ms() const;

  const ProfileProblem* problem_ = nullptr;
  std::size_t cells_ = 0, count_ = 0;
  double gap_ = 0, unmet_ = 0, mu_ = 0;
  // [cell], shifted by one: c_[i + 1] is of cell i
  std::vector<double> c_, change_;
  std::vector<double> weight_, time_ms_, middle_x_;             // [cell]
  std::vector<double> speed_start_, speed_end_;                 // [cell] speeds at its ends times its time
  std::vector<double> x_, y_, before_, after_;                  // [node]; parts of c before and after the node in x
  std::vector<double> per_slope_;                               // [node] 1 / (e + f)
  std::vector<double> slack_, price_, slack_step_, price_step_; // [condition]
  std::vector<double> d0_, d1_, d2_, r_;                        // the system
};

}  // namespace pmac::motion
