// On request: the common lookahead (runtime/motion/lookahead.h) over the path that the cards draw together. The path stays, its time is
// stretched until every axis keeps its limits of speed and acceleration; corners that the cards take with a step in speed become
// stops or slow passages. A real card knows no such thing: programs, relays and timed commands keep their own, unstretched time.
#pragma once

#include <deque>
#include <memory>
#include <vector>

#include "runtime/acr1000/sampler.h"
#include "runtime/motion/lookahead.h"

namespace pmac::acr1000 {

/// 0: no limit.
struct AxisLimits { double speed_pulses_s = 0, accel_pulses_s2 = 0; };

class PathLookahead {
 public:
  /// limits: [card]. segment: told of every stretched segment where given, for printing.
  PathLookahead(const CardSystem& system, const std::vector<AxisLimits>& limits, double period_s, SampleTaker taker,
                std::function<void(const motion::TimedSegment&)> segment = {});
  /// SystemObservers::stretch.
  void stretch(double from_s, double to_s);
  /// The run is over.
  void finish();

  /// When the stretched motion comes to what the cards do at programmed_s, an instant at which a stretch begins or ends.
  double stretched_s(double programmed_s) const;
  double end_s() const { return end_ms_ / 1000; }

 private:
  void add_segment(double from_s, double to_s);
  void take_timed();
  void sample(const motion::TimedSegment& timed);
  void take_rest();
  void note(double programmed_ms, double time_ms);

  const CardSystem& system_;
  SampleClock clock_;
  SampleTaker taker_;
  std::function<void(const motion::TimedSegment&)> segment_;
  motion::Lookahead lookahead_;
  std::vector<motion::TimedSegment> timed_;
  std::vector<MotionPoint> points_;
  struct Mark { double programmed_ms, time_ms; };
  std::vector<Mark> marks_;             // ends of stretches whose time is known
  std::deque<double> stretch_ends_ms_;  // programmed, not reached yet
  double end_ms_ = 0;
};

}  // namespace pmac::acr1000
