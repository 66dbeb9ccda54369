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

/// A direction of courses, or the normal of a bound on them.
struct Direction {
  double x0, x1, bend;
  double size() const { return std::abs(x0) + std::abs(x1) + std::abs(bend); }
  double dot(const Direction& b) const { return x0 * b.x0 + x1 * b.x1 + bend * b.bend; }
  void add(double times, const Direction& b) { x0 += times * b.x0, x1 += times * b.x1, bend += times * b.bend; }
};

/// All that bounds a course but the x that are asked for at its ends.
class CourseBounds {
 public:
  CourseBounds(const RateLimits& limits, double full) : full_(full), most_at_ends_(limits.max_start_rate2 + limits.max_end_rate2) {
    for (const MotorShare& motor : limits.motors) add_motor(motor);
  }

  /// The normal of the bound that the course exceeds most, and by how much. False where that is nothing.
  bool find_exceeded(const Direction& course, Direction& normal, double& excess) const {
    double most = kRounding, value_there = 0;
    int there = -1;
    for (int i = 0; i < count_; ++i) {
      const double value = bands_[i].dot(course), over = std::abs(value) - full_;
      if (over > most) most = over, value_there = value, there = i;
    }
    const double sum = course.x0 + course.x1, bend_over = std::abs(course.bend) - kMostBend * sum, middle_over = sum - course.bend - most_at_ends_;
    excess = std::max({most, bend_over, middle_over, -course.x1});
    if (excess == kRounding) return false;
    if (excess == most) {
      const double side = value_there > 0 ? 1 : -1;
      normal = {side * bands_[there].x0, side * bands_[there].x1, side * bands_[there].bend};
    } else if (excess == bend_over) normal = {-kMostBend, -kMostBend, course.bend > 0 ? 1.0 : -1.0};
    else if (excess == middle_over) normal = {1, 1, -1};   // at half way x is below a line between the highest
    else normal = {0, -1, 0};
    return true;
  }

 private:
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
  std::array<Direction, 4 * kMostMotors> bands_;   // |band . course| <= full
};

/// Three bounds that meet in a course: x0 and x1 as asked for, and a bend of 0, which only says where to begin and goes first. Edges
/// lead along two of the bounds away from the third; `worth` is what moving that bound by 1 gains.
class Vertex {
 public:
  Vertex(double x0, double x0_worth, double x1, double x1_worth) : course_{x0, x1, 0}, edges_{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, worth_{x0_worth, x1_worth, 0} {}

  const Direction& course() const { return course_; }

  /// Takes another bound in, which is exceeded, for one that can go. first: of those that may. False: no course is within all of them.
  bool take_in(const Direction& normal, double excess, int first) {
    constexpr double kNothing = 1e-9;   // of what it could be: rounding
    double part[3];
    for (int k = 0; k < 3; ++k) {
      part[k] = normal.dot(edges_[k]);
      if (std::abs(part[k]) <= kNothing * normal.size() * edges_[k].size()) part[k] = 0;
    }
    int out = -1;
    double least = 0;
    for (int k = first; k < 3; ++k) {
      if (part[k] <= 0) continue;
      const double ratio = worth_[k] / part[k];
      if (out < 0 || ratio < least || (ratio == least && part[k] > part[out])) out = k, least = ratio;
    }
    if (has_free_ && part[2] != 0) out = 2, has_free_ = false;
    if (out < 0) return false;
    const double inverse = 1 / part[out], step = worth_[out] * inverse;
    course_.add(-excess * inverse, edges_[out]);
    edges_[out] = {inverse * edges_[out].x0, inverse * edges_[out].x1, inverse * edges_[out].bend};
    for (int k = 0; k < 3; ++k) {
      if (k == out) continue;
      edges_[k].add(-part[k], edges_[out]);
      worth_[k] -= step * part[k];
    }
    worth_[out] = step;
    return true;
  }

 private:
  Direction course_, edges_[3];
  double worth_[3];
  bool has_free_ = true;
};

/// False: none is within the bounds.
bool find_course(const CourseBounds& bounds, Vertex& vertex, int first) {
  Direction normal;
  double excess;
  for (int step = 0; bounds.find_exceeded(vertex.course(), normal, excess); ++step)
    if (step == kMostSteps || !vertex.take_in(normal, excess, first)) return false;
  return true;
}

}  // namespace

RateCourse RateLimits::largest_start(double x0_max, double x1_max) const {
  constexpr double kEndMatters = 1e-9;   // of two that are as good at the start the one with the higher end
  const double start_max = std::min(x0_max, max_start_rate2);
  if (is_even) return {std::min(start_max, x1_max + even_change), x1_max, 0};
  if (allows_full_rate && start_max >= 1 && x1_max >= 1) return {1, 1, 0};
  const CourseBounds bounds(*this, kPlanned);
  Vertex vertex(start_max, 1, x1_max, kEndMatters);
  if (!find_course(bounds, vertex, 0)) return {0, 0, 0};
  return {std::max(0.0, vertex.course().x0), std::clamp(vertex.course().x1, 0.0, x1_max), vertex.course().bend};
}

RateCourse RateLimits::largest_end(double x0, double x1_max) const {
  const double end_max = std::min(x1_max, max_end_rate2);
  if (is_even) return {x0, std::min(end_max, x0 + even_change), 0};
  if (allows_full_rate && x0 >= 1 && end_max >= 1) return {1, 1, 0};
  const CourseBounds bounds(*this, kCarriedOut);
  Vertex vertex(x0, 0, end_max, 1);
  if (!find_course(bounds, vertex, 1)) return {x0, std::min(x0, end_max), 0};
  return {x0, std::clamp(vertex.course().x1, 0.0, end_max), vertex.course().bend};
}

}  // namespace pmac::motion
