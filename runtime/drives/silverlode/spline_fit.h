// A commanded motion as corners and ramps of the interpolation table.
//
// A servo's speed is a broken line of time, so its position is a quadratic spline, the same knots for every axis. Its control points are the
// corners of the table and the lengths between its knots the ramps: with ramps that fill the whole time an entry has no stretch at constant
// speed, and the accelerations are those of the motion itself.
//
//     speed      /\              knot k: the speed of entry k is reached, entry k + 1 begins
//              _/  \__           corner: where the speeds before and after a ramp would meet
//            /        \ .
//        0   1  2  3   4  knots
//
// Knots are put where the motion needs them: least squares over the motion, then every length whose error is above the tolerance is parted,
// at a step of the acceleration where there is one, until all are within it or too short to be parted.
#pragma once

#include <string>
#include <vector>

#include "runtime/drives/silverlode/commanded.h"

namespace pmac::drives::silverlode {

struct FitSetup {
  double tolerance_counts = 0.5;
  double least_ticks = 168;          // of an entry; even
  double first_ticks = 2668;         // of the first knots, about 0.32 s; even
};

struct SplineFit {
  std::vector<double> ramp_ticks;                 // [1..n+1] between knots, whole and even; [0] is not used
  std::vector<std::vector<double>> corner_counts; // [axis][0..n]
  double error_counts = 0;                        // largest distance from the motion at the same time
};

/// The motion moves.
SplineFit fit_spline(const Commanded& motion, const FitSetup& setup);

}  // namespace pmac::drives::silverlode
