// One maker a stock robot: reads its settings, says through them what is wrong, and answers a robot in any case.
#pragma once

#include "kinematics/robot.h"

namespace pmac::kinematics::stock {

#define ROBOT(maker, name, joints, axes, text) std::unique_ptr<Robot> make_##maker(RobotSettings&);
#include "kinematics/stock/robots.def"
#undef ROBOT

}  // namespace pmac::kinematics::stock
