#include "runtime/motion/rate_limits.h"

#include <algorithm>
#include <cmath>

namespace pmac::motion {
namespace {


/// x0 may lie on the border of what is possible, and beyond it by rounding; a row that hardly depends on x1 must not make
/// a small x1 of that.
constexpr double kRoundingRoom = 1e-6;
/// Borders whose directions differ by less are parallel: where they cross is all rounding.
constexpr double kParallel = 1e-10;

double largest_speed(const MotorCubic& q, double h) {
  double speed = std::max(std::abs(q.c1), std::abs(q.velocity(h)));
  const double extreme = q.c3 == 0 ? -1 : -q.c2 / (3 * q.c3);
  if (extreme > 0 && extreme < h) speed = std::max(speed, std::abs(q.velocity(extreme)));
  return speed;
}

void add_acceleration_rows(const MotorCubic& q, double h, double inv_accel, std::vector<RateRow>& rows) {
  const double d0 = q.c1, d1 = q.c1 + h * q.c2, d2 = q.velocity(h);   // Bernstein coefficients of q'
  const double e0 = 2 * q.c2, e1 = q.acceleration(h);                 // and of q''
  const double k = 1 / (2 * h);
  const auto add = [&](double start, double end) { rows.push_back({start * inv_accel, end * inv_accel}); };
  add(e0 - d0 * k, d0 * k);
  add(e1 / 2 - d1 * k, e0 / 2 + d1 * k);
  add(-d2 * k, e1 + d2 * k);
}

struct Point { double x0, x1; };
struct HalfPlane { double a0, a1, bound; };   // a0 x0 + a1 x1 <= bound

/// Point with the largest x0 (then the largest x1) on the border of `line` inside the half-planes before it. The origin is
/// inside all of them, so there is one but for rounding.
Point best_on_line(const HalfPlane& line, const std::vector<HalfPlane>& planes, std::size_t count) {
  const double square = line.a0 * line.a0 + line.a1 * line.a1;
  const Point base{line.a0 * line.bound / square, line.a1 * line.bound / square};
  Point way{-line.a1, line.a0};
  if (way.x0 < 0 || (way.x0 == 0 && way.x1 < 0)) way = {-way.x0, -way.x1};
  double low = -1e300, high = 1e300;
  for (std::size_t i = 0; i < count; ++i) {
    const double slope = planes[i].a0 * way.x0 + planes[i].a1 * way.x1;
    const double room = planes[i].bound - planes[i].a0 * base.x0 - planes[i].a1 * base.x1;
    const double parallel = kParallel * (std::abs(planes[i].a0 * way.x0) + std::abs(planes[i].a1 * way.x1));
    if (slope > parallel) high = std::min(high, room / slope);
    if (slope < -parallel) low = std::max(low, room / slope);
  }
  const double t = std::max(low, high);
  return {base.x0 + t * way.x0, base.x1 + t * way.x1};
}

}  // namespace

/// Linear programme in two variables, one half-plane after the other (Seidel): where the best point so far violates the next
/// half-plane, the new best lies on its border.
double RateLimits::largest_start(double x0_max, double x1_max) const {
  thread_local std::vector<HalfPlane> planes;
  planes.assign({{1, 0, x0_max}, {-1, 0, 0}, {0, 1, x1_max}, {0, -1, 0}});
  Point best{x0_max, x1_max};
  for (const RateRow& row : rows) {
    if (std::abs(row.start) * x0_max + std::abs(row.end) * x1_max <= 1) continue;
    for (const double sign : {1.0, -1.0}) {
      const HalfPlane plane{sign * row.start, sign * row.end, 1};
      if (plane.a0 * best.x0 + plane.a1 * best.x1 > 1) best = best_on_line(plane, planes, planes.size());
      planes.push_back(plane);
    }
  }
  return std::clamp(best.x0, 0.0, x0_max);
}

double RateLimits::largest_end(double x0, double x1_max) const {
  constexpr double kFull = 1 + kRoundingRoom;
  double x1 = x1_max;
  for (const RateRow& row : rows) {
    const double used = row.start * x0;
    if (row.end > 0) x1 = std::min(x1, (kFull - used) / row.end);
    if (row.end < 0) x1 = std::min(x1, (-kFull - used) / row.end);
  }
  return std::max(0.0, x1);
}

bool RateLimits::allows(double x0, double x1) const {
  if (std::max(x0, x1) > max_rate2) return false;
  return std::all_of(rows.begin(), rows.end(),
                     [&](const RateRow& row) { return std::abs(row.start * x0 + row.end * x1) <= 1 + 2 * kRoundingRoom; });
}

RateLimits rate_limits(const Segment& segment, const std::vector<MotorLimits>& limits, double accel_share) {
  RateLimits result;
  for (std::size_t m = 0; m < std::min(segment.motor.size(), limits.size()); ++m) {
    const MotorCubic& q = segment.motor[m];
    const double inv_accel = limits[m].inv_amax_ms2_mu / accel_share, allowed = limits[m].max_speed_mu_ms;
    if (inv_accel > 0) add_acceleration_rows(q, segment.duration_ms, inv_accel, result.rows);
    const double speed = largest_speed(q, segment.duration_ms);
    if (allowed > 0 && speed > allowed) result.max_rate2 = std::min(result.max_rate2, (allowed / speed) * (allowed / speed));
  }
  return result;
}

}  // namespace pmac::motion
