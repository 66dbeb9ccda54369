// Slow and plain: a blended sequence of straight moves, velocity by velocity. Each move contributes its velocity times
// (its ramp in - its ramp out); the velocity is integrated in small steps. No path pieces, no closed forms of position.
#pragma once

#include <cmath>
#include <vector>

namespace pmac::reference {

struct BlendMove {
  double dx, dy;     // displacement
  double tm_ms;      // time at constant speed
  double ta_ms, ts_ms;
};

/// ta >= ts; r as a function of time since the start of the ramp.
inline double ramp(double t, double ta, double ts) {
  const double total = ta + ts;
  if (t <= 0) return total > 0 ? 0 : (t < 0 ? 0 : 1);
  if (t >= total) return 1;
  if (t < ts) return t * t / (2 * ts * ta);
  if (t <= ta) return (t - ts / 2) / ta;
  return 1 - (total - t) * (total - t) / (2 * ts * ta);
}

struct BlendPoint { double t_ms, x, y, vx, vy; };

/// Points every step_ms, Simpson's rule within a step. All moves with their own ta and ts; the last one's also for the stop.
inline std::vector<BlendPoint> blend(const std::vector<BlendMove>& moves, double step_ms) {
  std::vector<double> boundary{(moves[0].ta_ms + moves[0].ts_ms) / 2};
  for (const BlendMove& move : moves) boundary.push_back(boundary.back() + move.tm_ms);
  const auto ramp_into = [&](std::size_t i, double t) {
    const BlendMove& m = moves[std::min(i, moves.size() - 1)];
    return ramp(t - (boundary[i] - (m.ta_ms + m.ts_ms) / 2), m.ta_ms, m.ts_ms);
  };
  const auto velocity = [&](double t, double& vx, double& vy) {
    vx = vy = 0;
    for (std::size_t i = 0; i < moves.size(); ++i) {
      const double share = ramp_into(i, t) - ramp_into(i + 1, t);
      vx += moves[i].dx / moves[i].tm_ms * share;
      vy += moves[i].dy / moves[i].tm_ms * share;
    }
  };
  std::vector<BlendPoint> points{{0, 0, 0, 0, 0}};
  const double end = boundary.back() + (moves.back().ta_ms + moves.back().ts_ms) / 2;
  while (points.back().t_ms < end) {
    const BlendPoint& p = points.back();
    BlendPoint next{p.t_ms + step_ms, 0, 0, 0, 0};
    double ax, ay, mx, my;
    velocity(p.t_ms, ax, ay);
    velocity(p.t_ms + step_ms / 2, mx, my);
    velocity(next.t_ms, next.vx, next.vy);
    next.x = p.x + step_ms / 6 * (ax + 4 * mx + next.vx);
    next.y = p.y + step_ms / 6 * (ay + 4 * my + next.vy);
    points.push_back(next);
  }
  return points;
}

}  // namespace pmac::reference
