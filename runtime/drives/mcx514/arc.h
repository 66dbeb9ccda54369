// Circular interpolation, and the same with further axes running along (helical). MCX514 manual p113-114, 3.2.1.
//
// An event moves the short axis of the quadrant by one pulse; the long axis follows where that brings the point nearer to the circle:
// with F = x^2 + y^2 - R^2, the smaller |F|. F starts at 0 and stays odd or even with the position, so that no tie is possible and the
// pulses are determined by centre, finish point and direction alone. The manual promises an error within 1 pulse; this rule keeps it
// below 0.5. [assumed: the chip's own rule is not published]
//
// In the quadrant of the finish point the motion ends where the short axis has reached the finish point's coordinate; the long axis is not
// looked at. Where it cannot reach it, the motion ends with the quadrant.
#pragma once

#include "runtime/drives/mcx514/interpolator.h"
#include "runtime/drives/mcx514/octant.h"

namespace pmac::drives::mcx514 {

struct ArcSetting {
  Plane center, finish;          // relative to the start; centre not (0,0), all within kLargestDistance
  bool clockwise = false;
  int further_turns = 0;         // full turns before the finish point counts (helical)
  std::array<int, 2> axis{0, 1}; // ax1, ax2
};

class Arc : public Interpolator {
 public:
  explicit Arc(const ArcSetting& setting);

  Event next() override;
  Skip skip(std::uint64_t most) override;
  std::uint64_t remaining() const override;
  const std::vector<int>& quadrants() const override { return visited_; }
  std::optional<ErrorRange> error() const override;
  double error_now() const override { return radial_error(f_); }
  double radius() const;

 private:
  std::int64_t short_distance_to_finish() const;
  bool at_or_past_finish() const { return short_distance_to_finish() <= 0; }
  bool leaves_octant() const;
  void enter(int octant);
  void settle();
  std::uint64_t events_to_pass() const;
  void pass(std::uint64_t events, Skip& total);
  double radial_error(std::int64_t f) const;

  ArcSetting setting_;
  std::array<std::int64_t, 2> at_{};      // relative to the centre
  std::array<std::int64_t, 2> finish_{};  // likewise
  std::int64_t r2_ = 0, f_ = 0, f_low_ = 0, f_high_ = 0;
  int octant_ = 0;
  OctantRun run_;
  std::int64_t left_ = 0;                 // octants to go until that of the finish point
  std::vector<int> visited_;
  bool passed_over_ = false;
};

/// Largest |radial error| that the rule of the finish point can leave along the long axis: distance of the finish point from the circle.
double finish_off_circle(const ArcSetting& setting);

/// The integer nearest to the square root; value >= 0.
std::int64_t rounded_root(std::int64_t value);

/// A circle of the first two axes with others stepping evenly over its events.
class Helix : public Interpolator {
 public:
  /// along: pulses of the further axes, circle axes 0. circle_events: over which they are spread (the helical calculation value), at least
  /// as many as the pulses of each.
  Helix(const ArcSetting& setting, const AxisCounts& along, std::int64_t circle_events);

  Event next() override;
  std::uint64_t remaining() const override { return arc_.remaining(); }
  const std::vector<int>& quadrants() const override { return arc_.quadrants(); }
  std::optional<ErrorRange> error() const override { return arc_.error(); }
  double error_now() const override { return arc_.error_now(); }

 private:
  Arc arc_;
  AxisCounts along_, left_, sum_{};
  std::int64_t circle_events_;
};

}  // namespace pmac::drives::mcx514
