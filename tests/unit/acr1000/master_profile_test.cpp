// The time law of one move against closed forms: T from lengths and rates of a trapezoid, triangle or ramp, worked by hand.
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "runtime/acr1000/master_profile.h"

using namespace pmac::acr1000;

namespace {

struct Vector { double length, vel, acc, dec, stp, entry, duration, exit; bool forced; };

}  // namespace

TEST_CASE("time law: duration and exit speed of every shape of a move", "[acr1000]") {
  const std::vector<Vector> vectors = {
      {100000, 10000, 0, 0, 0, 0, 10, 10000, false},                              // no ramps: length / VEL
      {100000, 10000, 20000, 20000, 20000, 0, 10.5, 0, false},                    // trapezoid: L/V + V/2a + V/2s
      {10000, 20000, 20000, 20000, 20000, 0, std::sqrt(2.0), 0, false},           // triangle: 2 sqrt(L/a)
      {10000, 20000, 20000, 20000, 5000, 0, std::sqrt(5.0), 0, false},            // triangle, unequal sides
      {10000, 2000, 20000, 5000, 0, 5000, 4.55, 2000, false},                     // 0.6 s of DEC, 7900 at 2000
      {10000, 2000, 20000, 5000, 4000, 5000, 4.8, 0, false},                      // the same, then 0.5 s of STP
      {1000, 2000, 20000, 5000, 0, 5000, (5000 - std::sqrt(15e6)) / 5000, std::sqrt(15e6), false},  // no room for DEC
      {3000, 2000, 20000, 2000, 10000, 5000, 0.887548, 0, false},                 // DEC to 4031.129, then STP
      {1000, 2000, 20000, 5000, 4000, 5000, 0.4, 0, true},                        // even ramp of 12500: 2 L / v0
      {10000, 2000, 0, 0, 1000, 0, 6, 0, false},                                  // step up, 8000 at 2000, 2 s of STP
      {1000, 2000, 0, 0, 1000, 0, std::sqrt(2.0), 0, false},                      // starts at sqrt(2 s L)
  };
  for (const Vector& v : vectors) {
    CAPTURE(v.length, v.vel, v.acc, v.dec, v.stp, v.entry);
    const MasterProfile profile = master_profile(v.length, {v.vel, v.acc, v.dec, v.stp}, v.entry);
    CHECK(profile.duration_s == Approx(v.duration).epsilon(1e-6));
    CHECK(profile.exit_speed_pulses_s == Approx(v.exit).margin(1e-9));
    CHECK(profile.stop_is_forced == v.forced);
    CHECK(at(profile, profile.duration_s).distance_pulses == v.length);
  }
}

TEST_CASE("time law: a triangle peaks where both ramps meet", "[acr1000]") {
  CHECK(master_profile(10000, {20000, 20000, 20000, 20000}, 0).phase[2].start_speed_pulses_s == Approx(14142.135624));
  CHECK(master_profile(10000, {20000, 20000, 20000, 5000}, 0).phase[2].start_speed_pulses_s == Approx(8944.271910));
}

TEST_CASE("time law: the looping example joins its moves and keeps VEL 2000 from the second pass on", "[acr1000]") {
  struct Move { double vel, stp, duration, exit; };
  struct Loop { double ramp_unit; std::vector<Move> moves; };
  // 100000, 100000 and 200000 pulses, ACC = DEC = 10; the second pass starts with VEL 2000, as GOTO 40 passes VEL 1000 by.
  const std::vector<Loop> loops = {{1, {{1000, 0, 150, 1000}, {2000, 10, 144.948974, 0}, {2000, 2, 489.897949, 0}, {2000, 0, 141.421356, 1414.213562}, {2000, 10, 141.421356, 0}}},
                                   {1000, {{1000, 0, 100.05, 1000}, {2000, 10, 50.125, 0}, {2000, 2, 100.6, 0}, {2000, 0, 50.1, 2000}, {2000, 10, 50.1, 0}}}};
  const std::vector<double> lengths = {100000, 100000, 200000, 100000, 100000};
  for (const Loop& loop : loops) {
    double speed = 0;
    for (std::size_t k = 0; k < loop.moves.size(); ++k) {
      const Move& move = loop.moves[k];
      const double ramp = 10 * loop.ramp_unit;
      const MasterProfile profile = master_profile(lengths[k], {move.vel, ramp, ramp, move.stp * loop.ramp_unit}, speed);
      CAPTURE(loop.ramp_unit, k);
      CHECK(profile.duration_s == Approx(move.duration).epsilon(1e-8));
      CHECK(profile.exit_speed_pulses_s == Approx(move.exit).margin(1e-6));
      CHECK_FALSE(profile.stop_is_forced);
      speed = profile.exit_speed_pulses_s;
    }
  }
}

TEST_CASE("time law: distance and speed are continuous, and the speed is the slope of the distance", "[acr1000]") {
  for (const Rates& rates : {Rates{2000, 20000, 2000, 10000}, Rates{2000, 20000, 5000, 4000}, Rates{9000, 3000, 0, 2500}, Rates{5000, 0, 0, 0}})
    for (const double entry : {0.0, 1500.0, 5000.0}) {
      const MasterProfile profile = master_profile(6000, rates, entry);
      const double h = profile.duration_s / 10000;
      for (int k = 1; k < 9999; ++k) {
        const MasterPoint before = at(profile, (k - 0.5) * h), after = at(profile, (k + 0.5) * h);
        const MasterPoint middle = at(profile, k * h);
        CHECK(after.distance_pulses >= before.distance_pulses);
        if (before.accel_pulses_s2 != after.accel_pulses_s2) continue;   // a phase ends here
        CHECK((after.distance_pulses - before.distance_pulses) / h == Approx(middle.speed_pulses_s).epsilon(1e-6).margin(1e-3));
      }
    }
}

TEST_CASE("time law: a move of no length takes no time and loses the entry speed", "[acr1000]") {
  const MasterProfile profile = master_profile(0, {1000, 0, 0, 0}, 500);
  CHECK(profile.duration_s == 0);
  CHECK(profile.exit_speed_pulses_s == 0);
  CHECK(at(profile, 0).distance_pulses == 0);
}
