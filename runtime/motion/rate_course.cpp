// The two searches of RateLimits: small linear programs, solved by the dual simplex method. It begins where the bounds meet that decided a part
// nearby, or at the highest x that is asked for, and takes the bound that is exceeded most into the three that decide, until none is exceeded.
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "runtime/motion/rate_limits.h"

namespace pmac::motion {
namespace {

/// What is planned leaves so much of the limits for rounding where it is carried out.
constexpr double kPlanned = 1 - 4e-7, kCarriedOut = 1;
/// Bends keep x at half way above a quarter of its mean at the ends, so that it never vanishes between them.
constexpr double kMostBend = 0.75;
/// By so much a bound may be exceeded: rounding.
constexpr double kRounding = 1e-11;
constexpr int kMostSteps = 200;
constexpr std::size_t kMostMotors = 64;   // more than a controller or a cable of cards has

enum Axis { kX0, kX1, kBend };

/// A course, a direction of courses, or the normal of a bound on them.
using Direction = std::array<double, 3>;

double dot(const Direction& a, const Direction& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
double size_of(const Direction& a) { return std::abs(a[0]) + std::abs(a[1]) + std::abs(a[2]); }
Direction sum(const Direction& a, double times, const Direction& b) { return {a[0] + times * b[0], a[1] + times * b[1], a[2] + times * b[2]}; }

/// Names of bounds beside those of the limits, which are 1, 2, ... and -1, -2, ... for their other sides.
enum : int { kNone = 0, kAskedX0 = 1000, kAskedX1, kNoBend, kHighBend, kLowBend, kMiddle, kEndNotBelow0 };

/// All that bounds a course.
class CourseBounds {
 public:
  CourseBounds(const RateLimits& limits, double full, double x0_max, double x1_max)
      : full_(full), x0_max_(x0_max), x1_max_(x1_max), middle_(limits.max_start_rate2 + limits.max_end_rate2) {
    if (limits.motors.size() > kMostMotors) throw std::length_error("a path of more motors than the lookahead can plan");
    for (const MotorShare& motor : limits.motors) add_motor(motor);
  }

  bool knows(int limit) const { return limit != kNone && std::abs(limit) <= count_; }
  double full() const { return full_; }

  Direction normal(int bound) const {
    switch (bound) {
      case kAskedX0: return {1, 0, 0};
      case kAskedX1: return {0, 1, 0};
      case kNoBend: return {0, 0, 1};
      case kHighBend: return {-kMostBend, -kMostBend, 1};
      case kLowBend: return {-kMostBend, -kMostBend, -1};
      case kMiddle: return {1, 1, -1};   // at half way x is below a line between the highest
      case kEndNotBelow0: return {0, -1, 0};
    }
    const Direction& limit = limits_[static_cast<std::size_t>(std::abs(bound)) - 1];
    return bound > 0 ? limit : Direction{-limit[0], -limit[1], -limit[2]};
  }

  /// The bound that is exceeded most, and by how much; kNone.
  int exceeded(const Direction& course, double& excess) const {
    double most = kRounding;
    int found = kNone;
    const auto consider = [&](double by, int bound) {
      if (by > most) most = by, found = bound;
    };
    for (int i = 0; i < count_; ++i) {
      const double value = dot(limits_[static_cast<std::size_t>(i)], course);
      if (std::abs(value) - full_ > most) most = std::abs(value) - full_, found = value > 0 ? i + 1 : -i - 1;
    }
    const double both = course[kX0] + course[kX1];
    consider(course[kX0] - x0_max_, kAskedX0);
    consider(course[kX1] - x1_max_, kAskedX1);
    consider(std::abs(course[kBend]) - kMostBend * both, course[kBend] > 0 ? kHighBend : kLowBend);
    consider(both - course[kBend] - middle_, kMiddle);
    consider(-course[kX1], kEndNotBelow0);
    excess = most;
    return found;
  }

 private:
  /// Bernstein coefficients of q'' x + q' a: q'' by e0, e1; q' by d0, dm, d1; x by x0, xm, x1; a by a0, a1 = (x1 - x0 -+ bend)/2 and
  /// xm = x0 + a0. All over the part as a unit of time.
  void add_motor(const MotorShare& motor) {
    const double e0 = motor.start_accel, e1 = motor.end_accel, d0 = motor.velocity, dm = d0 + e0 / 2, d1 = dm + e1 / 2;
    const double by_first = (d0 + 2 * dm) / 2, by_second = (d1 + 2 * dm) / 2;
    Direction* const limit = &limits_[static_cast<std::size_t>(count_)];
    limit[0] = {e0 - d0 / 2, d0 / 2, -d0 / 2};
    limit[1] = {(e0 + e1 - by_first) / 3, (e0 + by_first) / 3, (d0 / 2 - dm - e0) / 3};
    limit[2] = {(e1 - by_second) / 3, (e0 + e1 + by_second) / 3, (dm - d1 / 2 - e1) / 3};
    limit[3] = {-d1 / 2, e1 + d1 / 2, d1 / 2};
    count_ += 4;
  }

  double full_, x0_max_, x1_max_, middle_;
  int count_ = 0;
  std::array<Direction, 4 * kMostMotors> limits_;   // |limit . course| <= full
};

/// Three bounds that meet in a course. Edges lead along two of them away from the third; `worth` is what moving that one by 1 gains.
class Vertex {
 public:
  /// The given x as asked for; the one that is looked for, too, and no bend, which only says where to begin and goes first.
  Vertex(Axis given, double given_x, double given_worth, double most) : given_(given) {
    const Axis looked_for = given == kX0 ? kX1 : kX0;
    names_ = {given == kX0 ? kAskedX0 : kAskedX1, given == kX0 ? kAskedX1 : kAskedX0, kNoBend};
    course_ = {};
    course_[given] = given_x;
    course_[looked_for] = most;
    edges_ = {};
    edges_[0][given] = edges_[1][looked_for] = edges_[2][kBend] = 1;
    worth_ = {given_worth, 1, 0};
  }

  /// Begins where the given x and two limits meet, if these can decide.
  void begin_at(const CourseBounds& bounds, double given_x, double given_worth, int first, int second) {
    if (!bounds.knows(first) || !bounds.knows(second)) return;
    const Vertex meeting(bounds, given_, given_x, given_worth, first, second);
    if (meeting.worth_[0] >= (given_ == kX1 ? 0 : -std::numeric_limits<double>::infinity()) && meeting.worth_[1] >= 0 && meeting.worth_[2] >= 0) *this = meeting;
  }

  const Direction& course() const { return course_; }
  /// The limits that decide beside the given x; kNone where others do.
  std::array<int, 2> deciding() const {
    const bool are_limits = (names_[0] == kAskedX0 || names_[0] == kAskedX1) && std::abs(names_[1]) < kAskedX0 && std::abs(names_[2]) < kAskedX0;
    return are_limits ? std::array{std::min(names_[1], names_[2]), std::max(names_[1], names_[2])} : std::array<int, 2>{kNone, kNone};
  }

  /// Takes another bound in, which is exceeded, for one that can go. given_may_go: that of the given x may. False: no course is within all of them.
  bool take_in(int name, const Direction& normal, double excess, bool given_may_go) {
    constexpr double kNothing = 1e-9;   // of what it could be: rounding
    std::array<double, 3> part;
    for (std::size_t k = 0; k < 3; ++k) {
      part[k] = dot(normal, edges_[k]);
      if (std::abs(part[k]) <= kNothing * size_of(normal) * size_of(edges_[k])) part[k] = 0;
    }
    std::size_t out = 3;
    double least = 0;
    for (std::size_t k = given_may_go ? 0 : 1; k < 3; ++k) {
      const bool is_free = names_[k] == kNoBend;
      if (is_free ? part[k] == 0 : part[k] <= 0) continue;
      const double ratio = is_free ? -1 : worth_[k] / part[k];
      if (out == 3 || ratio < least || (ratio == least && part[k] > part[out])) out = k, least = ratio;
    }
    if (out == 3) return false;
    const double inverse = 1 / part[out], step = worth_[out] * inverse;
    course_ = sum(course_, -excess * inverse, edges_[out]);
    edges_[out] = {inverse * edges_[out][0], inverse * edges_[out][1], inverse * edges_[out][2]};
    for (std::size_t k = 0; k < 3; ++k) {
      if (k == out) continue;
      edges_[k] = sum(edges_[k], -part[k], edges_[out]);
      worth_[k] -= step * part[k];
    }
    worth_[out] = step;
    names_[out] = name;
    return true;
  }

 private:
  Vertex(const CourseBounds& bounds, Axis given, double given_x, double given_worth, int first, int second) : given_(given) {
    constexpr double kParallel = 1e-6;
    const Axis looked_for = given == kX0 ? kX1 : kX0;
    const Direction a = bounds.normal(first), b = bounds.normal(second);
    const double det = a[looked_for] * b[kBend] - a[kBend] * b[looked_for];
    names_ = {given == kX0 ? kAskedX0 : kAskedX1, first, second};
    worth_ = {-1, -1, -1};
    if (std::abs(det) <= kParallel * size_of(a) * size_of(b)) return;
    const double inverse = 1 / det;
    edges_ = {};
    edges_[1][looked_for] = b[kBend] * inverse, edges_[1][kBend] = -b[looked_for] * inverse;
    edges_[2][looked_for] = -a[kBend] * inverse, edges_[2][kBend] = a[looked_for] * inverse;
    edges_[0][given] = 1;
    edges_[0] = sum(sum(edges_[0], -a[given], edges_[1]), -b[given], edges_[2]);
    worth_ = {given_worth + edges_[0][looked_for], edges_[1][looked_for], edges_[2][looked_for]};
    const double full = bounds.full();
    course_ = {};
    course_ = sum(sum(sum(course_, given_x, edges_[0]), full, edges_[1]), full, edges_[2]);
  }

  Axis given_;
  std::array<int, 3> names_;
  Direction course_;
  std::array<Direction, 3> edges_;
  std::array<double, 3> worth_;
};

/// Changes the vertex until no bound is exceeded. False: no course is within all of them.
bool find_course(const CourseBounds& bounds, Vertex& vertex, bool given_may_go) {
  double excess = 0;
  for (int step = 0;; ++step) {
    const int name = bounds.exceeded(vertex.course(), excess);
    if (name == kNone) return true;
    if (step == kMostSteps || !vertex.take_in(name, bounds.normal(name), excess, given_may_go)) return false;
  }
}

RateCourse to_course(const Vertex& vertex, double x0_max, double x1_max) {
  const Direction& course = vertex.course();
  return {std::clamp(course[kX0], 0.0, x0_max), std::clamp(course[kX1], 0.0, x1_max), course[kBend], vertex.deciding()};
}

}  // namespace

RateCourse RateLimits::largest_start(double x0_max, double x1_max, const RateCourse& like) const {
  constexpr double kEndMatters = 1e-9;   // of two that are as good at the start the one with the higher end
  const double start_max = std::min(x0_max, max_start_rate2);
  if (is_even) return {std::min(start_max, x1_max + even_change), x1_max, 0};
  if (allows_full_rate && start_max >= 1 && x1_max >= 1) return {1, 1, 0};
  const CourseBounds bounds(*this, kPlanned, start_max, x1_max);
  Vertex vertex(kX1, x1_max, kEndMatters, start_max);
  vertex.begin_at(bounds, x1_max, kEndMatters, like.deciding[0], like.deciding[1]);
  if (!find_course(bounds, vertex, true)) return {0, 0, 0};
  return to_course(vertex, start_max, x1_max);
}

RateCourse RateLimits::largest_end(double x0, double x1_max, const RateCourse& like) const {
  const double end_max = std::min(x1_max, max_end_rate2);
  if (is_even) return {x0, std::min(end_max, x0 + even_change), 0};
  if (allows_full_rate && x0 >= 1 && end_max >= 1) return {1, 1, 0};
  const CourseBounds bounds(*this, kCarriedOut, x0, end_max);
  Vertex vertex(kX0, x0, 0, end_max);
  vertex.begin_at(bounds, x0, 0, like.deciding[0], like.deciding[1]);
  if (!find_course(bounds, vertex, false)) return {x0, std::min(x0, end_max), 0};
  RateCourse course = to_course(vertex, x0, end_max);
  course.x0 = x0;
  return course;
}

}  // namespace pmac::motion
