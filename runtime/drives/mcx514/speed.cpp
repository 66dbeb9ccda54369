#include "runtime/drives/mcx514/speed.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pmac::drives::mcx514 {
namespace {

struct Ratio { std::int64_t numerator, denominator; };

Ratio stretch(VectorSpeed vector, int pulsing) {
  if (vector == VectorSpeed::kOff || pulsing < 2) return {1, 1};
  if (vector == VectorSpeed::kTwoAxesAccurate) return {1'414'213'562, 1'000'000'000};  // [assumed: the exact root]
  return pulsing == 2 || vector == VectorSpeed::kTwoAxes ? Ratio{1414, 1000} : Ratio{1732, 1000};
}

/// Time over one pulse from speed v0 to v1, going up with accel to at most `cap` and down with decel in between.
double pulse_time_s(double v0, double v1, double accel, double decel, double cap) {
  const double free_peak2 = (2 * accel * decel + decel * v0 * v0 + accel * v1 * v1) / (accel + decel);
  const double peak = std::clamp(std::sqrt(free_peak2), std::max(v0, v1), std::max({cap, v0, v1}));
  const double ramps = (peak * peak - v0 * v0) / (2 * accel) + (peak * peak - v1 * v1) / (2 * decel);
  return (peak - v0) / accel + (peak - v1) / decel + std::max(0.0, 1 - ramps) / peak;
}

}  // namespace

double seconds(Time time) { return static_cast<double>(time) / static_cast<double>(std::int64_t{1} << kFractionBits) / kClockHz; }

Time time_from_seconds(double seconds) { return static_cast<Time>(std::round(seconds * kClockHz * static_cast<double>(std::int64_t{1} << kFractionBits))); }

Speed::Speed(const SpeedSetting& setting) : setting_(setting) {
  speed_pps_ = static_cast<double>(ramps() ? setting.initial_pps : setting.drive_pps);
}

double Speed::decel() const { return static_cast<double>(setting_.decel_pps2 > 0 ? setting_.decel_pps2 : setting_.accel_pps2); }

/// Speed at the end of the next event.
double Speed::end_speed(std::uint64_t remaining) const {
  const double sv = static_cast<double>(setting_.initial_pps), dv = static_cast<double>(setting_.drive_pps);
  const double v2 = speed_pps_ * speed_pps_;
  double end2 = speed_pps_ > dv ? std::max(dv * dv, v2 - 2 * decel()) : std::min(dv * dv, v2 + 2 * static_cast<double>(setting_.accel_pps2));
  if (setting_.decelerates) end2 = std::min(end2, sv * sv + 2 * decel() * static_cast<double>(remaining - 1));
  if (stopping_) end2 = std::max(sv * sv, v2 - 2 * decel());
  return std::sqrt(end2);
}

Time Speed::take(int pulsing, std::uint64_t remaining) {
  const double end = ramps() ? end_speed(remaining) : speed_pps_;
  if (end == speed_pps_ && at_drive_speed()) return constant_period(pulsing);
  const double cap = stopping_ ? speed_pps_ : static_cast<double>(setting_.drive_pps);
  const double time_s = pulse_time_s(speed_pps_, end, static_cast<double>(setting_.accel_pps2), decel(), cap);
  speed_pps_ = end;
  const Ratio ratio = stretch(setting_.vector, pulsing);
  return time_from_seconds(time_s * static_cast<double>(ratio.numerator) / static_cast<double>(ratio.denominator));
}

Time Speed::constant_period(int pulsing) const {
  const Ratio ratio = stretch(setting_.vector, pulsing);
  const Time divisor = static_cast<Time>(ratio.denominator) * setting_.drive_pps;
  return (time_from_clocks(16'000'000) * ratio.numerator + divisor / 2) / divisor;
}

std::uint64_t Speed::constant_events(std::uint64_t remaining) const {
  if (!ramps()) return stopping_ ? 0 : remaining;
  if (stopping_ || !at_drive_speed()) return 0;
  if (!setting_.decelerates) return remaining;
  const double sv = static_cast<double>(setting_.initial_pps);
  const double ramp_events = std::ceil((speed_pps_ * speed_pps_ - sv * sv) / (2 * decel())) + 2;
  return static_cast<double>(remaining) > ramp_events ? remaining - static_cast<std::uint64_t>(ramp_events) : 0;
}

void Speed::change_drive_speed(std::int64_t drive_pps) {
  setting_.drive_pps = drive_pps;
  if (!ramps()) speed_pps_ = static_cast<double>(drive_pps);
}

void Speed::begin_stop() { stopping_ = true; }

}  // namespace pmac::drives::mcx514
