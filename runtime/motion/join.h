// What happens between two moves: a stop, a blend along a path whose tangents agree, or a blend that cuts a corner. Manual:
// User's Manual p703-711, 727-729, Turbo Software Reference Isx83; the room rules are those of the vendor's forum.
#pragma once

#include "runtime/motion/move.h"

namespace pmac::motion {

enum class JoinKind : std::uint8_t {
  kStop,       // to rest with the ramp of the first move, then from rest into the second
  kSteady,     // same velocity on both sides: nothing to blend
  kAlongPath,  // same direction, other speed: the speed is blended along the path
  kCorner,     // ramp-down of the first and ramp-up of the second superposed
};

struct Join {
  JoinKind kind = JoinKind::kStop;
  Ramp ramp;                    // of a blend
  double speed_before = 0, speed_after = 0;  // at the join, over all axes, uu/ms
  double dwell_ms = 0;          // of a stop: how long it waits
  bool by_rule = false;         // a stop that a corner rule or NoBlend asks for: motors are to be in position (Coord[].InPosTimeOut)
};

/// entry_total_ms: length of the ramp or blend into `previous`.
///
/// The blend may not start before the one before it has ended, and `next` must still have time for its own stop. Unsegmented
/// moves stop where there is no room or where td + tsd of the first is shorter than the blend; segmented ones blend in the
/// time that there is.
Join decide_join(const Move& previous, const Move& next, double entry_total_ms, const PipelineConfig& config);

}  // namespace pmac::motion
