// --limit-jerk: speed, acceleration and jerk of every motor at servo rate; times against the closed form of the seven phases.
#include <cmath>

#include "tests/unit/programs/bench.h"

using pmac::test::ProgramBench;

namespace {

constexpr double kPeriod_ms = 0.44274211;

struct Limits { double speed, accel, jerk; };

/// The shortest time from rest to rest over a distance: seven phases, fewer where a limit is not reached. (Biagiotti and Melchiorri,
/// "Trajectory Planning for Automatic Machines and Robots", 2008, section 3.4.)
double seven_phases_ms(double distance, Limits l) {
  const auto ramp_ms = [&](double v) { return v * l.jerk >= l.accel * l.accel ? v / l.accel + l.accel / l.jerk : 2 * std::sqrt(v / l.jerk); };
  if (ramp_ms(l.speed) * l.speed <= distance) return distance / l.speed + ramp_ms(l.speed);
  double low = 0, high = l.speed;
  for (int i = 0; i < 100; ++i) (ramp_ms((low + high) / 2) * (low + high) / 2 < distance ? low : high) = (low + high) / 2;
  return 2 * ramp_ms(low);
}

std::string set_up(Limits x, Limits y, const std::string& program) {
  const auto motor = [](int n, Limits l) {
    const std::string m = "Motor[" + std::to_string(n) + "].";
    return m + "MaxSpeed=" + std::to_string(l.speed) + " " + m + "InvAmax=" + std::to_string(1 / l.accel) + " " + m + "InvJmax=" +
           std::to_string(1 / l.jerk) + "\n";
  };
  return "&1 #1->1000X #2->1000Y\nCoord[1].SegMoveTime=5 Coord[1].LHDistance=400\ndefine lookahead 1000\n" + motor(1, x) + motor(2, y) +
         "open prog 1\nlinear abs ta0 ts0\n" + program + "\nclose\n";
}

struct Worst { double speed = 0, accel = 0, jerk = 0; };

/// Largest ratios to the limits, of any motor, the jerk not within two ticks of a join.
Worst worst_of(const ProgramBench& bench, Limits x, Limits y) {
  Worst worst;
  for (std::size_t motor = 1; motor <= 2; ++motor) {
    const Limits l = motor == 1 ? x : y;
    for (std::size_t i = 3; i < bench.motor_mu.size(); ++i) {
      const auto q = [&](std::size_t back) { return bench.motor_mu[i - back][motor]; };
      worst.speed = std::max(worst.speed, std::abs(q(0) - q(1)) / kPeriod_ms / l.speed);
      worst.accel = std::max(worst.accel, std::abs(q(0) - 2 * q(1) + q(2)) / (kPeriod_ms * kPeriod_ms) / l.accel);
      const bool at_join = std::any_of(bench.joins.begin(), bench.joins.end(), [&](const auto& join) {
        return join.time_ms >= bench.time_ms[i - 3] && join.time_ms <= bench.time_ms[i];
      });
      if (!at_join) worst.jerk = std::max(worst.jerk, std::abs(q(0) - 3 * q(1) + 3 * q(2) - q(3)) / std::pow(kPeriod_ms, 3) / l.jerk);
    }
  }
  return worst;
}

ProgramBench run(Limits x, Limits y, const std::string& program) {
  ProgramBench bench("a.pmc", set_up(x, y, program), pmac::motion::FineInterpolation::kThrough, true);
  bench.run("&1 b1r");
  REQUIRE(bench.faults.empty());
  REQUIRE(bench.refusals.empty());
  return bench;
}

}  // namespace

TEST_CASE("straight moves take the seven phases, whatever their length", "[programs][jerk]") {
  const Limits limits{500, 1, 0.02};
  for (const double feed : {20.0, 200.0, 800.0})
    for (const double length : {0.0005, 0.01, 0.3, 1.0, 7.0, 40.0, 300.0}) {
      ProgramBench bench("a.pmc", set_up(limits, limits, "F" + std::to_string(feed) + " X" + std::to_string(length)),
                         pmac::motion::FineInterpolation::kThrough, true);
      bench.run("&1 b1r");
      REQUIRE(bench.moves.size() == 1);
      INFO(feed << " " << length);
      const double best_ms = seven_phases_ms(1000 * length, {std::min(feed, 500.0), 1, 0.02});
      CHECK(bench.moves[0].end_ms <= 1.02 * best_ms);
      CHECK(bench.moves[0].end_ms >= 0.999 * best_ms);
      const Worst worst = worst_of(bench, limits, limits);
      CHECK(worst.speed <= 1.001);
      CHECK(worst.accel <= 1.001);
      CHECK(worst.jerk <= 1.05);
      CHECK(bench.motor(1).final_mu == Approx(1000 * length).margin(1e-6));
      CHECK(bench.joins.empty());
    }
}

TEST_CASE("of two motors the tighter limit counts along a straight line", "[programs][jerk]") {
  const Limits x{500, 1, 0.02}, y{100, 0.4, 0.002};
  ProgramBench bench("a.pmc", set_up(x, y, "F200 X60 Y80"), pmac::motion::FineInterpolation::kThrough, true);
  bench.run("&1 b1r");
  // Direction (0.6, 0.8): along the line 125 mu/ms, 0.5 mu/ms^2 and 0.0025 mu/ms^3, all from Y.
  const double best_ms = seven_phases_ms(100'000, {125, 0.5, 0.0025});
  REQUIRE(bench.moves.size() == 1);
  CHECK(bench.moves[0].end_ms <= 1.02 * best_ms);
  CHECK(bench.moves[0].end_ms >= 0.999 * best_ms);
  const Worst worst = worst_of(bench, x, y);
  CHECK(worst.speed <= 1.001);
  CHECK(worst.accel <= 1.001);
  CHECK(worst.jerk <= 1.05);
}

TEST_CASE("a line in many short blocks is run as one line", "[programs][jerk]") {
  const Limits x{500, 1, 0.02}, y{500, 1, 0.002};
  for (const int blocks : {8, 250}) {   // of whole decimals: rounded end points would bend the line
    std::string text = "F200\n";
    for (int i = 1; i <= blocks; ++i) text += "X" + std::to_string(30.0 * i / blocks) + " Y" + std::to_string(40.0 * i / blocks) + "\n";
    const ProgramBench bench = run(x, y, text);
    INFO(blocks);
    // Direction (0.6, 0.8): acceleration and jerk from Y, the speed from F.
    const double best_ms = seven_phases_ms(50'000, {200, 1.25, 0.0025}), time_ms = bench.moves.back().end_ms - bench.moves.front().start_ms;
    CHECK(time_ms <= 1.02 * best_ms);
    CHECK(time_ms >= 0.999 * best_ms);
    const Worst worst = worst_of(bench, x, y);
    CHECK(worst.accel <= 1.001);
    CHECK(worst.jerk <= 1.05);
    CHECK(bench.joins.empty());
  }
}

TEST_CASE("changes of the feed rate along a line are run as fast as the jerk allows", "[programs][jerk]") {
  const Limits limits{500, 1, 0.02};
  const ProgramBench bench = run(limits, limits, "F200 X60\nF50 X120\nF150 X180");
  // From v to w without reaching the limit of acceleration or with it: |v - w| / A + A / J at their mean speed; the rest at constant speed.
  const auto change_ms = [](double from, double to) { return std::abs(from - to) + 50; };
  const auto leg_ms = [&](double length, double start, double speed, double end) {
    double ramps_ms = 0, left = length;
    for (const double other : {start, end}) {
      if (other >= speed) continue;   // the ramp lies in the faster leg
      ramps_ms += change_ms(other, speed);
      left -= change_ms(other, speed) * (other + speed) / 2;
    }
    return ramps_ms + left / speed;
  };
  const double best_ms = leg_ms(60'000, 0, 200, 50) + leg_ms(60'000, 200, 50, 150) + leg_ms(60'000, 50, 150, 0);
  const double time_ms = bench.moves.back().end_ms - bench.moves.front().start_ms;
  CHECK(time_ms <= 1.005 * best_ms);   // it may even be shorter: braking until the slower leg and a little beyond
  for (std::size_t i = 1; i < bench.motor_mu.size(); ++i)
    if (bench.motor_mu[i - 1][1] > 60'000 && bench.motor_mu[i][1] < 120'000) CHECK(bench.motor_mu[i][1] - bench.motor_mu[i - 1][1] <= 1.001 * 50 * kPeriod_ms);
  const Worst worst = worst_of(bench, limits, limits);
  CHECK(worst.accel <= 1.001);
  CHECK(worst.jerk <= 1.05);
}

TEST_CASE("cusps, where a blend nearly turns back on itself, keep the jerk limit", "[programs][jerk]") {
  const Limits limits{500, 1, 0.02};
  for (const char* ramps : {"ta0 ts20", "ta25 ts20", "ta3 ts30", "ta50 ts0"})
    for (const char* offset : {"1", "0.01", "0.0001"}) {
      const std::string y = offset;
      const ProgramBench bench = run(limits, limits, std::string(ramps) + " F150 X20\nX0 Y" + y + "\nX20 Y0\nX0 Y" + y + "\nX3 Y5");
      INFO(ramps << " " << offset);
      const Worst worst = worst_of(bench, limits, limits);
      CHECK(worst.speed <= 1.001);
      CHECK(worst.accel <= 1.001);
      CHECK(worst.jerk <= 1.05);
      CHECK(bench.motor_mu.back()[1] == Approx(3000).margin(1e-3));
      CHECK(bench.motor_mu.back()[2] == Approx(5000).margin(1e-3));
    }
}

/// A circle at the speed at which its jerk v^3 / r^2 and its acceleration v^2 / r keep their limits in every direction, and ramps of the seven
/// phases to and from it. A motion along a circle has to share the limits with the ramps, but may run faster along the diagonals.
double steady_circle_ms(double radius, double feed, Limits l) {
  const double v = std::min({feed, std::cbrt(l.jerk * radius * radius), std::sqrt(l.accel * radius)});
  const double ramp_ms = v * l.jerk >= l.accel * l.accel ? v / l.accel + l.accel / l.jerk : 2 * std::sqrt(v / l.jerk);
  return 2 * 3.14159265358979 * radius / v + ramp_ms;
}

TEST_CASE("circles take about as long as at their steady speed", "[programs][jerk]") {
  const Limits limits{500, 1, 0.02};
  for (const double radius : {0.2, 2.0, 20.0, 200.0}) {
    const ProgramBench bench = run(limits, limits, "F200 circle1 X0 Y0 I" + std::to_string(radius));
    INFO(radius);
    CHECK(bench.moves.at(0).end_ms <= 1.07 * steady_circle_ms(1000 * radius, 200, limits));
  }
}

TEST_CASE("with a window that covers the stop, planning in parts is planning the whole path", "[programs][jerk]") {
  const Limits limits{500, 1, 0.02};
  std::string path = "F200 ta20 ts5\n";
  for (int i = 0; i < 12; ++i) path += "X" + std::to_string(5 * (i % 3)) + " Y" + std::to_string(4 * i) + "\ncircle1 X" + std::to_string(5 * (i % 3) + 3) + " Y" + std::to_string(4 * i + 1) + " R4\nlinear\n";
  const auto time_ms = [&](const char* window) {
    std::string text = set_up(limits, limits, path);
    text.replace(text.find("LHDistance=400"), 14, window);
    ProgramBench bench("a.pmc", text, pmac::motion::FineInterpolation::kThrough, true);
    bench.run("&1 b1r");
    const Worst worst = worst_of(bench, limits, limits);
    CHECK(worst.accel <= 1.001);
    CHECK(worst.jerk <= 1.05);
    return bench.moves.back().end_ms;
  };
  const double whole_ms = time_ms("LHDistance=5000");
  CHECK(time_ms("LHDistance=200") == Approx(whole_ms).epsilon(0.003));
  CHECK(time_ms("LHDistance=20") > whole_ms);
}

TEST_CASE("a circle from rest to rest keeps the jerk limit everywhere", "[programs][jerk]") {
  const Limits limits{500, 1, 0.02};
  for (const double radius : {2.0, 20.0, 200.0}) {
    const ProgramBench bench = run(limits, limits, "F200 circle1 X0 Y0 I" + std::to_string(radius));
    INFO(radius);
    const Worst worst = worst_of(bench, limits, limits);
    CHECK(worst.accel <= 1.001);
    CHECK(worst.jerk <= 1.05);
    CHECK(bench.joins.empty());
    double off = 0;
    for (const auto& row : bench.motor_mu) off = std::max(off, std::abs(std::hypot(row[1] - 1000 * radius, row[2]) - 1000 * radius));
    CHECK(off < 1);   // 1 um
  }
}

TEST_CASE("lines and arcs: jerk beyond the limit at the joins alone, which are listed", "[programs][jerk]") {
  const Limits limits{500, 1, 0.02};
  const ProgramBench bench = run(limits, limits, "F200 X40\ncircle2 X40 Y40 I0 J20\nlinear X0\ncircle2 X0 Y0 I0 J-20\ndelay 50\nlinear X-1\nF50 X-9\nX-2");
  const Worst worst = worst_of(bench, limits, limits);
  CHECK(worst.speed <= 1.001);
  CHECK(worst.accel <= 1.001);
  CHECK(worst.jerk <= 1.05);
  CHECK(bench.joins.size() == 3);   // into the first arc, out of it, into the second; after that motion stops
  for (const auto& join : bench.joins) CHECK(join.ratio > 1);
}

TEST_CASE("ramps with S-curves and blends keep the limits too", "[programs][jerk]") {
  const Limits limits{500, 1, 0.02};
  const ProgramBench bench = run(limits, limits, "ta60 ts30 F100 X20\nY20\nX0 Y25\nX0.4\nX0\nta10 ts0 X5 Y0");
  const Worst worst = worst_of(bench, limits, limits);
  CHECK(worst.speed <= 1.001);
  CHECK(worst.accel <= 1.001);
  CHECK(worst.jerk <= 1.05);
}
