// A motion or a program that cannot go on: a value that says why and where. It ends as controller status, stops its
// coordinate system and is named on standard error with its source line.
#pragma once

#include <string>
#include <variant>

#include "compiler/bytecode/bytecode.h"

namespace pmac::runtime {

/// What went wrong. The numbers of Coord[].ErrorStatus that belong to them are in error_status().
enum class FaultKind {
  kRunTime,                 // value out of range, missing subprogram, stack overflow, ...
  kSyncBuffer,              // more synchronous assignments than Coord[].SyncOps
  kMoveType,                // a move that cannot follow the one before
  kBadTarget,               // target, feed rate or time that is not finite or not allowed
  kCircleRadius,            // end point not on the circle, or no circle through the points
  kInverseKinematics,       // no solution, or the routine aborted
  kForwardKinematics,
  kNotReady,                // start refused: no motors, not solvable, program missing, ...
  kSoftLimit,
  kUserStatus,              // Coord[].ErrorStatus written by the program
  kMotorKilled,             // a motor was killed under the program that uses it
  kCcMoveType,              // cutter compensation: a move or command that it does not allow
  kCcLeadOut,               // lead-out that is no line or shorter than the radius
  kCcLeadIn,                // lead-in that is no line or shorter than the radius
  kCcBufferSize,            // no motion in the plane within Coord[].CCSize moves
  kPvt,                     // pvt move that cannot be
  kCcFeedRate,              // moves given by time
  kCcDirection,             // a compensated move would go backwards
  kCcNoSolution,            // an arc that is smaller than the tool
  kCcDistance,              // leaving out Coord[].CCDistance moves does not help
  kCcNoIntersection,        // compensated paths that do not meet
  kCcNoMoves,               // nothing between lead-in and lead-out
  kNotSimulated,            // a statement that the simulation does not execute
  kFollowingError,          // a motor's following error above Motor[].FatalFeLimit
  kOvertravel,              // a motor ran into its overtravel switch
  kAmplifier,               // a motor's amplifier reported a fault
  kInPosition,              // motors not in position within Coord[].InPosTimeOut
};

struct [[nodiscard]] Fault {
  FaultKind kind{};
  bytecode::SourceLine source;
  std::string detail;       // a sentence without full stop: what, and the remedy where there is one
};

template <class T> using Result = std::variant<T, Fault>;

/// A number in a message: the shortest digits that give it back; nan has no sign.
std::string number_text(double value);

/// Value of Coord[].ErrorStatus for a fault.
int error_status(FaultKind kind);

}  // namespace pmac::runtime
