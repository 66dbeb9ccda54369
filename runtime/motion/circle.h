// From the words of a circle block to its arc: centre, sense, sweep, radius. Manual: User's Manual p742-743, Turbo User Manual
// p285, Turbo Software Reference Isx96/97 (radius error, minimum arc).
#pragma once

#include "runtime/motion/curve.h"

namespace pmac::motion {

struct Arc {
  Curve curve;
  double length_uu = 0;      // of the arc in its plane, spiral included
  double min_radius_uu = 0;  // for the centripetal limit
};

/// The arc of a circle command from start to `end` (every axis). A block with neither centre nor radius is a straight line
/// (curve.is_arc false, length 0). Faults: kCircleRadius where no such circle exists.
runtime::Result<Arc> make_arc(const MotionCommand& command, const AxisVector& start, const AxisVector& end,
                              const PipelineConfig& config);

}  // namespace pmac::motion
