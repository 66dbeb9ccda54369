#include "runtime/motion/profile.h"

#include <cmath>
#include <random>

#include <catch2/catch.hpp>

using namespace pmac::motion;

namespace {

const JogParameters kFactory{32, -10, -50};  // MaxSpeed 32, JogTa -10, JogTs -50

/// Largest jump of position and velocity between neighbouring times, and largest acceleration.
struct Smoothness { double position_gap = 0, accel = 0, speed = 0; };
Smoothness measure(const MotorProfile& profile, double start_ms) {
  Smoothness result;
  const double h = 0.01, end = std::min(profile.end_ms(), start_ms + 5000) + 1;
  for (double t = start_ms; t < end; t += h) {
    const double mean = (profile.velocity_mu_ms(t) + profile.velocity_mu_ms(t + h)) / 2;
    result.position_gap = std::max(result.position_gap, std::abs(profile.position_mu(t + h) - profile.position_mu(t) - mean * h));
    result.accel = std::max(result.accel, std::abs(profile.velocity_mu_ms(t + h) - profile.velocity_mu_ms(t)) / h);
    result.speed = std::max(result.speed, std::abs(profile.velocity_mu_ms(t)));
  }
  return result;
}

}  // namespace

TEST_CASE("rapid move times under factory settings", "[motion][profile]") {
  // D/V + ramp = 1250 + 325; and the short one by 2 (v/A + Ts) with v (v/A + Ts) = D, v = 19.75.
  CHECK(move_time_ms(40000, kFactory) == Approx(1575).epsilon(1e-12));
  CHECK(move_time_ms(-4000, kFactory) == Approx(405.031248779).epsilon(1e-11));
  CHECK(move_time_ms(0, kFactory) == 0);
  // Below 2 A Ts^2 = 5 mu: 4 cbrt-law, v = cbrt(J D^2/4), total 4 sqrt(v/J).
  const double v = std::cbrt(0.02 * 4 / 4);
  CHECK(move_time_ms(2, kFactory) == Approx(4 * std::sqrt(v / 0.02)));
  // Times given: trapezoid D/V + T, triangle 2 T.
  CHECK(move_time_ms(10000, {10, 100, 50}) == Approx(1150));
  CHECK(move_time_ms(100, {10, 100, 50}) == Approx(300));
}

TEST_CASE("a profile takes the closed-form time and ends exactly", "[motion][profile]") {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> distance(-9000, 9000);
  for (const JogParameters& jog : {kFactory, JogParameters{10, 100, 50}, JogParameters{20, 80, -100}, JogParameters{5, -4, 0}})
    for (int i = 0; i < 20; ++i) {
      const double d = distance(random);
      const MotorProfile profile = MotorProfile::move(3, 100, 0, 100 + d, jog);
      CHECK(profile.end_ms() - 3 == Approx(move_time_ms(d, jog)).epsilon(1e-9));
      CHECK(profile.position_mu(profile.end_ms()) == 100 + d);
      CHECK(profile.position_mu(profile.end_ms() - 1e-9) == Approx(100 + d).margin(1e-6));
      CHECK(measure(profile, 3).position_gap < 1e-5);
      CHECK(measure(profile, 3).speed <= jog.speed_mu_ms * (1 + 1e-12));
    }
}

TEST_CASE("factory limits hold within a profile", "[motion][profile]") {
  CHECK(measure(MotorProfile::move(0, 0, 0, 4000, kFactory), 0).accel <= 0.1 * (1 + 1e-9));
  CHECK(measure(MotorProfile::move(0, 0, 17, -300, kFactory), 0).accel <= 0.1 * (1 + 1e-9));
}

TEST_CASE("a changed destination starts from the present speed, and overshoots where it must", "[motion][profile]") {
  // From 20 mu/ms the stop takes 20/2 * (200 + 5) = 2050 mu.
  const MotorProfile ahead = MotorProfile::move(0, 0, 20, 5000, kFactory);
  CHECK(ahead.velocity_mu_ms(0) == 20);
  CHECK(ahead.position_mu(ahead.end_ms()) == 5000);
  double furthest = 0;
  for (double t = 0; t < ahead.end_ms(); t += 0.5) furthest = std::max(furthest, ahead.position_mu(t));
  CHECK(furthest <= 5000 + 1e-6);
  const MotorProfile exact = MotorProfile::move(0, 0, 20, 2050, kFactory);
  CHECK(exact.end_ms() == Approx(205));
  const MotorProfile back = MotorProfile::move(0, 0, 20, 1000, kFactory);
  furthest = 0;
  for (double t = 0; t < back.end_ms(); t += 0.5) furthest = std::max(furthest, back.position_mu(t));
  CHECK(furthest > 1900);
  CHECK(back.position_mu(back.end_ms() + 5) == 1000);
  CHECK(measure(back, 0).position_gap < 1e-5);
}

TEST_CASE("a jog goes on until it is stopped", "[motion][profile]") {
  const MotorProfile jog = MotorProfile::jog(0, 0, 0, -1, kFactory);
  CHECK(std::isinf(jog.end_ms()));
  CHECK(jog.velocity_mu_ms(1000) == -32);
  const MotorProfile stop = MotorProfile::stop(1000, jog.position_mu(1000), jog.velocity_mu_ms(1000), kFactory);
  CHECK(stop.end_ms() == Approx(1325));
  CHECK(stop.target_mu() == Approx(jog.position_mu(1000) - 32 * 325.0 / 2));
  CHECK(stop.velocity_mu_ms(1400) == 0);
  CHECK(MotorProfile::rest(7).position_mu(1e9) == 7);
}
