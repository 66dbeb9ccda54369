// A commanded motion that is too fast for the servos, slowed down along its path just so far that every axis keeps its limits.
//
// With s the commanded time and z = (ds/dt)^2 <= 1: speed p' sqrt(z), acceleration p'' z + p' z' / 2. Backwards over the samples the largest
// z from which the rest can be done, then forwards always the largest that is allowed (reachability analysis of time-optimal path
// parametrisation, Pham and Pham 2018).
#pragma once

#include <span>
#include <vector>

#include "runtime/drives/silverlode/commanded.h"

namespace pmac::drives::silverlode {

struct CountLimits { double speed_counts_s, accel_counts_s2; };

inline constexpr double kMostSlowedRows = 2e7;     // servo cycles of a slowed motion, more than two hours

/// A slowed motion, and the commanded time of every servo cycle of it; both empty where it would last more than kMostSlowedRows.
struct Slowed {
  double duration_s = 0;
  Commanded motion;
  std::vector<double> commanded_s;
};

/// True where the motion as it is exceeds a limit. limits: [axis].
bool exceeds(const Commanded& motion, std::span<const CountLimits> limits);

/// room: [row of the motion], 0..1, share of the accelerations that may be used there; the speeds may be used as far as the square root.
Slowed slowed_to(const Commanded& motion, std::span<const CountLimits> limits, std::span<const double> room);

}  // namespace pmac::drives::silverlode
