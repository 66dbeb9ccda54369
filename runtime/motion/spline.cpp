#include "runtime/motion/spline.h"

#include <fmt/format.h>

#include "runtime/motion/axis_vector.h"

namespace pmac::motion {
namespace {

struct State { AxisVector position, velocity; };

/// Position and velocity at `at`: a is the time before the segment from `before`, b of that segment, c of the next, d after it.
State state_at(const AxisVector& before, const AxisVector& at, const AxisVector& after, double a, double b, double c, double d) {
  const double alpha = c * c / ((b + c) * (a + b + c)), gamma = b * b / ((b + c) * (b + c + d));
  State state;
  for (std::size_t axis = 0; axis < at.size(); ++axis) {
    const double in = at[axis] - before[axis], out = after[axis] - at[axis];
    state.position[axis] = at[axis] - alpha * in + gamma * out;
    state.velocity[axis] = 3 * (c * in / ((b + c) * (a + b + c)) + b * out / ((b + c) * (b + c + d)));
  }
  return state;
}

}  // namespace

std::string Spline::misfit(const SplineTimes& times_ms) const {
  const auto is_single = [](const SplineTimes& t) { return t[0] == t[1] && t[1] == t[2]; };
  if (knots_.empty()) return {};
  if (!is_single(times_ms) && times_ms[0] != times_ms_[1])
    return fmt::format("the first of three spline times is that of the segment before, which takes {:g} ms, not {:g}", times_ms_[1], times_ms[0]);
  if (!is_single(times_ms_) && times_ms_[2] != times_ms[1])
    return fmt::format("the block before says with its third spline time that this segment takes {:g} ms, not {:g}", times_ms_[2], times_ms[1]);
  return {};
}

void Spline::add(const MotionCommand& command, const SplineTimes& times_ms, const AxisVector& start_uu, std::vector<MotionCommand>& out) {
  axes_ |= command.axes;
  if (knots_.empty())
    for (int i = 0; i < 4; ++i) push(start_uu, times_ms[0], command, out);
  times_ms_ = times_ms;
  MotionCommand to_point = command;
  to_point.id = command.id + 1;
  push(command.target_uu, times_ms[1], to_point, out);
}

void Spline::finish(std::vector<MotionCommand>& out) {
  if (knots_.empty()) return;
  MotionCommand rest = knots_.back().command;
  rest.id += 1;
  const AxisVector end = knots_.back().point;
  const double after_ms = times_ms_[2];
  for (int i = 0; i < 3; ++i) push(end, after_ms, rest, out);
  cancel();
}

/// With knots 0 .. 5 the segment from 2 to 3 is known: its ends need the times of one segment more on either side.
void Spline::push(const AxisVector& point, double time_ms, const MotionCommand& command, std::vector<MotionCommand>& out) {
  knots_.push_back({point, time_ms, command});
  if (knots_.size() < 6) return;
  const auto& k = knots_;
  const State from = state_at(k[1].point, k[2].point, k[3].point, k[1].time_ms, k[2].time_ms, k[3].time_ms, k[4].time_ms);
  const State to = state_at(k[2].point, k[3].point, k[4].point, k[2].time_ms, k[3].time_ms, k[4].time_ms, k[5].time_ms);
  MotionCommand segment = k[3].command;
  segment.kind = CommandKind::kPvt;
  segment.move_time_ms = k[3].time_ms;
  segment.axes = axes_;
  segment.target_uu = to.position;
  segment.start_velocity_uu_ms = from.velocity;
  segment.end_velocity_uu_ms = to.velocity;
  out.push_back(std::move(segment));
  knots_.pop_front();
}

}  // namespace pmac::motion
