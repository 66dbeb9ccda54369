// Holds, pauses, overrides, quick stops, steps and aborts at odd moments of every kind of motion, one within another: positions and speeds
// are continuous at servo rate, what goes on ends where the undisturbed program ends, what is aborted comes to rest in its ramp.
//
// With the time base s(t) a motor's acceleration is s^2 a + s' v: never above what the program has by itself plus its speed times the slew.
#include <algorithm>
#include <cmath>

#include "tests/unit/programs/bench.h"

using pmac::test::ProgramBench;

namespace {

constexpr double kSlew = 0.01;        // of the time base, 1/ms
constexpr double kAbortAccel = 0.2;   // mu/ms^2

const std::string kSetUp =
    "Sys.ServoPeriod=1\n&1 #1->1000X #2->1000Y\nMotor[1].JogTa=-10 Motor[1].JogTs=0 Motor[2].JogTa=-10 Motor[2].JogTs=0\n"
    "Motor[1].AbortTa=-5 Motor[2].AbortTa=-5 Motor[1].AbortTs=0 Motor[2].AbortTs=0\nCoord[1].TimeBaseSlew=0.01 Coord[1].FeedHoldSlew=0.01\n"
    "Motor[1].MaxSpeed=20 Motor[2].MaxSpeed=20\n";
const std::string kSegments = "Coord[1].SegMoveTime=5\n";
const std::string kLookahead = "Coord[1].SegMoveTime=5 Coord[1].LHDistance=60\ndefine lookahead 1000\n";
const std::string kArcs = "linear abs ta100 ts20 F10\nX5\ncircle2 X5 Y6 I0 J3\nlinear X2 Y4\ncircle1 X0 Y0 R4\n";

struct Case { std::string name, set_up, moves; };

const std::vector<Case>& cases() {
  static const std::vector<Case> all = {
      {"lines", "", "linear abs ta100 td100 ts0 F8\nX3\nX4 Y4\nY0\n"},
      {"s-curves", "", "linear abs ta100 td100 ts50 F8\nX3\nX4 Y4\nY0\n"},
      {"segmented arcs", kSegments, kArcs},
      {"arcs with lookahead", kLookahead, kArcs},
      {"rapid", "", "rapid abs X9 Y3\nX2 Y5\n"},
      {"pvt", "", "abs pvt200\nX1:8 Y0:2\nX3:8 Y1:4\nX4:0 Y1.5:0\n"},
      {"segmented pvt", kSegments, "abs pvt200\nX1:8 Y0:2\nX3:8 Y1:4\nX4:0 Y1.5:0\n"},
      {"spline", "", "abs spline150\nX1 Y0\nX2 Y1\nX3 Y1\nX4 Y0\n"},
      {"dwell and delay", "", "linear abs ta100 td100 ts0 F8\nX3\ndwell 200\nX2\ndelay 300\nX0 Y2\nrapid X3\n"},
  };
  return all;
}

struct Action { double after_ms; std::string command; };
using Actions = std::vector<Action>;

struct Bounds { double speed = 0, accel = 0; };

Bounds bounds_of(ProgramBench& bench) {
  return {std::max(bench.motor(1).max_speed_mu_ms, bench.motor(2).max_speed_mu_ms), std::max(bench.motor(1).max_accel_mu_ms2, bench.motor(2).max_accel_mu_ms2)};
}

/// A program that has ended does nothing when it is started again.
std::string text_of(const Case& c) { return kSetUp + c.set_up + "open prog 1\nP1++\nif (P1 == 1) {\n" + c.moves + "}\nclose\n"; }

std::unique_ptr<ProgramBench> disturbed(const Case& c, const Actions& actions, double at_ms) {
  auto bench = std::make_unique<ProgramBench>("a.pmc", text_of(c));
  for (const Action& action : actions) bench->machine->at(at_ms + action.after_ms, "&1 " + action.command);
  bench->machine->at(20'000, "Coord[1].ProgActive");
  bench->run("&1 b1r");
  return bench;
}

/// fastest: largest rate of the time base in the actions.
void check_going_on(const Actions& actions, double fastest = 1) {
  for (const Case& c : cases()) {
    ProgramBench plain("a.pmc", text_of(c));
    const double total_ms = plain.run("&1 b1r").time_ms - 20;
    const Bounds free = bounds_of(plain);
    for (double at_ms = 37; at_ms < total_ms; at_ms += total_ms / 7.3) {
      INFO(c.name << ", " << actions[0].command << " at " << at_ms);
      const auto bench = disturbed(c, actions, at_ms);
      CHECK(bench->faults.empty());
      CHECK(bench->answers.back() == "Coord[1].ProgActive=0");
      CHECK(bench->motor(1).final_mu == Approx(plain.motor(1).final_mu).margin(1e-6));
      CHECK(bench->motor(2).final_mu == Approx(plain.motor(2).final_mu).margin(1e-6));
      const Bounds there = bounds_of(*bench);
      CHECK(there.speed <= free.speed * fastest * 1.001);
      CHECK(there.accel <= (free.accel * fastest * fastest + free.speed * fastest * kSlew) * 1.01);
    }
  }
}

void check_abort(const Actions& actions) {
  for (const Case& c : cases()) {
    ProgramBench plain("a.pmc", text_of(c));
    const double total_ms = plain.run("&1 b1r").time_ms - 20;
    const Bounds free = bounds_of(plain);
    for (double at_ms = 37; at_ms < total_ms; at_ms += total_ms / 9.7) {
      INFO(c.name << ", " << actions[0].command << " at " << at_ms);
      const auto bench = disturbed(c, actions, at_ms);
      CHECK(bench->faults.empty());
      CHECK(bench->answers.back() == "Coord[1].ProgActive=0");
      const Bounds there = bounds_of(*bench);
      CHECK(there.speed <= free.speed * 1.001);
      CHECK(there.accel <= std::max(free.accel + free.speed * kSlew, kAbortAccel) * 1.01);
      const auto& rows = bench->motor_mu;
      const auto still = static_cast<std::size_t>(at_ms + actions.back().after_ms + free.speed / kAbortAccel + 3);
      for (std::size_t k = still; k < rows.size(); ++k) REQUIRE(rows[k] == rows[still]);
    }
  }
}

}  // namespace

TEST_CASE("feed hold and on again, once and in its own slope", "[stops]") {
  check_going_on({{0, "h"}, {400, "r"}});
  check_going_on({{0, "h"}, {20, "r"}, {40, "h"}, {60, "h"}, {300, "r"}, {310, "r"}});
}

TEST_CASE("pause and step", "[stops]") {
  check_going_on({{0, "q"}, {6000, "r"}});
  check_going_on({{0, "q"}, {10, "q"}, {6000, "r"}});
  check_going_on({{0, "s"}, {6000, "s"}, {12000, "r"}});
}

TEST_CASE("override to nothing and back, and within its slope", "[stops]") {
  check_going_on({{0, "%0"}, {300, "%100"}});
  check_going_on({{0, "%50"}, {20, "%0"}, {40, "%70"}, {60, "%0"}, {300, "%100"}});
  check_going_on({{0, "%150"}, {100, "%100"}}, 1.5);
}

TEST_CASE("quick stop and forward, once and in its own slope", "[stops]") {
  check_going_on({{0, "\\"}, {500, ">"}});
  check_going_on({{0, "\\"}, {30, ">"}, {60, "\\"}, {70, "\\"}, {500, ">"}, {505, ">"}});
}

TEST_CASE("one stop within another", "[stops]") {
  check_going_on({{0, "h"}, {50, "\\"}, {500, "r"}});
  check_going_on({{0, "\\"}, {50, "h"}, {500, "r"}});
  check_going_on({{0, "h"}, {30, "q"}, {400, "r"}, {8000, "r"}});
  check_going_on({{0, "%0"}, {50, "h"}, {300, "%100"}, {500, "r"}});
  check_going_on({{0, "%0"}, {50, "\\"}, {300, "%100"}, {500, ">"}});
  check_going_on({{0, "h"}, {300, "s"}, {8000, "r"}});
}

TEST_CASE("abort anywhere comes to rest in its ramp", "[stops]") {
  check_abort({{0, "a"}});
  check_abort({{0, "a"}, {10, "a"}});
  check_abort({{0, "h"}, {50, "a"}});
  check_abort({{0, "h"}, {200, "a"}});
  check_abort({{0, "%50"}, {70, "a"}});
  check_abort({{0, "\\"}, {40, "a"}});
  check_abort({{0, "q"}, {40, "a"}});
}

TEST_CASE("adisable kills at rest, and a program that was aborted starts from where it is", "[stops]") {
  for (const Case& c : cases()) {
    ProgramBench plain("a.pmc", text_of(c));
    plain.run("&1 b1r");
    INFO(c.name);
    const auto bench = disturbed(c, {{0, "a"}, {500, "P1=0 r"}}, 250);
    CHECK(bench->faults.empty());
    CHECK(bench->refusals.empty());
    CHECK(bench->motor(1).final_mu == Approx(plain.motor(1).final_mu).margin(1e-6));
    CHECK(bench->motor(2).final_mu == Approx(plain.motor(2).final_mu).margin(1e-6));
  }
}
