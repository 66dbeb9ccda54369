#include "runtime/motion/ramp.h"

#include <random>

#include <catch2/catch.hpp>

using namespace pmac::motion;

TEST_CASE("ramp: Power PMAC adds ts to ta, and takes 2 ts where ts is longer", "[motion][ramp]") {
  CHECK(make_ramp({100, 50}, 1, RampRule::kPower).total_ms() == 150);  // factory ta100 ts50: 150 ms
  CHECK(make_ramp({100, 0}, 1, RampRule::kPower).total_ms() == 100);
  CHECK(make_ramp({30, 50}, 1, RampRule::kPower).total_ms() == 100);
}

TEST_CASE("ramp: Turbo PMAC takes the larger of ta and 2 ts", "[motion][ramp]") {
  CHECK(make_ramp({100, 50}, 1, RampRule::kTurbo).total_ms() == 100);
  CHECK(make_ramp({100, 20}, 1, RampRule::kTurbo).total_ms() == 100);
  CHECK(make_ramp({30, 50}, 1, RampRule::kTurbo).total_ms() == 100);
}

TEST_CASE("ramp: negative values are rates", "[motion][ramp]") {
  // Factory JogTa -10, JogTs -50: A = 0.1 mu/ms^2, J = 0.02 mu/ms^3, Ts = A/J = 5 ms; to 32 mu/ms 320 + 5 ms.
  const Ramp full = make_ramp({-10, -50}, 32, RampRule::kPower);
  CHECK(full.ta_ms == Approx(320));
  CHECK(full.ts_ms == Approx(5));
  // Speed change below A * Ts = 0.5: full acceleration is never reached, Ts = Ta = sqrt(dv / J).
  const Ramp small = make_ramp({-10, -50}, 0.08, RampRule::kPower);
  CHECK(small.ta_ms == Approx(2));
  CHECK(small.ts_ms == Approx(2));
  // A time with a jerk rate: Ts = dv/Ta * |Ts set| = 1/100 * 500.
  CHECK(make_ramp({100, -500}, 1, RampRule::kPower).ts_ms == Approx(5));
  CHECK_FALSE(is_valid({-10, 5}));
  CHECK(is_valid({-10, 0}));
}

TEST_CASE("ramp: the integral to the middle is ta/8 + ts^2/(24 ta)", "[motion][ramp]") {
  for (const double ts : {0.0, 10.0, 40.0, 100.0}) {
    const Ramp ramp{100, ts};
    CHECK(ramp_integral_ms(ramp, ramp.total_ms() / 2) == Approx(100.0 / 8 + ts * ts / 2400));
    CHECK(ramp_integral_ms(ramp, ramp.total_ms()) == Approx(ramp.total_ms() / 2));
  }
}

TEST_CASE("ramp: value is the slope of the integral, and the parts agree with both", "[motion][ramp]") {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int i = 0; i < 200; ++i) {
    const double ta = 1 + 200 * unit(random);
    const Ramp ramp{ta, i % 5 == 0 ? 0 : ta * unit(random)};
    const double t = unit(random) * ramp.total_ms(), h = 1e-4;
    const double slope = (ramp_integral_ms(ramp, t + h) - ramp_integral_ms(ramp, t - h)) / (2 * h);
    CHECK(slope == Approx(ramp_value(ramp, t)).margin(1e-6));
    const RampParts parts = ramp_parts(ramp);
    for (int k = 0; k < parts.count; ++k) {
      const RampPart& part = parts.part[static_cast<std::size_t>(k)];
      const double d = part.duration_ms * unit(random);
      CHECK(part.value + d * (part.slope + d * part.curvature / 2) == Approx(ramp_value(ramp, part.start_ms + d)).margin(1e-12));
      CHECK(part.integral_ms + d * (part.value + d * (part.slope / 2 + d * part.curvature / 6)) ==
            Approx(ramp_integral_ms(ramp, part.start_ms + d)).margin(1e-10));
    }
  }
}

TEST_CASE("ramp distance: a symmetric reversal ends where it began", "[motion][ramp]") {
  CHECK(ramp_distance(-40, 40, {100, 20}) == Approx(0).margin(1e-12));
  CHECK(ramp_distance(0, 5, {500, 0}) == Approx(1250));
}

TEST_CASE("ramp: motor limits make it longer and never shorter", "[motion][ramp]") {
  // dv = 5: ta = 5 * 10 = 50 ms for InvAmax 10; then ts = 5 * 500 / 50 = 50.
  CHECK(lengthened({20, 0}, 5, 10, 0).ta_ms == 50);
  CHECK(lengthened({80, 0}, 5, 10, 0).ta_ms == 80);
  CHECK(lengthened({20, 10}, -5, 10, 500).ts_ms == Approx(50));
  CHECK(lengthened({20, 0}, 5, 10, 500).ts_ms == 0);  // ts0 stays a pure trapezoid
}
