// Which limit governed a move: what its block time was made from, and how much of its time each motor limit held it back. For reports
// only; nothing of it changes the motion.
#pragma once

#include <deque>
#include <string_view>
#include <vector>

#include "runtime/motion/segment.h"

namespace pmac::motion {

/// "F", "tm", "ta and ts", ...
std::string_view time_rule_name(TimeRule rule);

class Governing {
 public:
  /// limits: [motor] in the order of the map, empty where they do not act; the numbers of the motors.
  void reset(std::vector<MotorLimits> limits, std::vector<int> motors);
  /// A segment as it will be executed, in order.
  void cover(const TimedSegment& segment);
  /// Time by limit of a move whose segments are all covered; longest first. Forgets it and what was before it.
  std::vector<GoverningShare> take(std::uint64_t command);

 private:
  struct Account { std::uint64_t command; std::vector<GoverningShare> shares; };
  GoverningShare limit_of(const TimedSegment& segment) const;

  std::vector<MotorLimits> limits_;
  std::vector<int> motors_;
  std::deque<Account> accounts_;
};

}  // namespace pmac::motion
