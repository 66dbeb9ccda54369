// The stages of a card's move as text, for --emit: what was commanded, and how its master runs.
#pragma once

#include <string>

#include "runtime/acr1000/planned_move.h"

namespace pmac::acr1000 {

std::string command_header();
/// "X line 60 mov to 100000 P28=100000 VEL=10000 ACC=0 DEC=0 STP=0 move 1"; coordinated 0: moved by itself.
std::string command_text(const std::string& card, const PlannedMove& move, std::uint64_t coordinated);

std::string path_header();
/// The phases that take time: start, duration, master distance and speed at their ends, and where the axis is then.
std::string path_text(const std::string& card, const PlannedMove& move);

}  // namespace pmac::acr1000
