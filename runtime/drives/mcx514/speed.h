// When the events of a drive happen. Time is counted in clocks of 1/16 MHz, with a fraction so fine that it does not drift.
//
//   speed
//   DV  |     ________
//       |    /        \           from SV with AC to DV; with DC back to SV at the end, where deceleration is enabled
//   SV  |___/          \___       constant at DV where SV >= DV
//       +------------------ time
//
// An event at speed v lasts 1/v; in an event in which several axes pulse, constant vector speed stretches that by 1.414 (two axes) or
// 1.732 (three). Event k of a drive happens at the sum of what the events before it last. MCX514 manual p111.
#pragma once

#include <array>
#include <cstdint>

#include "runtime/drives/mcx514/interpolator.h"

namespace pmac::drives::mcx514 {

inline constexpr double kClockHz = 16e6;
inline constexpr int kFractionBits = 40;

/// Clocks with kFractionBits of fraction.
__extension__ typedef __int128 Time;

constexpr Time time_from_clocks(std::int64_t clocks) { return static_cast<Time>(clocks) << kFractionBits; }
double seconds(Time time);
/// Rounded to the nearest; seconds >= 0.
Time time_from_seconds(double seconds);

/// D7-D6 of the interpolation mode.
enum class VectorSpeed : std::uint8_t { kOff, kTwoAxes, kThreeAxes, kTwoAxesAccurate };

struct SpeedSetting {
  std::int64_t initial_pps = 0, drive_pps = 0;       // SV, DV
  std::int64_t accel_pps2 = 0, decel_pps2 = 0;       // AC, DC; 0: not set, only where SV >= DV
  bool decelerates = false;                          // to SV at the end of the drive
  VectorSpeed vector = VectorSpeed::kOff;
};

class Speed {
 public:
  Speed() = default;
  explicit Speed(const SpeedSetting& setting);

  /// How long the next event lasts, in which `pulsing` axes pulse; `remaining` events are to come, this one included.
  Time take(int pulsing, std::uint64_t remaining);
  /// So many events from here last alike, the speed being constant; all when nothing ever changes.
  std::uint64_t constant_events(std::uint64_t remaining) const;
  /// What an event lasts at the present constant speed.
  Time constant_period(int pulsing) const;

  /// DV is written while driving.
  void change_drive_speed(std::int64_t drive_pps);
  void enable_deceleration(bool enabled) { setting_.decelerates = enabled; }
  /// Down to SV, and end there: finished() says when. At once where there are no ramps.
  void begin_stop();
  bool finished() const { return stopping_ && (!ramps() || speed_pps_ <= static_cast<double>(setting_.initial_pps)); }

  double now_pps() const { return speed_pps_; }

 private:
  bool ramps() const { return setting_.initial_pps < setting_.drive_pps && setting_.accel_pps2 > 0; }
  double decel() const;
  double end_speed(std::uint64_t remaining) const;
  bool at_drive_speed() const { return speed_pps_ == static_cast<double>(setting_.drive_pps); }

  SpeedSetting setting_;
  double speed_pps_ = 1;
  bool stopping_ = false;
};

}  // namespace pmac::drives::mcx514
