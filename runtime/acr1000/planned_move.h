// From a request to a move whose every instant is known: the profile of its master, the law of its axis, and what is odd about it.
#pragma once

#include <optional>
#include <vector>

#include "runtime/acr1000/master_profile.h"
#include "runtime/acr1000/move_request.h"

namespace pmac::acr1000 {

/// How the axis arrives at the start of a move.
struct MoveEntry {
  double position_pulses = 0;
  double master_speed_pulses_s = 0;  // carried over from a move with STP 0 that this one follows without a pause; else 0
  double axis_speed_pulses_s = 0;    // signed, of the move before, likewise
  bool after_line = false;           // the move before was a MOV
};

struct PlannedMove {
  MoveRequest request;
  AxisLaw law;
  MasterProfile profile;
  double own_length_pulses = 0;
  double start_s = 0;
  double end_s() const { return start_s + profile.duration_s; }
};

/// Position, speed and acceleration of the axis, and the master distance.
struct MotionPoint { double position_pulses = 0, speed_pulses_s = 0, accel_pulses_s2 = 0, master_pulses = 0; };

/// How far a P29 may be from the computed end, and hypot(I,J) from the radius, before it is odd: rounding of whole pulses [assumed].
inline constexpr double kEndTolerancePulses = 2, kRadiusTolerancePulses = 1.5;

/// Why a request cannot be a move: CIRCLE arguments, P28 below 0, VEL 0 with a way to go, a target beyond 32 bits.
/// start_pulses: where the axis will start, the end of the move before.
std::optional<Finding> refusal_of(const MoveRequest& request, std::int64_t start_pulses);

/// Where the axis will be when it is over.
std::int64_t end_of(const MoveRequest& request, std::int64_t start_pulses);

PlannedMove plan_move(const MoveRequest& request, const RateUnits& units, const MoveEntry& entry, double start_s);

/// ACR-W02, W03, W05, W06 and W07 of a move.
std::vector<Finding> oddities_of(const PlannedMove& move, const MoveEntry& entry);

/// time_s: of the system; before the start as at it, after the end the axis stands.
MotionPoint at(const PlannedMove& move, double time_s);

/// The same as a path without steps: speeds at the end are those just before it, and what a CIRCLE comes beside its P29, a part of a
/// pulse if its numbers are right, is spread over the whole of it.
MotionPoint path_at(const PlannedMove& move, double time_s);

}  // namespace pmac::acr1000
