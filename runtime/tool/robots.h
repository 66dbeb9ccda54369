// Stock kinematics by name (--kinematics): from the text of the option to a robot in the machine.
#pragma once

#include "runtime/machine.h"
#include "runtime/tool/options.h"

namespace pmac::tool {

/// Gives every coordinate system that an option names its robot. Returns an exit code; messages go to standard error.
///
///     1=scara                                       standard settings
///     1=scara:upper_arm_mm=350,elbow=-1             several numbers of a setting: tower_deg=90/210/330
///     2=hexapod:geometry.json                       an object of numbers and lists of numbers
///
/// motor_mu is the setting of every robot: motor units per mm or degree of its joints, one for all or one a joint (1).
int set_robots(const RunOptions& options, runtime::Machine& machine);

/// Prints the robots and their settings.
int list_robots();

}  // namespace pmac::tool
