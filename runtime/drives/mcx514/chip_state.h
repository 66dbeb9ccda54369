// What chip.h keeps hidden: the settings of an axis and the drives under way.
#pragma once

#include <map>

#include "runtime/drives/mcx514/chip.h"

namespace pmac::drives::mcx514 {

inline constexpr std::size_t kPreBuffer = 8;                 // segments
inline constexpr std::int64_t kContinuousLimit_pps = 4'000'000;

struct Chip::Axis {
  std::map<std::uint8_t, Setting> settings;                   // by command code
  std::int64_t real_position = 0;                             // keeps what is written; nothing counts it
  std::array<std::uint16_t, 4> mode{};                        // WR1, WR2, WR3 at 1 to 3
  std::uint16_t status = 0;                                   // RR2

  const Setting& get(std::uint8_t code) const {
    static const Setting none;
    const auto at = settings.find(code);
    return at == settings.end() ? none : at->second;
  }
};

struct Chip::Segment {
  std::unique_ptr<Interpolator> pulses;
  std::uint8_t code = 0;
  std::uint32_t axes = 0;             // that it moves
  std::uint32_t stretching = 0;       // whose simultaneous pulses stretch the event
  Place place;
};

struct Chip::Running {
  Segment segment;
  Speed speed;
  Time next = 0;                      // of its next event; of its end, when the pulses are done
  std::uint64_t remaining = 0;        // events of this segment and those that wait; used where it decelerates
  bool counts_remaining = false;
  bool closely = false;               // every event is made
  DriveRecord record;
};

inline std::string axis_name(std::size_t axis) { return std::string(1, kAxisNames[axis]); }
inline bool has_axis(std::uint32_t mask, std::size_t axis) { return (mask >> axis & 1u) != 0; }
std::string axes_text(std::uint32_t mask);

namespace rr2 {
inline constexpr std::uint16_t kContinuousError = 1u << 7;
}

}  // namespace pmac::drives::mcx514
