#include "runtime/drives/silverlode/servo.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "runtime/drives/silverlode/units.h"

namespace pmac::drives::silverlode {
namespace {

std::int64_t towards(std::int64_t from, std::int64_t to, std::int64_t most) { return from < to ? std::min(from + most, to) : std::max(from - most, to); }

/// Distance when the next tick runs at v >= 0 and every one after it acc slower.
__extension__ typedef __int128 Wide;
Wide stopping_distance(std::int64_t v, std::int64_t acc) {
  const std::int64_t steps = v / acc;
  return Wide(steps + 1) * v - Wide(acc) * steps * (steps + 1) / 2;
}

/// The fastest next velocity, low .. high, all >= 0, that still stops within the distance; low where none does.
std::int64_t fastest_that_stops(std::int64_t low, std::int64_t high, std::int64_t acc, std::int64_t distance) {
  if (stopping_distance(high, acc) <= distance) return high;
  while (high - low > 1) {
    const std::int64_t middle = low + (high - low) / 2;
    (stopping_distance(middle, acc) <= distance ? low : high) = middle;
  }
  return low;
}

/// Next velocity towards a position ahead (distance > 0), for a velocity that does not lead away from it.
std::int64_t velocity_ahead(std::int64_t velocity, std::int64_t distance, const AxisMove& move) {
  const std::int64_t slowest = std::max<std::int64_t>(0, velocity - move.acc);
  const std::int64_t wanted = towards(velocity, move.vel, move.acc);
  if (distance <= move.acc && velocity <= 2 * std::int64_t{move.acc}) return std::min<std::int64_t>(distance, std::max(slowest, wanted));
  return fastest_that_stops(slowest, std::max(slowest, wanted), move.acc, distance);
}

void step_to_position(Profile& profile, const AxisMove& move) {
  const std::int64_t distance = std::int64_t{move.pos} * kUnitsPerCountInt - profile.position;
  const int side = distance < 0 ? -1 : 1;
  const std::int64_t ahead = side * profile.velocity;
  if (distance == 0 && std::abs(profile.velocity) <= move.acc) profile.velocity = 0;
  else if (ahead < 0) profile.velocity = side * std::min<std::int64_t>(0, ahead + move.acc);
  else profile.velocity = side * velocity_ahead(ahead, std::abs(distance), move);
  profile.position += profile.velocity;
}

}  // namespace

void step(Profile& profile, const AxisMove& move) {
  if (move.acc == 0) {
    profile.position += profile.velocity;
    return;
  }
  if (std::abs(std::int64_t{move.pos}) != kFarPosition) return step_to_position(profile, move);
  const std::int64_t target = move.pos > 0 ? move.vel : -std::int64_t{move.vel};
  profile.velocity = towards(profile.velocity, target, move.acc);
  profile.position += profile.velocity;
}

void step_to_rest(Profile& profile, std::int64_t acc) {
  profile.velocity = acc == 0 ? 0 : towards(profile.velocity, 0, acc);
  profile.position += profile.velocity;
}

std::int64_t full_ramp_ticks(std::int64_t from_svu, std::int64_t to_svu, std::int64_t acc) { return acc == 0 ? 0 : std::abs(to_svu - from_svu) / acc; }

std::int64_t ramp_distance(std::int64_t from_svu, std::int64_t signed_acc, std::int64_t ticks) { return from_svu * ticks + signed_acc * (ticks * (ticks + 1) / 2); }

void execute(const Table& table, const std::function<void(std::int64_t, std::span<const Profile>)>& visit) {
  std::vector<Profile> servos(table.axes.size());
  for (std::size_t a = 0; a < servos.size(); ++a) servos[a].position = std::llround(table.start_counts[a] * kUnitsPerCount);
  std::int64_t tick = 0;
  visit(tick, servos);
  for (const Entry& entry : table.entries)
    for (std::int64_t k = 0; k < duration_ticks(entry.ticks); ++k) {
      for (std::size_t a = 0; a < servos.size(); ++a) step(servos[a], entry.axis[a]);
      visit(++tick, servos);
    }
}

}  // namespace pmac::drives::silverlode
