// --kin-check: the kinematics of every coordinate system with motors ->I, at seeded random poses.
//
//   poses    uniform in the ranges of --kin-range, or where none is given the forward map of motor positions uniform in
//            Motor[].MinPos .. MaxPos
//   error    forward(inverse(pose)) against the pose; angles A B C AA BB CC modulo a turn
//   reach    poses without a solution, by reason, with the box that they fill
//   singular condition number of d motor / d axis (central differences), axes in units of their ranges and motors in units of what
//            they cover; the worst pose is improved by a search along the axes
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "runtime/machine.h"
#include "runtime/tool/options.h"

namespace pmac::tool {

struct AxisRange { int axis = 0; double low_uu = 0, high_uu = 0; };

/// Poses without a solution, for one reason.
struct OutOfReach {
  std::string reason;
  int count = 0;
  std::vector<AxisRange> box;            // around them
  std::vector<double> first_uu;          // [axis of the check]
};

struct KinCheckResult {
  int coord = 0;
  bool by_motors = false;                // sampled in motor space
  std::vector<AxisRange> ranges;         // of the poses
  int samples = 0, solved = 0;
  std::vector<OutOfReach> out_of_reach;  // by count, descending
  double worst_error_uu = 0;
  int worst_axis = -1;                   // -1: nothing was solved
  std::vector<double> worst_uu;          // pose, [range]
  int singular = 0, at_edge = 0;         // poses; at_edge: a neighbour has no solution, so that there is no Jacobian
  double worst_condition = 0;
  std::vector<double> worst_condition_uu;
  double tolerance_uu = 0, condition_limit = 0;
  std::uint64_t seed = 0;
  bool ok() const { return worst_axis >= 0 && worst_error_uu <= tolerance_uu; }
};

/// Checks every coordinate system and prints the results. Returns an exit code: kExitFault where an error is above tolerance or
/// nothing is in reach.
int check_kinematics(const RunOptions& options, runtime::Machine& machine);

std::string kin_check_text(const KinCheckResult& result);
std::string kin_check_json(const std::vector<KinCheckResult>& results);

}  // namespace pmac::tool
