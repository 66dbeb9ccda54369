// The rotary buffer, program 0 of a coordinate system: lines that are appended while earlier ones execute (User's Manual p658-670).
// Every open rotary ... close is one piece; the pieces execute one after the other as one program, blending from one to the next,
// and are forgotten when they are done. Where the lines run out the motion comes to rest, and the lines that come next go on.
// Inferred: the wait for lines counts as idle, and stop or abort ends it.
#include "runtime/coordinate/coord_system.h"

#include <utility>

#include "runtime/state.h"

namespace pmac::runtime {

std::string CoordSystem::append_rotary(ProgramHandle lines, double time_ms) {
  rotary_.push_back(std::move(lines));
  const bool waits = rotary_state_ == RotaryState::kWaits && phase_ == Phase::kIdle;
  if (!waits) return {};
  if (std::string refusal = match_positions(time_ms); !refusal.empty()) return refusal;
  runner_.thread.go_on_with(rotary_.front());
  rotary_state_ = RotaryState::kExecutes;
  phase_ = Phase::kCalculating;
  resume_ms_ = time_ms;
  return {};
}

std::string CoordSystem::start_rotary(double time_ms) {
  if (rotary_.empty()) {
    rotary_state_ = RotaryState::kWaits;
    return {};
  }
  std::string refusal = start_at(rotary_.front(), -1, time_ms);
  if (refusal.empty()) rotary_state_ = RotaryState::kExecutes;
  return refusal;
}

/// The lines that executed are done; true where the next ones follow.
bool CoordSystem::goes_on_in_rotary() {
  if (rotary_state_ != RotaryState::kExecutes || !runner_.thread.came_to_end()) return false;
  if (!rotary_.empty()) rotary_.pop_front();
  if (rotary_.empty()) {
    rotary_state_ = RotaryState::kWaits;
    return false;
  }
  runner_.thread.go_on_with(rotary_.front());
  return true;
}

/// At rest behind the last line: waits for more, or goes on where more have come meanwhile. False: no rotary buffer executes.
bool CoordSystem::rotary_ends_here() {
  if (rotary_state_ != RotaryState::kWaits) return false;
  std::deque<SyncEntry> waiting = std::exchange(sync_, {});  // for the first of the moves to come
  drop_program();
  sync_ = std::move(waiting);
  rotary_state_ = RotaryState::kWaits;
  if (rotary_.empty()) return true;
  runner_.thread.go_on_with(rotary_.front());
  rotary_state_ = RotaryState::kExecutes;
  phase_ = Phase::kCalculating;
  resume_ms_ = machine_.now_ms;
  return true;
}

}  // namespace pmac::runtime
