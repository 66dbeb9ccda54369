#include "runtime/motion/ramp.h"

#include <algorithm>
#include <cmath>

namespace pmac::motion {
namespace {

Ramp ramp_from_times(double ta_ms, double ts_ms, RampRule rule) {
  if (rule == RampRule::kTurbo) return {std::max(ta_ms, 2 * ts_ms) - ts_ms, ts_ms};
  return {std::max(ta_ms, ts_ms), ts_ms};
}

/// Where the jerk limit alone decides: acceleration rises and falls at once, ta = ts = sqrt(dv / J).
Ramp jerk_bound_ramp(double speed_change, double inv_jerk) {
  const double time_ms = std::sqrt(speed_change * inv_jerk);
  return {time_ms, time_ms};
}

Ramp ramp_from_rates(double speed_change, double inv_acceleration, double inv_jerk) {
  const double ta_ms = speed_change * inv_acceleration;
  const double ts_ms = inv_jerk / inv_acceleration;
  return ta_ms < ts_ms ? jerk_bound_ramp(speed_change, inv_jerk) : Ramp{ta_ms, ts_ms};
}

Ramp ramp_from_time_and_jerk(double speed_change, double ta_ms, double inv_jerk) {
  const bool jerk_decides = ta_ms <= 0 || speed_change * inv_jerk > ta_ms * ta_ms;
  return jerk_decides ? jerk_bound_ramp(speed_change, inv_jerk) : Ramp{ta_ms, speed_change * inv_jerk / ta_ms};
}

}  // namespace

bool is_valid(const RampSetting& setting) {
  return std::isfinite(setting.ta) && std::isfinite(setting.ts) && !(setting.ta < 0 && setting.ts > 0);
}

Ramp make_ramp(const RampSetting& setting, double speed_change, RampRule rule) {
  const double change = std::abs(speed_change);
  if (setting.ta < 0) return ramp_from_rates(change, -setting.ta, std::abs(setting.ts));
  if (setting.ts < 0) return ramp_from_time_and_jerk(change, setting.ta, -setting.ts);
  return ramp_from_times(setting.ta, setting.ts, rule);
}

Ramp lengthened(Ramp ramp, double speed_change, double inv_amax, double inv_jmax) {
  const double change = std::abs(speed_change);
  ramp.ta_ms = std::max(ramp.ta_ms, change * inv_amax);
  if (inv_jmax <= 0 || ramp.ts_ms <= 0) return ramp;
  ramp.ts_ms = std::max(ramp.ts_ms, change * inv_jmax / ramp.ta_ms);
  if (ramp.ts_ms <= ramp.ta_ms) return ramp;
  ramp.ta_ms = ramp.ts_ms = std::max(ramp.ta_ms, std::sqrt(change * inv_jmax));
  return ramp;
}

Ramp scaled_to(const Ramp& ramp, double total_ms) {
  const double total = ramp.total_ms();
  if (total <= 0) return {total_ms, 0};
  return {ramp.ta_ms * (total_ms / total), ramp.ts_ms * (total_ms / total)};
}

double ramp_value(const Ramp& ramp, double time_ms) {
  const auto [ta, ts] = ramp;
  const double left = ramp.total_ms() - time_ms;
  if (left <= 0) return 1;
  if (time_ms <= 0) return 0;
  if (time_ms < ts) return time_ms * time_ms / (2 * ts * ta);
  if (time_ms <= ta) return (time_ms - ts / 2) / ta;
  return 1 - left * left / (2 * ts * ta);
}

double ramp_integral_ms(const Ramp& ramp, double time_ms) {
  const auto [ta, ts] = ramp;
  const double left = ramp.total_ms() - time_ms;
  if (left <= 0) return time_ms - ramp.total_ms() / 2;
  if (time_ms <= 0) return 0;
  if (time_ms < ts) return time_ms * time_ms * time_ms / (6 * ts * ta);
  if (time_ms <= ta) return (time_ms - ts / 2) * (time_ms - ts / 2) / (2 * ta) + ts * ts / (24 * ta);
  return time_ms - ramp.total_ms() / 2 + left * left * left / (6 * ts * ta);
}

RampParts ramp_parts(const Ramp& ramp) {
  const auto [ta, ts] = ramp;
  const double jerk = ts > 0 ? 1 / (ts * ta) : 0;
  RampParts parts;
  const auto append = [&](double start, double end, double slope, double curvature) {
    if (end > start)
      parts.part[static_cast<std::size_t>(parts.count++)] = {
          start, end - start, ramp_integral_ms(ramp, start), ramp_value(ramp, start), slope, curvature};
  };
  append(0, ts, 0, jerk);
  append(ts, ta, 1 / ta, 0);
  append(ta, ramp.total_ms(), 1 / ta, -jerk);
  return parts;
}

double ramp_distance(double start_speed, double end_speed, const Ramp& ramp) {
  return (start_speed + end_speed) / 2 * ramp.total_ms();
}

}  // namespace pmac::motion
