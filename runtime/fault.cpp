#include "runtime/fault.h"

namespace pmac::runtime {

int error_status(FaultKind kind) {
  switch (kind) {
    case FaultKind::kSyncBuffer: return 1;
    case FaultKind::kMoveType: return 4;
    case FaultKind::kSoftLimit: return 32;
    case FaultKind::kCircleRadius: return 64;
    case FaultKind::kInverseKinematics:
    case FaultKind::kForwardKinematics:
    case FaultKind::kUserStatus: return 255;
    case FaultKind::kRunTime:
    case FaultKind::kBadTarget:
    case FaultKind::kNotReady:
    case FaultKind::kNotSimulated: break;
  }
  return 16;  // run-time error; the controller has no number of its own for these
}

}  // namespace pmac::runtime
