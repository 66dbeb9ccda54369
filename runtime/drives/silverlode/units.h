// Units of the SilverLode servos and the ranges of what a queued move is given in.
//
// Source: QuickSilver application note "Make Circles", Building Circular Interpolation Table (units); technical document TD044 (ranges).
#pragma once

#include <cmath>
#include <cstdint>

namespace pmac::drives::silverlode {

inline constexpr double kTick_s = 0.00012;                 // one servo cycle
inline constexpr double kNoteTicksPerSecond = 8333;        // as the note's program rounds 1 / 0.00012
inline constexpr double kCountsPerRev = 4000;
inline constexpr double kUnitsPerCount = 67'108'864.0;     // 2^26: positions are 2^-26 count, velocities that per tick
inline constexpr std::int64_t kUnitsPerCountInt = 1 << 26;

inline constexpr std::int64_t kMostTicks = 2'147'483'647;      // 2^31 - 1
inline constexpr std::int64_t kMostVelocity = 2'147'483'647;   // SVU: 32 counts a tick, 4000 rpm
inline constexpr std::int64_t kMostAcceleration = 1'073'741'823;  // SAU: 16 counts a tick^2
inline constexpr std::int64_t kFarPosition = 1'073'741'824;    // counts: a position that is never reached gives the direction alone

inline double counts_s_from_rpm(double rpm) { return rpm / 60 * kCountsPerRev; }
/// Velocity of a queued move.
inline double svu_from_counts_s(double counts_s) { return counts_s * kTick_s * kUnitsPerCount; }
/// Acceleration of a queued move.
inline double sau_from_counts_s2(double counts_s2) { return counts_s2 * kTick_s * kTick_s * kUnitsPerCount; }
inline double counts_s_from_svu(double svu) { return svu / kUnitsPerCount / kTick_s; }

}  // namespace pmac::drives::silverlode
