// What the servos make of a circle's table, against the circle that was commanded.
#pragma once

#include "runtime/drives/silverlode/circle.h"
#include "runtime/drives/silverlode/servo.h"

namespace pmac::drives::silverlode {

/// Distance of a position (counts) from the commanded circle, positive outside. With scales that differ it is taken in user units and
/// multiplied by their geometric mean.
double radial_error_counts(const CircleSetup& setup, double x_counts, double y_counts);

struct CircleFigures {
  double radial_min_counts = 0, radial_max_counts = 0;   // over every tick, the start included
  double closing_counts = 0;                             // final position of X and Y from the end of the arc
  double time_s = 0;
  std::int64_t ticks = 0;
};

CircleFigures figures_of(const CircleSetup& setup, const Table& table);

}  // namespace pmac::drives::silverlode
