// What a card does, command by command, without running it: branches are followed, parameters computed, relays kept, and the result is
// the row of its motions. A loop that comes back to the same state is followed once.
#pragma once

#include <string>
#include <vector>

#include "compiler/ir/ir.h"
#include "compiler/source/source.h"

namespace pmac::compiler::translate {

enum class CardMotionKind : std::uint8_t { kMoveTo, kMoveBy, kCircle };

/// One MOV or CIRCLE with everything that it latches. Pulses, and rates as the program writes them.
struct CardMotion {
  CardMotionKind kind = CardMotionKind::kMoveTo;
  double target = 0;                                     // of kMoveTo, or the increment
  double direction = 1, radius = 0, i = 0, j = 0, distance = 0;  // of kCircle
  double end_point = 0;                                  // P29
  double master_length = 0;                              // P28; 0: the card moves by itself
  double vel = 0, acc = 0, dec = 0, stp = 0;
  bool waited = false;                                   // the program has waited for the end of the motion before
  source::Span span;
  std::int64_t line = -1;                                // stored line, or -1
};

struct CardTrace {
  std::string axis;
  std::vector<CardMotion> motions;
};

struct TraceRules {
  std::int64_t busy_relay = 96;
  std::size_t max_motions = 1'000'000;
  std::size_t max_steps = 20'000'000;
};

/// Follows one card. What has no counterpart in a motion program is a warning ACR-W10 at its place, once; what would be an error when the
/// card runs is one here.
CardTrace trace_card(const ir::Unit& unit, const TraceRules& rules, const std::vector<std::int64_t>& relays_set, source::Diagnostics& diagnostics);

}  // namespace pmac::compiler::translate
