// Set-ups and items of random motion programs from a seed alone: the same on every machine.
#pragma once

#include <cstdint>

#include "tests/reference/random_motion.h"

namespace pmac::reference {

MotionSpec random_motion_spec(std::uint32_t seed);

}  // namespace pmac::reference
