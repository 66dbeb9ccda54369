// One servo's profile generator, exact: what a queued or a plain move makes of position and velocity in each servo cycle.
//
//     each tick: the velocity moves towards the command velocity by at most acc, then the position moves by the velocity
//
// Positions are 2^-26 counts in 64 bits, velocities 2^-26 counts a tick.
//
// Source: application note "Make Circles", Theory of Operation and the check columns; technical document TD044.
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "runtime/drives/silverlode/table.h"

namespace pmac::drives::silverlode {

struct Profile {
  std::int64_t position = 0;
  std::int64_t velocity = 0;
};

/// One servo cycle under a move. A position of +-2^30 is never reached and gives the direction alone; at any other the servo stops without
/// passing it, where acc allows that, and comes back where it does not. acc = 0 keeps the velocity.
void step(Profile& profile, const AxisMove& move);

/// One servo cycle of slowing down to rest. acc = 0 stops at once.
void step_to_rest(Profile& profile, std::int64_t acc);

/// Ticks that a ramp of this rate can fill up: whole steps between two velocities.
std::int64_t full_ramp_ticks(std::int64_t from_svu, std::int64_t to_svu, std::int64_t acc);
/// Distance of so many full steps from a velocity: v t + a t (t + 1) / 2; a with its sign. 2^-26 counts.
std::int64_t ramp_distance(std::int64_t from_svu, std::int64_t signed_acc, std::int64_t ticks);

/// Executes a table on servos that are always fed in time. `visit` is given every tick from 0, where the servos stand at the start of
/// the table, to the last; positions [axis] in 2^-26 counts.
void execute(const Table& table, const std::function<void(std::int64_t tick, std::span<const Profile> servos)>& visit);

}  // namespace pmac::drives::silverlode
