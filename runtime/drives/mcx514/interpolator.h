// What makes the pulses of a drive, one event after the other. In an event each axis steps by one pulse, in either direction, or stands.
// The interpolators know nothing of time (speed.h) and of registers (chip.h). Positions are pulses, relative to where the drive began.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

namespace pmac::drives::mcx514 {

/// Axes in the order of priority: X, Y, Z, U.
inline constexpr int kAxes = 4;
inline constexpr std::string_view kAxisNames = "XYZU";
using AxisCounts = std::array<std::int64_t, kAxes>;

/// Largest relative finish point and centre, either sign.
inline constexpr std::int64_t kLargestDistance = 1'073'741'823;

struct Event { std::array<std::int8_t, kAxes> step{}; };

/// Events passed over at once. doubles: how many of them move two axes.
struct Skip { std::uint64_t events = 0; std::uint64_t doubles = 0; AxisCounts steps{}; };

/// Why a drive ended.
enum class Stop : std::uint8_t { kRunning, kFinishPoint, kShortAxis, kEndOfQuadrant, kEndOfPattern, kDecelerated, kInstant, kUnderrun };
std::string_view stop_text(Stop stop);

struct ErrorRange { double low = 0, high = 0; };

class Interpolator {
 public:
  virtual ~Interpolator() = default;
  Stop stop() const { return stop_; }
  bool done() const { return stop_ != Stop::kRunning; }
  /// The next event. Only while not done.
  virtual Event next() = 0;
  /// Passes over up to `most` events at once where that is possible, else over none. The end is never among them.
  virtual Skip skip(std::uint64_t /*most*/) { return {}; }
  /// Events that are still to come; the largest number where there is no end.
  virtual std::uint64_t remaining() const = 0;
  /// Quadrants 0 to 7 of a circle in the order in which they were entered; empty for others.
  virtual const std::vector<int>& quadrants() const;
  /// Distance from the ideal curve over the events so far, in pulses: radial for a circle, along the short axis for a line. nullopt where
  /// events were passed over.
  virtual std::optional<ErrorRange> error() const { return std::nullopt; }
  /// The same after the last event.
  virtual double error_now() const { return 0; }

 protected:
  Stop stop_ = Stop::kRunning;
};

}  // namespace pmac::drives::mcx514
