// Spline moves: a cubic B-spline over the programmed points, turned into pvt moves. A point is passed at the weighted mean of itself
// and its neighbours, with the velocity that makes acceleration continuous; a segment without distance before the first and after the
// last point brings both to rest exactly there. n points of T each take (n + 2) T. Source: Turbo User Manual p290; unequal times are
// the non-uniform B-spline (inferred).
//
// A block may have three times: of the segment before it, of its own, and of the one after it (inferred). They have to fit those of its
// neighbours; before the first and after the last point they are the times of the segments without distance.
//
//   time between points   a     b     c     d
//                  ... Q0 -- Q1 -- Q2 -- Q3 ...   at Q1: weights of Q0, Q1, Q2 from b, c and their neighbours
#pragma once

#include <array>
#include <deque>
#include <string>
#include <vector>

#include "runtime/motion/types.h"

namespace pmac::motion {

/// Of the segment before a block, its own, and the one after it; ms. All the same where the program gives one.
using SplineTimes = std::array<double, 3>;

class Spline {
 public:
  /// Why a block of these times cannot follow; empty if it can.
  std::string misfit(const SplineTimes& times_ms) const;
  /// The next point (target_uu) and its times; start_uu: where the program stands, at rest before the first point.
  /// Appends the pvt moves that are decided now. The id of the move to a point is the command's plus 1, of the move before the first
  /// point the first command's own, and of the one after the last point its plus 2.
  void add(const MotionCommand& command, const SplineTimes& times_ms, const AxisVector& start_uu, std::vector<MotionCommand>& out);
  /// The last point has been added: what remains, to rest there.
  void finish(std::vector<MotionCommand>& out);
  bool empty() const { return knots_.empty(); }
  void cancel() { *this = {}; }

 private:
  /// A point, the time of the segment that ends there, and the command that the segment belongs to.
  struct Knot { AxisVector point; double time_ms; MotionCommand command; };
  void push(const AxisVector& point, double time_ms, const MotionCommand& command, std::vector<MotionCommand>& out);

  std::deque<Knot> knots_;   // the last five; the segment between the third and the fourth is decided with the fifth
  std::uint32_t axes_ = 0;   // named since the start
  SplineTimes times_ms_{};   // of the last block
};

}  // namespace pmac::motion
