// What holds of every random motion program, whatever its modes: run as pmac-run runs it, judged from the servo samples alone.
#pragma once

#include <optional>
#include <string>

#include "tests/reference/random_motion.h"
#include "tests/unit/programs/bench.h"

namespace pmac::test {

/// The servo samples of a run and what the machine said.
struct MotionRun {
  double period_ms = 0;
  std::vector<std::array<double, 3>> position_mu;   // motors 1 to 3
  std::vector<runtime::MoveRecord> moves;
  std::string fault;
};

using CommandObserver = std::function<void(int coord, const motion::MotionCommand&)>;

/// set_up: put before the program, e.g. another servo period. observer: of the moves, as they are calculated.
MotionRun run_motion(const std::string& text, const std::string& set_up = "", const std::string& commands = "&1 b1r", CommandObserver observer = {});

/// Each answers what is wrong, or empty.
std::string wrong_end(const reference::RandomMotion& motion, const MotionRun& run);
std::string wrong_dwell(const reference::RandomMotion& motion, const MotionRun& run);
std::string wrong_lengths(const reference::RandomMotion& motion, const MotionRun& run);
/// Times of moves: none ends before it starts, all in order.
std::string wrong_times(const MotionRun& run);
/// Without lookahead: a pvt block takes the time that it says.
std::string wrong_pvt_times(const reference::RandomMotion& motion, const MotionRun& run);
/// Beyond 1.001 times a limit of the set-up.
std::string broken_limit(const reference::MotionSetUp& set_up, const MotionRun& run);
/// A step in position or speed stays what it is when one looks more closely: fine is the same program at a shorter servo period.
std::string step_in_motion(const MotionRun& coarse, const MotionRun& fine);
std::string difference(const MotionRun& a, const MotionRun& b);

}  // namespace pmac::test
