// Small arithmetic on axis vectors.
#pragma once

#include <bit>
#include <cmath>

#include "runtime/motion/types.h"

namespace pmac::motion {

/// Calls function(axis index) for each axis of a mask.
template <class Function>
void for_each_axis(std::uint32_t mask, const Function& function) {
  for (; mask != 0; mask &= mask - 1) function(static_cast<std::size_t>(std::countr_zero(mask)));
}

inline double dot(const AxisVector& a, const AxisVector& b, std::uint32_t mask = ~0u) {
  double sum = 0;
  for_each_axis(mask, [&](std::size_t axis) { sum += a[axis] * b[axis]; });
  return sum;
}

inline double norm(const AxisVector& a, std::uint32_t mask = ~0u) { return std::sqrt(dot(a, a, mask)); }

}  // namespace pmac::motion
