// A new destination in mid-move: position, speed and acceleration go on without a step, limits hold.
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "runtime/motion/profile.h"

using namespace pmac::motion;

TEST_CASE("a jog that is renewed every millisecond settles at the speed whose stopping distance is the jog's", "[motion]") {
  const JogParameters jog{32, -10, -50};
  MotorProfile p = MotorProfile::rest(0);
  for (int k = 0; k < 600; ++k) {
    const double t = k;
    p = MotorProfile::move(t, p.position_mu(t), p.velocity_mu_ms(t), p.position_mu(t) + 500, jog, p.accel_mu_ms2(t));
  }
  // V^2 |JogTa| / 2 + V Ts / 2 = 500, Ts = 50 / 10; a renewal every millisecond costs up to V * 1 ms of the distance
  const double settled = (-2.5 + std::sqrt(2.5 * 2.5 + 20.0 * 500.0)) / 10.0;
  const double with_delay = (-2.5 - 1.0 + std::sqrt(3.5 * 3.5 + 20.0 * 500.0)) / 10.0;
  CHECK(p.velocity_mu_ms(599) <= settled);
  CHECK(p.velocity_mu_ms(599) >= with_delay);
}

TEST_CASE("mirrored destinations give mirrored motion", "[motion]") {
  const JogParameters jog{32, -10, -50};
  MotorProfile plus = MotorProfile::rest(0), minus = MotorProfile::rest(0);
  for (int k = 0; k < 400; ++k) {
    const double t = k, d = k < 300 ? 500 : -80;
    plus = MotorProfile::move(t, plus.position_mu(t), plus.velocity_mu_ms(t), plus.position_mu(t) + d, jog, plus.accel_mu_ms2(t));
    minus = MotorProfile::move(t, minus.position_mu(t), minus.velocity_mu_ms(t), minus.position_mu(t) - d, jog, minus.accel_mu_ms2(t));
    REQUIRE(plus.position_mu(t + 1) == Approx(-minus.position_mu(t + 1)).margin(1e-9));
  }
}

TEST_CASE("random new destinations keep position, speed, acceleration and the limits", "[motion]") {
  const JogParameters jog{32, -10, -50};  // 0.1 mu/ms^2, 0.02 mu/ms^3
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> distance(-5000, 5000), wait(1, 300);
  MotorProfile p = MotorProfile::rest(0);
  double t = 0;
  for (int i = 0; i < 2000; ++i) {
    const double x = p.position_mu(t), v = p.velocity_mu_ms(t), a = p.accel_mu_ms2(t);
    const double target = x + distance(random);
    p = MotorProfile::move(t, x, v, target, jog, a);
    REQUIRE(p.position_mu(t) == Approx(x).margin(1e-9));
    REQUIRE(p.velocity_mu_ms(t) == Approx(v).margin(1e-12));
    REQUIRE(p.accel_mu_ms2(t) == Approx(a).margin(1e-12));
    REQUIRE(p.target_mu() == target);
    REQUIRE(p.position_mu(p.end_ms()) == Approx(target).margin(1e-9));
    REQUIRE(p.position_mu(p.end_ms() - 1e-6) == Approx(target).margin(1e-6));
    double before = a;
    for (double s = t; s < p.end_ms(); s += 1.0) {
      REQUIRE(std::abs(p.velocity_mu_ms(s)) < 32.0 + 1e-9);
      REQUIRE(std::abs(p.accel_mu_ms2(s)) < 0.1 + 1e-12);
      REQUIRE(std::abs(p.accel_mu_ms2(s) - before) < 0.02 + 1e-12);
      before = p.accel_mu_ms2(s);
    }
    t += wait(random);
  }
}
