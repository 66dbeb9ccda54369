// Spline moves: a cubic B-spline over the programmed points, turned into pvt moves. A point is passed at the weighted mean of itself
// and its neighbours, with the velocity that makes acceleration continuous; a segment without distance before the first and after the
// last point brings both to rest exactly there. n points of T each take (n + 2) T. Source: Turbo User Manual p290; unequal times are
// the non-uniform B-spline (inferred).
//
//   time between points   a     b     c     d
//                  ... Q0 -- Q1 -- Q2 -- Q3 ...   at Q1: weights of Q0, Q1, Q2 from b, c and their neighbours
#pragma once

#include <deque>
#include <vector>

#include "runtime/motion/types.h"

namespace pmac::motion {

class Spline {
 public:
  /// The next point (target_uu) and its time (move_time_ms); start_uu: where the program stands, at rest before the first point.
  /// Appends the pvt moves that are decided now. The id of the move to a point is the command's plus 1, of the move before the first
  /// point the first command's own, and of the one after the last point its plus 2.
  void add(const MotionCommand& command, const AxisVector& start_uu, std::vector<MotionCommand>& out);
  /// The last point has been added: what remains, to rest there.
  void finish(std::vector<MotionCommand>& out);
  bool empty() const { return knots_.empty(); }
  void cancel() { *this = {}; }

 private:
  /// A point, the time of the segment that ends there, and the command that the segment belongs to.
  struct Knot { AxisVector point; double time_ms; MotionCommand command; };
  void push(const AxisVector& point, const MotionCommand& command, std::vector<MotionCommand>& out);

  std::deque<Knot> knots_;   // the last five; the segment between the third and the fourth is decided with the fifth
  std::uint32_t axes_ = 0;   // named since the start
};

}  // namespace pmac::motion
