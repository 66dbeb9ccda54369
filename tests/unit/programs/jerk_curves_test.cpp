// --limit-jerk on curves, against the plain solver of tests/reference/jerk_time_optimal.h: over circles, and corners blended with S-curves, whose
// curvature has no steps. The solver's time is below that of the best motion, by less the more steps it takes.
#include <cmath>

#include "tests/reference/jerk_time_optimal.h"
#include "tests/unit/programs/bench.h"

using namespace pmac::reference;
using pmac::test::ProgramBench;

namespace {

constexpr double kFeed = 200;        // mm/s, mu/ms
// Than the solver: 1 % of it, the parts of the limits that plans leave unused, and what the solver's steps are too few. It lacks about 1.2 steps
// of a ramp of acceleration, of which a corner has more than a circle, and finds its way through corners with few steps only.
constexpr int kCircleSteps = 400, kCornerSteps = 200;
constexpr double kSlowerCircle = 1.03, kSlowerCorner = 1.04;

struct Machine { JerkLimits x, y; };
const Machine kAlike{{500, 1, 0.02}, {500, 1, 0.02}}, kUnlike{{500, 1, 0.02}, {500, 0.4, 0.004}}, kSlow{{120, 1, 0.02}, {500, 1, 0.01}};

double run_ms(const Machine& machine, const std::string& moves) {
  const auto motor = [](int n, const JerkLimits& l) {
    const std::string m = "Motor[" + std::to_string(n) + "].";
    return m + "MaxSpeed=" + std::to_string(l.speed_mu_ms) + " " + m + "InvAmax=" + std::to_string(1 / l.accel_mu_ms2) + " " + m + "InvJmax=" + std::to_string(1 / l.jerk_mu_ms3) + "\n";
  };
  ProgramBench bench("a.pmc", "&1 #1->1000X #2->1000Y\nCoord[1].SegMoveTime=5 Coord[1].LHDistance=4000\ndefine lookahead 10000\n" + motor(1, machine.x) + motor(2, machine.y) +
                                  "open prog 1\nlinear abs F200\n" + moves + "\nclose\n", pmac::motion::FineInterpolation::kThrough, true);
  bench.run("&1 b1r");
  REQUIRE(bench.faults.empty());
  CHECK(bench.joins.empty());
  return bench.moves.back().end_ms - bench.moves.front().start_ms;
}

double best_ms(const ParameterPath& path, const Machine& machine, int steps) { return JerkTimeOptimal(path, {machine.x, machine.y}, steps).solve(5000); }

ParameterPath circle(double radius_mu) {
  const double turn = kFeed / radius_mu;   // rad/ms
  return {2 * 3.14159265358979 / turn, [=](double p, double* q, double* dq) {
            q[0] = radius_mu * (1 - std::cos(turn * p));
            q[1] = radius_mu * std::sin(turn * p);
            dq[0] = kFeed * std::sin(turn * p);
            dq[1] = kFeed * std::cos(turn * p);
          }};
}

/// Two legs at a right angle. In the blend of ta + ts about the corner the velocity goes from one leg to the other as the S-curve does: its
/// acceleration rises for ts, stays, and falls for ts (User's Manual p712).
ParameterPath blended_corner(double leg_mu, double ta_ms, double ts_ms) {
  const double whole_ms = ta_ms + ts_ms, start_ms = leg_mu / kFeed - whole_ms / 2;
  const auto turned = [=](double t) {   // part of the velocity in the second leg
    if (t <= ts_ms) return t * t / (2 * ts_ms * ta_ms);
    return t <= ta_ms ? (t - ts_ms / 2) / ta_ms : 1 - (whole_ms - t) * (whole_ms - t) / (2 * ts_ms * ta_ms);
  };
  const auto gone_ms = [=](double t) {   // its integral
    if (t <= ts_ms) return t * t * t / (6 * ts_ms * ta_ms);
    if (t <= ta_ms) return ts_ms * ts_ms / (6 * ta_ms) + ((t - ts_ms / 2) * (t - ts_ms / 2) - ts_ms * ts_ms / 4) / (2 * ta_ms);
    return t - whole_ms / 2 + std::pow(whole_ms - t, 3) / (6 * ts_ms * ta_ms);
  };
  return {2 * leg_mu / kFeed, [=](double p, double* q, double* dq) {
            const double t = std::clamp(p - start_ms, 0.0, whole_ms), part = turned(t), gone = gone_ms(t), behind = std::max(0.0, p - start_ms - whole_ms);
            q[0] = kFeed * (std::min(p, start_ms) + t - gone);
            q[1] = kFeed * (gone + behind);
            dq[0] = kFeed * (1 - part);
            dq[1] = kFeed * part;
          }};
}

void check(double time_ms, double best_ms, double slower) {
  CHECK(time_ms <= slower * best_ms);
  CHECK(time_ms >= 0.998 * best_ms);
}

}  // namespace

TEST_CASE("the plain jerk-limited solver comes to the seven phases of a line from below", "[programs][jerk]") {
  // 40 mm from rest to rest with 1 mu/ms^2 and 0.02 mu/ms^3: (v + 50) v = 40000 gives v = 176.6 mu/ms below F, and 2 (v + 50) = 453.1 ms.
  const double exact_ms = 2 * (std::sqrt(40'000 + 625) - 25 + 50);
  const ParameterPath line{40'000 / kFeed, [](double p, double* q, double* dq) { q[0] = kFeed * p, dq[0] = kFeed; }};
  for (const int steps : {100, 400}) {
    const double ms = JerkTimeOptimal(line, {{500, 1, 0.02}}, steps).solve(1000);
    CHECK(ms <= exact_ms);
    CHECK(ms >= (1 - 2.5 / steps) * exact_ms);
  }
}

TEST_CASE("circles take the time of the plain solver", "[programs][jerk]") {
  for (const Machine& machine : {kAlike, kUnlike, kSlow})
    for (const double radius : {0.2, 2.0, 20.0, 100.0}) {
      INFO(radius << " " << machine.y.jerk_mu_ms3);
      check(run_ms(machine, "ta0 ts0 circle1 X0 Y0 I" + std::to_string(radius)), best_ms(circle(1000 * radius), machine, kCircleSteps), kSlowerCircle);
    }
}

TEST_CASE("corners blended with S-curves take the time of the plain solver", "[programs][jerk]") {
  for (const Machine& machine : {kAlike, kUnlike, kSlow})
    for (const auto& [ta_ms, ts_ms] : {std::pair(40.0, 20.0), std::pair(100.0, 50.0), std::pair(60.0, 60.0)}) {
      INFO(ta_ms << " " << ts_ms << " " << machine.y.jerk_mu_ms3);
      check(run_ms(machine, "ta" + std::to_string(ta_ms) + " ts" + std::to_string(ts_ms) + " X40\nX40 Y40"), best_ms(blended_corner(40'000, ta_ms, ts_ms), machine, kCornerSteps), kSlowerCorner);
    }
}
