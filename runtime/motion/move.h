// One command made ready for blending: its curve, how long it takes at constant speed, and its own ramps. Manual: User's Manual
// p722-729 (move time, limits of unsegmented moves), Turbo Software Reference F, FRAX, Isx13.
#pragma once

#include <vector>

#include "runtime/motion/curve.h"
#include "runtime/motion/motor_map.h"
#include "runtime/motion/ramp.h"

namespace pmac::motion {

struct Move {
  std::uint64_t id = 0;
  SourceLine source;
  CurveRef curve;
  double time_ms = 0;                   // TM: at constant speed, after all rules
  double length_uu = 0;                 // over the axes that counted for the feed rate
  TimeRule rule = TimeRule::kFeed;      // what time_ms comes from
  RampSetting entry{}, exit{};          // ta ts, td tsd as set
  Ramp stop_ramp;                       // to rest at the end of this move
  bool no_blend = false;
  bool pvt = false;                     // velocities at both ends are given; no ramps
  std::array<double, 3> normal{};       // for the corner rule
  bool second_set = false;
};

/// What moves of one pipeline have in common.
struct MoveContext {
  const PipelineConfig& config;
  const MotorKinematics& kinematics;
};

/// Makes `move` the command from `start`. Faults are the command's own: target, feed rate, circle, kinematics (unsegmented).
std::optional<runtime::Fault> make_move(const MotionCommand& command, const AxisVector& start, const std::vector<double>& start_motor_mu,
                                        const MoveContext& context, Move& move);

/// The ramp of a change of velocity by speed_change_uu_ms (vector speed) and motor_change_mu_ms ([motor], signed; may be
/// empty): as set, and unsegmented as long as the motors need it. stops: InvDmax counts instead of InvAmax.
Ramp ramp_within_limits(const RampSetting& setting, double speed_change_uu_ms, const std::vector<double>& motor_change_mu_ms,
                        bool stops, const PipelineConfig& config);

/// From rest into this move.
Ramp start_ramp(const Move& move, const PipelineConfig& config);

}  // namespace pmac::motion
