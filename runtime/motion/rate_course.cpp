// The two searches of RateLimits: small linear programs, solved by the dual simplex method. It begins at the highest x that is asked for
// and takes the limit that is exceeded most into the three that decide, until none is exceeded. That is a few steps, mostly.
#include <algorithm>
#include <cmath>

#include "runtime/motion/rate_limits.h"

namespace pmac::motion {
namespace {

/// What is planned leaves so much of the limits for rounding where it is carried out.
constexpr double kPlanned = 1 - 4e-7, kCarriedOut = 1;
/// Bends keep x at half way above a quarter of its mean at the ends, so that it never vanishes between them.
constexpr double kMostBend = 0.75;
/// By so much a limit may be exceeded: rounding.
constexpr double kRounding = 1e-11;
constexpr int kMostSteps = 200, kMostMotors = 32;

/// normal . (x0, x1, bend) <= bound.
struct Bound { double x0, x1, bend, bound; };

struct Cross { double x0, x1, bend; };
Cross cross(const Bound& a, const Bound& b) { return {a.x1 * b.bend - a.bend * b.x1, a.bend * b.x0 - a.x0 * b.bend, a.x0 * b.x1 - a.x1 * b.x0}; }
double dot(const Bound& a, const Cross& b) { return a.x0 * b.x0 + a.x1 * b.x1 + a.bend * b.bend; }

/// All that bounds a course but the x that are asked for at its ends.
class CourseBounds {
 public:
  CourseBounds(const RateLimits& limits, double full) : full_(full), most_at_ends_(limits.max_start_rate2 + limits.max_end_rate2) {
    for (const MotorShare& motor : limits.motors) add_motor(motor);
  }

  /// What the course exceeds most. False where that is nothing.
  bool find_exceeded(const RateCourse& v, Bound& found) const {
    double most = kRounding;
    const auto consider = [&](double excess, const Bound& bound) {
      if (excess > most) most = excess, found = bound;
    };
    for (int i = 0; i < count_; ++i) {
      const Band& b = bands_[i];
      const double value = b.x0 * v.x0 + b.x1 * v.x1 + b.bend * v.bend;
      if (std::abs(value) - full_ <= most) continue;
      const double side = value > 0 ? 1 : -1;
      most = std::abs(value) - full_;
      found = {side * b.x0, side * b.x1, side * b.bend, full_};
    }
    consider(std::abs(v.bend) - kMostBend * (v.x0 + v.x1), {-kMostBend, -kMostBend, v.bend > 0 ? 1.0 : -1.0, 0});
    consider(v.x0 + v.x1 - v.bend - most_at_ends_, {1, 1, -1, most_at_ends_});   // at half way x is below a line between the highest
    consider(-v.x1, {0, -1, 0, 0});
    return most > kRounding;
  }

 private:
  struct Band { double x0, x1, bend; };   // |...| <= full

  /// Bernstein coefficients of q'' x + q' a: q'' by e0, e1; q' by d0, dm, d1; x by x0, xm, x1; a by a0, a1 = (x1 - x0 -+ bend)/2 and
  /// xm = x0 + a0. All over the part as a unit of time.
  void add_motor(const MotorShare& motor) {
    const double e0 = motor.start_accel, e1 = motor.end_accel, d0 = motor.velocity, dm = d0 + e0 / 2, d1 = dm + e1 / 2;
    const double by_first = (d0 + 2 * dm) / 2, by_second = (d1 + 2 * dm) / 2;
    bands_[count_++] = {e0 - d0 / 2, d0 / 2, -d0 / 2};
    bands_[count_++] = {(e0 + e1 - by_first) / 3, (e0 + by_first) / 3, (d0 / 2 - dm - e0) / 3};
    bands_[count_++] = {(e1 - by_second) / 3, (e0 + e1 + by_second) / 3, (dm - d1 / 2 - e1) / 3};
    bands_[count_++] = {-d1 / 2, e1 + d1 / 2, d1 / 2};
  }

  double full_, most_at_ends_;
  int count_ = 0;
  std::array<Band, 4 * kMostMotors> bands_;
};

/// Three bounds that meet in a course; `worth` is what moving one of them by 1 gains. Bounds that are worth nothing go first.
class Vertex {
 public:
  Vertex(const Bound& a, double a_worth, const Bound& b, double b_worth, const Bound& c) : active_{a, b, c}, worth_{a_worth, b_worth, 0} {}

  RateCourse course() const {
    const Cross n0 = cross(active_[1], active_[2]), n1 = cross(active_[2], active_[0]), n2 = cross(active_[0], active_[1]);
    const double inverse = 1 / dot(active_[0], n0), b0 = active_[0].bound * inverse, b1 = active_[1].bound * inverse, b2 = active_[2].bound * inverse;
    return {b0 * n0.x0 + b1 * n1.x0 + b2 * n2.x0, b0 * n0.x1 + b1 * n1.x1 + b2 * n2.x1, b0 * n0.bend + b1 * n1.bend + b2 * n2.bend};
  }

  /// Takes another bound in for one that can go. may_go: the first one may, too. False: there is no course within all of them.
  bool take_in(const Bound& other, bool first_may_go) {
    constexpr double kNothing = 1e-13;
    const double inverse = 1 / dot(active_[0], cross(active_[1], active_[2]));
    const double part[3] = {dot(other, cross(active_[1], active_[2])) * inverse, dot(other, cross(active_[2], active_[0])) * inverse,
                            dot(other, cross(active_[0], active_[1])) * inverse};
    int out = -1;
    double least = 0;
    for (int k = first_may_go ? 0 : 1; k < 3; ++k) {
      const bool is_free = k == free_;   // it only says where to begin, and may go either way
      const double by = is_free ? std::abs(part[k]) : part[k];
      if (by <= kNothing) continue;
      const double ratio = is_free ? -1 : worth_[k] / by;
      if (out < 0 || ratio < least || (ratio == least && by > part[out])) out = k, least = ratio;
    }
    if (out < 0) return false;
    const double step = worth_[out] / part[out];
    for (int k = 0; k < 3; ++k) worth_[k] -= step * part[k];
    worth_[out] = step;
    active_[out] = other;
    if (out == free_) free_ = -1;
    return true;
  }

 private:
  Bound active_[3];
  double worth_[3];
  int free_ = 2;
};

}  // namespace

RateCourse RateLimits::largest_start(double x0_max, double x1_max) const {
  constexpr double kEndMatters = 1e-9;   // of two that are as good at the start the one with the higher end
  const double start_max = std::min(x0_max, max_start_rate2);
  if (is_even) return {std::min(start_max, x1_max + even_change), x1_max, 0};
  if (allows_full_rate && start_max >= 1 && x1_max >= 1) return {1, 1, 0};
  const CourseBounds bounds(*this, kPlanned);
  Vertex vertex({1, 0, 0, start_max}, 1, {0, 1, 0, x1_max}, kEndMatters, {0, 0, 1, 0});
  RateCourse course{start_max, x1_max, 0};
  Bound exceeded;
  for (int step = 0; bounds.find_exceeded(course, exceeded); ++step) {
    if (step == kMostSteps || !vertex.take_in(exceeded, true)) return {0, 0, 0};
    course = vertex.course();
  }
  course.x0 = std::max(0.0, course.x0);
  return course;
}

RateCourse RateLimits::largest_end(double x0, double x1_max) const {
  const double end_max = std::min(x1_max, max_end_rate2);
  if (is_even) return {x0, std::min(end_max, x0 + even_change), 0};
  if (allows_full_rate && x0 >= 1 && end_max >= 1) return {1, 1, 0};
  const CourseBounds bounds(*this, kCarriedOut);
  Vertex vertex({1, 0, 0, x0}, 0, {0, 1, 0, end_max}, 1, {0, 0, 1, 0});
  RateCourse course{x0, end_max, 0};
  Bound exceeded;
  for (int step = 0; bounds.find_exceeded(course, exceeded); ++step) {
    if (step == kMostSteps || !vertex.take_in(exceeded, false)) return {x0, std::min(x0, end_max), 0};
    course = vertex.course();
    course.x0 = x0;
  }
  course.x1 = std::clamp(course.x1, 0.0, end_max);
  return course;
}

}  // namespace pmac::motion
