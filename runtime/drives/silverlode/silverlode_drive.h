// SilverLode servos as a drive back end: any motion of a run becomes an interpolation table, the table frames, and the simulated servos
// execute the frames.
//
//     servo samples -> Commanded -> fit_spline (corners, ramps) -> fill_closed (limits, integers) -> Table -> frames -> Device ... -> error
#pragma once

#include "runtime/drives/drive.h"

namespace pmac::drives {

std::variant<std::unique_ptr<Drive>, std::string> make_silverlode(const Settings& settings, DriveContext context);

}  // namespace pmac::drives
