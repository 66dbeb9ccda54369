// Hop 8 as the pipeline sees it: when the segments of the path are executed. One of two: the time-optimal lookahead (lookahead.h), or the
// one that limits jerk as well (jerk_lookahead.h).
#pragma once

#include <vector>

#include "runtime/motion/segment.h"

namespace pmac::motion {

class TimeLaw {
 public:
  virtual ~TimeLaw() = default;

  /// The next segment; appends those that are now committed. Amortised constant cost.
  virtual void add(Segment segment, std::vector<TimedSegment>& out) = 0;
  /// The path ends here: commits everything. The next segment begins a new path.
  virtual void finish(std::vector<TimedSegment>& out) = 0;

  /// Programmed time that is planned but not yet committed.
  virtual double planned_ms() const = 0;
  /// So much of it before anything is committed.
  virtual double needed_ms() const = 0;
  virtual double window_ms() const = 0;
};

}  // namespace pmac::motion
