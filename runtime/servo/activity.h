// What a motor's commanded position follows at a servo tick, and the limits that hold for it there.
#pragma once

#include <limits>

#include "compiler/bytecode/bytecode.h"

namespace pmac::runtime {

/// Limits are magnitudes; infinity: none. Programmed moves: MaxSpeed, 1/InvAmax, 1/InvDmax into a stop where it is assigned,
/// 1/InvJmax where it is assigned. Jogs, rapid moves, home searches and aborts: their own speed and MaxSpeed, and their own rates where
/// JogTa, JogTs, AbortTa, AbortTs are rates (negative). Positions: MinPos and MaxPos where MaxPos > MinPos.
struct MotorActivity {
  enum class Kind { kRest, kPath, kOwn };  // kPath: its coordinate system's path; kOwn: a profile of its own

  Kind kind = Kind::kRest;
  bytecode::SourceLine source;
  int coord = -1;
  double home_mu = 0;                      // of position 0, from power-on
  double max_speed_mu_ms = std::numeric_limits<double>::infinity();
  double max_accel_mu_ms2 = std::numeric_limits<double>::infinity();
  double max_stop_mu_ms2 = std::numeric_limits<double>::infinity();   // into a stop of the whole coordinate system
  double max_jerk_mu_ms3 = std::numeric_limits<double>::infinity();
  double min_mu = -std::numeric_limits<double>::infinity(), max_mu = std::numeric_limits<double>::infinity();
};

}  // namespace pmac::runtime
