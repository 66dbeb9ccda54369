// What a coordinate system remembers from line to line (modes), the move block that is being collected, and how the two become
// a motion command.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "compiler/bytecode/bytecode.h"
#include "runtime/element_store.h"
#include "runtime/fault.h"
#include "runtime/motion/types.h"

namespace pmac::runtime {

using motion::AxisVector;

inline constexpr std::uint32_t kAllAxes = 0xffffffffu;
inline constexpr std::uint32_t kDefaultFeedAxes = 1u << 6 | 1u << 7 | 1u << 8;  // X Y Z

/// Modes of a coordinate system; they survive the end of a program. Reset values: User's Manual p665-742.
struct ModalState {
  bytecode::MoveMode mode = bytecode::MoveMode::kLinear;
  std::uint32_t absolute_axes = kAllAxes;
  bool absolute_center = false;
  std::uint32_t feed_axes = kDefaultFeedAxes, feed_axes2 = 0;
  std::array<double, 3> normal{0, 0, -1}, second_normal{0, 0, -1};  // of X Y Z, of XX YY ZZ
  int compensation_side = 0;      // ccmode: 0 off, 1 left, 2 right
  double compensation_radius_uu = 0;
  double pvt_time_ms = 0;
  std::array<double, 3> spline_time_ms{};
};

/// The words of a move block so far.
struct OpenBlock {
  std::uint32_t axes = 0;
  AxisVector value{};             // position or distance, as programmed
  std::uint32_t trigger_axes = 0, velocity_axes = 0;
  AxisVector trigger{};           // distance from the trigger
  AxisVector velocity{};          // of pvt, axis units per FeedTime
  std::array<double, 6> center{};
  unsigned center_words = 0;      // mask of I J K II JJ KK
  bool has_radius = false;
  double radius = 0;
  bool empty() const { return axes == 0 && center_words == 0 && !has_radius; }
  void add(bytecode::WordKind kind, int index, double word);
  /// No words; what their masks do not name stays in the arrays.
  void clear() {
    axes = trigger_axes = velocity_axes = center_words = 0;
    has_radius = false;
    radius = 0;
  }
};

/// Absolute end point of the block from the calculated position; axes with a rollover (Coord[].PosRollOver) go the short way.
AxisVector block_target(const ModalState& modal, const OpenBlock& block, const AxisVector& from_uu, const ElementStore& elements,
                        int coord);

/// The words that cannot be used in this mode, or a value that is not finite; nullopt: fine.
std::optional<Fault> check_block(const ModalState& modal, const OpenBlock& block, bytecode::SourceLine source);

/// The motion command of a linear or circle block. from_uu: calculated position. Id and no_blend are the caller's.
motion::MotionCommand block_command(const ModalState& modal, const OpenBlock& block, const AxisVector& from_uu,
                                    const ElementStore& elements, int coord, bytecode::SourceLine source);

/// pvt and spline times, ms.
std::optional<Fault> set_segment_time(bytecode::MotionParameter parameter, double value, ModalState& modal, bytecode::SourceLine source);

/// ccr and ccmode.
std::optional<Fault> set_compensation(bytecode::MotionParameter parameter, double value, ModalState& modal, bytecode::SourceLine source);

/// Coord[].Ta, Td, Ts, Tsd, Tm, F of a SetMotion instruction; ta sets td too, ts sets tsd too.
std::optional<Fault> set_motion_parameter(bytecode::MotionParameter parameter, double value, ElementStore& elements, int coord,
                                          bytecode::SourceLine source);

}  // namespace pmac::runtime
