// Where a segment in motor space leaves the range that a motor's software limits leave to it.
#pragma once

#include <optional>
#include <span>

#include "runtime/motion/segment.h"

namespace pmac::motion {

struct LimitCrossing {
  double at_ms = 0;       // programmed time since the start of the segment; there the motor is exactly at its limit
  int motor = 0;          // index in the order of the map
  bool plus = false;      // the upper one
};

/// The first crossing outwards; none where every motor stays inside, or comes back from beyond.
std::optional<LimitCrossing> first_crossing(const Segment& segment, std::span<const MotorLimits> limits);

}  // namespace pmac::motion
