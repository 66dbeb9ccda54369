// What --check-limits prints: every motor's worst speed, acceleration, jerk and position against the limits that held for them.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "runtime/machine.h"
#include "runtime/servo/limit_check.h"

namespace pmac::tool {

std::string limit_text(const runtime::Machine& machine, const std::vector<runtime::LimitCheck::Row>& rows);
/// By motor number: speed, accel, jerk and position with value, limit (null: none), share, time_s, file, line, and ok.
nlohmann::ordered_json limit_json(const runtime::Machine& machine, const std::vector<runtime::LimitCheck::Row>& rows);
bool all_keep_limits(const std::vector<runtime::LimitCheck::Row>& rows);

/// "InvAmax of motor 1 65 %, F 35 %": what held a move back, with parts of its time; parts below 1 % are left out.
std::string governed_text(const runtime::MoveRecord& move);
nlohmann::ordered_json governed_json(const runtime::MoveRecord& move);

}  // namespace pmac::tool
