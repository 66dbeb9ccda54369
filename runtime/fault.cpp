#include "runtime/fault.h"

#include <cmath>

#include <fmt/format.h>

namespace pmac::runtime {

std::string number_text(double value) { return std::isnan(value) ? "nan" : fmt::format("{}", value); }

int error_status(FaultKind kind) {
  switch (kind) {
    case FaultKind::kSyncBuffer: return 1;
    case FaultKind::kCcMoveType: return 3;
    case FaultKind::kMoveType: return 4;
    case FaultKind::kCcLeadOut: return 5;
    case FaultKind::kCcLeadIn: return 6;
    case FaultKind::kCcBufferSize: return 7;
    case FaultKind::kPvt: return 8;
    case FaultKind::kCcFeedRate: return 9;
    case FaultKind::kCcDirection: return 10;
    case FaultKind::kCcNoSolution: return 11;
    case FaultKind::kCcDistance: return 13;
    case FaultKind::kCcNoIntersection: return 14;
    case FaultKind::kCcNoMoves: return 15;
    case FaultKind::kInPosition: return 17;
    case FaultKind::kSoftLimit: return 32;
    case FaultKind::kCircleRadius: return 64;
    case FaultKind::kInverseKinematics:
    case FaultKind::kForwardKinematics:
    case FaultKind::kUserStatus: return 255;
    case FaultKind::kFollowingError:
    case FaultKind::kOvertravel:
    case FaultKind::kAmplifier: return 0;   // named in the motor's status, not here
    case FaultKind::kRunTime:
    case FaultKind::kBadTarget:
    case FaultKind::kNotReady:
    case FaultKind::kMotorKilled:
    case FaultKind::kNotSimulated: break;
  }
  return 16;  // run-time error; the controller has no number of its own for these
}

}  // namespace pmac::runtime
