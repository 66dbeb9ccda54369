// What one part of a segment allows: the linear programs of rate_course.cpp against every vertex of their bounds, the motion against the limits at
// many places, and its times against integration in small steps.
#include <random>

#include <catch2/catch.hpp>

#include "runtime/motion/rate_limits.h"

using namespace pmac::motion;

namespace {

struct Plane { double x0, x1, bend, bound; };   // x0 .. + x1 .. + bend .. <= bound

double value_at(const Plane& p, const RateCourse& c) { return p.x0 * c.x0 + p.x1 * c.x1 + p.bend * c.bend; }

/// Motor acceleration in limits at u = 0..1 of a part: q'' x + q' x' / 2 with x' / 2 from a0 to a1 in equal steps.
double acceleration(const MotorShare& m, const RateCourse& c, double u) {
  const double a0 = (c.x1 - c.x0 - c.bend) / 2, a1 = (c.x1 - c.x0 + c.bend) / 2;
  const double second = m.start_accel + u * (m.end_accel - m.start_accel), first = m.velocity + u * m.start_accel + u * u * (m.end_accel - m.start_accel) / 2;
  const double x = c.x0 + 2 * (u * a0 + u * u * (a1 - a0) / 2);
  return second * x + first * (a0 + u * (a1 - a0));
}

/// A cubic's Bernstein coefficients from its values at four places; each is linear in the course.
std::vector<Plane> planes_of(const RateLimits& limits, double x0_max, double x1_max) {
  std::vector<Plane> planes{{1, 0, 0, x0_max}, {0, 1, 0, x1_max}, {-1, 0, 0, 0}, {0, -1, 0, 0}, {1, 1, -1, limits.max_start_rate2 + limits.max_end_rate2},
                            {-0.75, -0.75, 1, 0}, {-0.75, -0.75, -1, 0}};
  for (const MotorShare& m : limits.motors) {
    double by[3][4];   // [x0, x1, bend][coefficient]
    const RateCourse units[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int k = 0; k < 3; ++k) {
      const double f0 = acceleration(m, units[k], 0), f1 = acceleration(m, units[k], 1. / 3), f2 = acceleration(m, units[k], 2. / 3), f3 = acceleration(m, units[k], 1);
      by[k][0] = f0;
      by[k][1] = (-5 * f0 + 18 * f1 - 9 * f2 + 2 * f3) / 6;
      by[k][2] = (2 * f0 - 9 * f1 + 18 * f2 - 5 * f3) / 6;
      by[k][3] = f3;
    }
    for (int i = 0; i < 4; ++i) {
      planes.push_back({by[0][i], by[1][i], by[2][i], 1});
      planes.push_back({-by[0][i], -by[1][i], -by[2][i], 1});
    }
  }
  return planes;
}

/// The best of all points where three planes meet that lie within the others; best: larger `goal`. equal: x0 is x0_max.
double best_vertex(const std::vector<Plane>& planes, bool by_start, bool equal) {
  double best = -1;
  const auto det = [](const Plane& a, const Plane& b, const Plane& c, int column) {
    const auto row = [column](const Plane& p) { return std::array{column == 0 ? p.bound : p.x0, column == 1 ? p.bound : p.x1, column == 2 ? p.bound : p.bend}; };
    const auto r = row(a), s = row(b), t = row(c);
    return r[0] * (s[1] * t[2] - s[2] * t[1]) - r[1] * (s[0] * t[2] - s[2] * t[0]) + r[2] * (s[0] * t[1] - s[1] * t[0]);
  };
  for (std::size_t i = 0; i < (equal ? 1 : planes.size()); ++i)
    for (std::size_t j = i + 1; j < planes.size(); ++j)
      for (std::size_t k = j + 1; k < planes.size(); ++k) {
        const double all = det(planes[i], planes[j], planes[k], -1);
        if (std::abs(all) < 1e-12) continue;
        const RateCourse at{det(planes[i], planes[j], planes[k], 0) / all, det(planes[i], planes[j], planes[k], 1) / all, det(planes[i], planes[j], planes[k], 2) / all};
        if (std::any_of(planes.begin(), planes.end(), [&](const Plane& p) { return value_at(p, at) > p.bound + 1e-9; })) continue;
        best = std::max(best, by_start ? at.x0 : at.x1);
      }
  return best;
}

/// Parts that turn by up to `turn` while they accelerate, with one to three motors.
RateLimits random_part(std::mt19937& random, double turn) {
  std::uniform_real_distribution<double> one(-1, 1);
  RateLimits limits;
  limits.duration_ms = 5;
  const int motors = 1 + static_cast<int>(random() % 3);
  const double speed = std::exp(3 * one(random));
  for (int m = 0; m < motors; ++m) limits.motors.push_back({speed * one(random), speed * turn * one(random), speed * turn * one(random)});
  return limits;
}

void keeps_limits(const RateLimits& limits, const RateCourse& course) {
  for (const MotorShare& m : limits.motors)
    for (int i = 0; i <= 20; ++i) CHECK(std::abs(acceleration(m, course, i / 20.)) <= 1 + 1e-9);
}

}  // namespace

TEST_CASE("rate course: the best of all vertices, within the limits everywhere", "[motion][lookahead]") {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int n = 0; n < 400; ++n) {
    const RateLimits limits = random_part(random, n % 2 ? 0.2 : 2);
    const double x0_max = unit(random), x1_max = unit(random);
    INFO("part " << n);
    const RateCourse start = limits.largest_start(x0_max, x1_max);
    CHECK(start.x0 == Approx(best_vertex(planes_of(limits, x0_max, x1_max), true, false)).epsilon(1e-6).margin(1e-9));
    CHECK(start.x1 <= x1_max);
    keeps_limits(limits, start);
    for (const double part : {1.0, 0.5, 0.01}) {   // whatever begins below can be carried out
      const double x0 = part * start.x0;
      const RateCourse end = limits.largest_end(x0, x1_max);
      CHECK(end.x0 == x0);
      CHECK(end.x1 == Approx(best_vertex(planes_of(limits, x0, x1_max), false, true)).epsilon(1e-6).margin(1e-9));
      keeps_limits(limits, end);
    }
  }
}

TEST_CASE("rate course: a straight line and a stop are their closed forms", "[motion][lookahead]") {
  RateLimits limits;
  limits.duration_ms = 4;
  limits.motors.push_back({10, 0, 0});   // v / (h a_max) = 10: x may change by 2 / 10 over the part
  CHECK(limits.largest_start(1, 0).x0 == Approx(0.2).epsilon(1e-6));
  CHECK(limits.largest_start(1, 0.5).x0 == Approx(0.7).epsilon(1e-6));
  CHECK(limits.largest_end(0, 1).x1 == Approx(0.2).epsilon(1e-6));
  CHECK(limits.largest_end(0.9, 1).x1 == 1);
  CHECK(limits.largest_end(0.3, 1).bend == Approx(0).margin(1e-9));
}

TEST_CASE("timed segment: programmed time, rate and times are those of small steps", "[motion][lookahead]") {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> one(-1, 1);
  for (int n = 0; n < 200; ++n) {
    const double h = 5, x0 = std::abs(one(random)), x1 = std::abs(one(random)), bend = n % 4 ? 0.75 * (x0 + x1) * one(random) : 0.001 * one(random);
    TimedSegment timed;
    timed.segment.duration_ms = h;
    timed.rate = std::sqrt(x0);
    timed.rate_slope = (x1 - x0 - bend) / (2 * h);
    timed.slope_growth = bend / (h * h);
    timed.duration_ms = time_between(timed.rate, std::sqrt(x1), h, timed.slope_growth);
    constexpr int kSteps = 2000;   // classical Runge-Kutta of d'' = slope + growth d
    double d = 0, rate = timed.rate, dt = timed.duration_ms / kSteps;
    const auto slope = [&](double at) { return timed.rate_slope + timed.slope_growth * at; };
    INFO("course " << n << " x0 " << x0 << " x1 " << x1 << " bend " << bend);
    for (int i = 0; i < kSteps; ++i) {
      if (i == kSteps / 3) {
        CHECK(timed.programmed_ms(i * dt) == Approx(d).epsilon(1e-10));
        CHECK(timed.rate_at(i * dt) == Approx(rate).epsilon(1e-10));
        CHECK(time_at(timed, d) == Approx(i * dt).epsilon(1e-8));
      }
      const double k1 = slope(d), k2 = slope(d + dt / 2 * rate), k3 = slope(d + dt / 2 * rate + dt * dt / 4 * k1), k4 = slope(d + dt * rate + dt * dt / 2 * k2);
      d += dt * rate + dt * dt / 6 * (k1 + k2 + k3);
      rate += dt / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    }
    CHECK(d == Approx(h).epsilon(1e-9));
    CHECK(rate == Approx(std::sqrt(x1)).epsilon(1e-8).margin(1e-9));
    CHECK(timed.programmed_ms(timed.duration_ms) == Approx(h).epsilon(1e-11));
  }
}
