// --drive mcx514: the motion of a run as a register script for one MCX514, executed on the simulated chip.
#pragma once

#include <memory>
#include <string>
#include <variant>

#include "runtime/drives/drive.h"

namespace pmac::drives {

/// Settings: speed=program|duration, continuous=on|off.
std::variant<std::unique_ptr<Drive>, std::string> make_mcx514(const Settings& settings, DriveContext context);

}  // namespace pmac::drives
