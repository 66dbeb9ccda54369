// A plan for the known path up to where motion comes to rest: at the next stop, or where the known path ends. It is divided into cells of
// about equal time, and the fastest profile through them is solved for (jerk_profile.h); cells in which the acceleration turns out to change
// much are divided, and it is solved again. When more of the path is known, what is not yet
// executed is planned anew; the new plan counts only if it keeps all limits, else the old one is followed, which ends at rest. From rest
// there is always a plan: any profile, made slow enough.
#pragma once

#include <vector>

#include "runtime/motion/jerk_path.h"
#include "runtime/motion/jerk_profile.h"

namespace pmac::motion {

/// Where motion is: in a cell of the path, so far from its start. slope: change of the square of the speed over length.
struct PathState {
  std::size_t cell = 0;
  double offset_mu = 0, speed2 = 0, slope = 0;
};

/// One cell of the plan, all of it in one cell of the path.
struct PlannedCell {
  std::size_t cell = 0;
  double from_mu = 0, to_mu = 0;
};

class JerkPlan {
 public:
  /// The path outlives the plan.
  JerkPlan(const JerkPath& path, double servo_period_ms);

  /// Motion rests at the beginning of this cell.
  void start_at(std::size_t cell);
  /// Plans from the present state on, with all of the path that is known.
  void renew();
  bool is_done() const { return next_ + 1 >= profile_.nodes(); }
  /// The plan ends at a stop of the path: no more can be gained by knowing more.
  bool ends_at_stop() const;

  /// What lies further ahead has no effect on the present motion.
  double felt_ms() const { return felt_ms_; }

  const PathState& state() const { return state_; }
  const PlannedCell& next_cell() const { return cells_[next_]; }
  /// Goes through the next cell.
  CellMotion advance();

 private:
  struct Stretch { std::vector<double> speed2, start_mu; double length_mu = 0; };   // [end of a path cell] about the speed, and length before it
  std::size_t end_of_stretch() const;
  void estimate(std::size_t end);
  double estimate_at(std::size_t cell, double offset_mu) const;
  double rest_cell_mu(std::size_t cell, double time_ms) const;
  double finest_step_ms() const;
  std::size_t kept_cells() const;
  void divide(double step_ms, std::size_t kept, std::size_t end);
  void divide_cell(std::size_t cell, double from_mu, bool starts, bool ends, double step_ms);
  void take_felt();
  void guess(std::size_t kept);
  bool solve_refined();
  bool refine();
  bool is_coarse(std::size_t i, double finest_ms) const;
  void make_problem();
  double jerk_share(std::size_t i) const;
  void add_rows(std::size_t i);
  bool accept(bool solved);
  void slow_down();

  const JerkPath& path_;
  double shortest_step_ms_;
  PathState state_;
  std::vector<PlannedCell> cells_, new_cells_;   // of the plan, and of the one that is tried
  std::vector<PlannedCell> parts_;
  std::vector<double> guess_speed2_, part_speed2_;   // [end of a new cell]
  Profile profile_, new_profile_;
  std::size_t next_ = 0;
  double felt_ms_ = 1e300;
  std::size_t first_ = 0;             // cell of the path in which the stretch starts
  Stretch stretch_;
  ProfileProblem problem_;
  ProfileSolver solver_;
};

}  // namespace pmac::motion
