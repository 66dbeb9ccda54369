// Motion along the path with limited jerk, in steps of constant change of acceleration. From every state that is taken a stop is known (the
// braking plan) that keeps all limits and ends inside the known path; so there is always a way to go on.
//
//    j  ^ +J ____                          one step: the largest j after which
//       |        |____                     such a stop exists is taken; where that is
//       | -J          |____  ...           none but the plan itself, the plan is followed
//
// Limits of motor m, with T, K, K' the derivatives of its position over the path's length (jerk_path.h), v, a, j of the motion along it:
//
//   |T v| <= V_m      |K v^2 + T a| <= A_m      |K' v^3 + 3 K v a + T j| <= J_m
#pragma once

#include <vector>

#include "runtime/motion/jerk_path.h"

namespace pmac::motion {

struct JerkStep { double duration_ms = 0, jerk_mu_ms3 = 0; };

struct PathState {
  CellPoint at;
  double speed_mu_ms = 0, accel_mu_ms2 = 0;
};

class JerkPlan {
 public:
  /// step_ms: longest step.
  JerkPlan(const JerkPath& path, double step_ms) : path_(path), step_ms_(step_ms) {}

  void set_step(double step_ms) { step_ms_ = step_ms; }

  /// The next step from the state and the state after it; a step of no duration where motion has come to the end of what is known, or
  /// to a stop.
  JerkStep next(PathState& state);
  /// Motion starts from rest in a cell; what was planned is forgotten.
  void restart() { plan_.clear(); used_ = 0; follow_to_mu_ = -1; }
  /// More of the path is known than at the last call.
  void path_grew() { if (end_binds_) follow_to_mu_ = -1; }

 private:
  struct Trouble { double at_mu = 0, max_speed_mu_ms = 0; bool at_end = false; };
  bool advance(PathState& state, const JerkStep& step);
  double whole_step_ms(double speed_change, double accel) const;
  bool peak_passes(const PathState& state, double jerk);
  bool passes(const PathCell& cell, double at_mu, double speed, double accel, double jerk);
  /// How acceleration and jerk are held to the motors' limits: each motor its own, or the root of the sum of the squares of all, in limits.
  /// The second holds on a curve whichever way it turns.
  enum class Within { kEach, kTogether };
  struct Ranges { double accel_low, accel_high, jerk_low, jerk_high; };
  bool ranges(const PathState& state, Within within, Ranges& out) const;
  void narrow_to_end(const PathState& state, const JerkStep& step, Within within, Ranges& ranges) const;
  bool brake_to(PathState& state, double speed_mu_ms, Within within, std::vector<JerkStep>& steps);
  bool coast_to(PathState& state, double to_mu, std::vector<JerkStep>& steps);
  bool pass(PathState& state, const Trouble& trouble, Within within, std::vector<JerkStep>& steps);
  bool stop_within(const PathState& state, Within within, std::vector<JerkStep>& steps);
  bool stop_from(const PathState& state, std::vector<JerkStep>& steps);
  bool try_step(const PathState& state, const JerkStep& step);
  bool try_fastest(const PathState& state);
  double top_speed(const PathState& state) const;

  const JerkPath& path_;
  double step_ms_;
  std::vector<JerkStep> plan_;        // the stop from here; the first used_ steps are behind
  std::size_t used_ = 0;
  std::vector<JerkStep> trial_, found_;
  double follow_to_mu_ = -1;          // what follows this place keeps the plan from being bettered
  bool end_binds_ = false;            // and that is the end of the known path
  Trouble trouble_;                   // why the last trial failed
};

}  // namespace pmac::motion
