#include "runtime/drives/mcx514/octant.h"

#include <array>

namespace pmac::drives::mcx514 {
namespace {

/// Counter-clockwise; clockwise both steps are negated and outward is the opposite.
constexpr std::array<OctantRun, 8> kCounterClockwise = {{
    {1, +1, -1, true}, {0, -1, +1, false}, {0, -1, -1, true}, {1, -1, -1, false},
    {1, -1, +1, true}, {0, +1, -1, false}, {0, +1, +1, true}, {1, +1, +1, false},
}};

int entered_counter_clockwise(std::int64_t x, std::int64_t y) {
  if (y >= 0 && x > 0) return y < x ? 0 : 1;
  if (x <= 0 && y > 0) return -x < y ? 2 : 3;
  if (y <= 0 && x < 0) return -y < -x ? 4 : 5;
  return x < -y ? 6 : 7;
}

}  // namespace

OctantRun octant_run(int octant, bool clockwise) {
  OctantRun run = kCounterClockwise[static_cast<std::size_t>(octant)];
  if (clockwise) run = {run.short_axis, -run.short_step, -run.long_step, !run.outward};
  return run;
}

int entered_octant(Plane point, bool clockwise) {
  return clockwise ? 7 - entered_counter_clockwise(point.ax1, -point.ax2) : entered_counter_clockwise(point.ax1, point.ax2);
}

}  // namespace pmac::drives::mcx514
