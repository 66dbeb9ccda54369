// From a commanded motion to the corners and ramps of a table that keeps the limits: fit, look where the fit exceeds them, slow the motion
// down along its path there, fit again.
#pragma once

#include <span>
#include <string>
#include <variant>

#include "runtime/drives/silverlode/retime.h"
#include "runtime/drives/silverlode/spline_fit.h"

namespace pmac::drives::silverlode {

struct MotionFit {
  Commanded motion;              // what the table follows: the commanded motion, or the same path slower
  SplineFit fit;
  bool is_slowed = false;
  double stretch = 1;            // of all times besides, where slowing down did not settle
};

/// limits: [axis]. The reason where the motion would become too long.
std::variant<MotionFit, std::string> fit_within(const Commanded& motion, std::span<const CountLimits> limits, const FitSetup& setup);

}  // namespace pmac::drives::silverlode
