#include "runtime/fault.h"

namespace pmac::runtime {

/// Numbers of Coord[].ErrorStatus (Power PMAC User's Manual; 255 is what the manual's own kinematic routines report).
int error_status(FaultKind kind) {
  switch (kind) {
    case FaultKind::kRunTime: return 16;
    case FaultKind::kSyncBuffer: return 1;
    case FaultKind::kMoveType: return 8;
    case FaultKind::kBadTarget: return 16;
    case FaultKind::kCircleRadius: return 64;
    case FaultKind::kInverseKinematics: return 255;
    case FaultKind::kForwardKinematics: return 255;
    case FaultKind::kNotReady: return 39;
    case FaultKind::kSoftLimit: return 32;
    case FaultKind::kUserStatus: return 255;
    case FaultKind::kNotSimulated: return 16;
  }
  return 16;
}

}  // namespace pmac::runtime
