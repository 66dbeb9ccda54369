// Several cards: when moves begin and end, and what happens when a card does not come to the barrier. The contour is the manual's
// (chapter 8) with closed-form times: 2 s of line, 4.7124 s of each arc, 2 s and 6.8284 s of line at 10000 pulses/s.
#include <catch2/catch.hpp>

#include "tests/unit/acr1000/scripted_driver.h"

using namespace pmac::acr1000;

namespace {

std::vector<ScriptedDriver::Step> contour_x() {
  return {rates({10000, 0, 0, 0}), mov(20000, 0), circle(47124, 34142, {1, 20000, -20000, 0, 47124}),
          circle(47124, 68284, {1, 20000, -14142, 14142, 47124}), mov(20000, 68284), mov(68284, 0)};
}
std::vector<ScriptedDriver::Step> contour_y() {
  return {rates({10000, 0, 0, 0}), mov(20000, 20000), circle(47124, 34142, {1, 20000, 0, 20000, 47124}),
          circle(47124, 20000, {1, 20000, 14142, 14142, 47124}), mov(20000, 0), mov(68284, 0)};
}

}  // namespace

TEST_CASE("two cards: the contour begins its moves together and is over after 20.2532 s", "[acr1000]") {
  Scene scene;
  scene.add("X", contour_x());
  scene.add("Y", contour_y());
  const SystemOutcome outcome = scene.run();
  CHECK(outcome.end == SystemEnd::kIdle);
  CHECK(outcome.time_s == Approx(20.2532).epsilon(1e-12));
  const double starts[] = {0, 2, 6.7124, 11.4248, 13.4248};
  REQUIRE(scene.moves.size() == 10);
  for (std::size_t k = 0; k < scene.moves.size(); ++k) {
    CHECK(scene.moves[k].start_s == Approx(starts[k / 2]).epsilon(1e-12));
    CHECK(scene.moves[k].coordinated == k / 2 + 1);
    CHECK(scene.moves[k].card == k % 2);
  }
  CHECK(scene.notices.empty());
  CHECK(scene.system.card(0).commanded_pulses() == 0);
  CHECK(scene.system.card(0).memory().move_counter() == 5);
}

TEST_CASE("two cards: while they move, every stretch of time has both axes on the path", "[acr1000]") {
  Scene scene;
  double worst = 0, covered = 0;
  SystemObservers observers;
  CardSystem system({{}, {}, {}, [&](double from, double to) {
    covered += to - from;
    if (from < 1.999 || to > 6.7125) return;
    for (int k = 0; k < 1000; ++k) {
      const double t = from + (to - from) * k / 1000;
      const double dx = system.card(0).at(t).position_pulses - 20000, dy = system.card(1).at(t).position_pulses - 20000;
      worst = std::max(worst, std::abs(std::hypot(dx, dy) / 20000 - 1));
    }
  }});
  Card& x = system.add({});
  x.driver = std::make_unique<ScriptedDriver>(x, contour_x());
  Card& y = system.add({});
  y.driver = std::make_unique<ScriptedDriver>(y, contour_y());
  system.run({});
  CHECK(worst < 1e-9);
  CHECK(covered == Approx(20.2532));
}

TEST_CASE("one card: moves with STP 0 carry their speed on, a program that polls the busy relay starts from rest", "[acr1000]") {
  Scene joined;
  joined.add("X", {rates({1000, 500, 500, 0}), mov(0, 10000), mov(0, 20000)});
  joined.run();
  CHECK(joined.moves[0].end_s == Approx(11));        // 2 s of ramp over 1000, 9 s at 1000
  CHECK(joined.moves[1].entry_speed_pulses_s == 1000);
  CHECK(joined.moves[1].end_s == Approx(21));

  Scene polled;
  polled.add("X", {rates({1000, 500, 500, 0}), mov(0, 10000), if_relay(96, 2), mov(0, 20000)});
  polled.run();
  CHECK(polled.moves[1].start_s == polled.moves[0].end_s);
  CHECK(polled.moves[1].entry_speed_pulses_s == 0);
  CHECK(polled.moves[1].end_s == Approx(22));
}

TEST_CASE("coordinated: an axis that is where it should be waits for the move's time, an independent one does not", "[acr1000]") {
  Scene scene;
  scene.add("X", {rates({10000, 0, 0, 0}), mov(20000, 0), mov(20000, 20000)});
  scene.add("Y", {rates({10000, 0, 0, 0}), mov(20000, 20000), mov(20000, 20000)});
  CHECK(scene.run().time_s == Approx(4));
  CHECK(scene.moves[0].end_s == Approx(2));

  Scene alone;
  alone.add("X", {rates({10000, 0, 0, 0}), mov(0, 0), mov(0, 20000)});
  CHECK(alone.run().time_s == Approx(2));
  CHECK(alone.system.card(0).memory().move_counter() == 2);
}

TEST_CASE("independent moves do not wait for other cards, coordinated ones after them do", "[acr1000]") {
  Scene scene;
  scene.add("X", {rates({1000, 0, 0, 0}), mov(0, 1000), mov(1000, 2000)});
  scene.add("Y", {rates({1000, 0, 0, 0}), mov(0, 3000), mov(1000, 3000)});
  scene.run();
  CHECK(scene.system.time_s() == Approx(4));
  for (const CardMoveRecord& move : scene.moves)
    if (move.coordinated == 1) CHECK(move.start_s == Approx(3));
}

TEST_CASE("sixteen cards run together, a seventeenth is refused", "[acr1000]") {
  Scene scene;
  for (int k = 0; k < 16; ++k) scene.add("A" + std::to_string(k), {rates({1000, 0, 0, 0}), mov(16000, 1000 * (k + 1)), mov(16000, 0)});
  CHECK(scene.run().time_s == Approx(32));
  CHECK(scene.moves.size() == 32);
  CHECK_THROWS(scene.add("Q", {}));
}

TEST_CASE("faults between cards: one program ends early", "[acr1000]") {
  Scene scene;
  scene.add("X", {rates({1000, 0, 0, 0}), mov(1000, 1000), mov(1000, 2000), mov(1000, 3000)});
  scene.add("Y", {rates({1000, 0, 0, 0}), mov(1000, 500)});
  const SystemOutcome outcome = scene.run();
  CHECK(outcome.end == SystemEnd::kIdle);
  CHECK(outcome.time_s == Approx(1));
  REQUIRE(scene.ids() == "ACR-E13");
  CHECK(scene.notices[0].text.find("axis X waits at line 30 for coordinated move 2") != std::string::npos);
  CHECK(scene.notices[0].text.find("axis Y has ended (last at line 20)") != std::string::npos);
  CHECK(scene.notices[0].time_s == Approx(1));
}

TEST_CASE("faults between cards: one card halts with an error", "[acr1000]") {
  Scene scene;
  scene.add("X", {rates({1000, 0, 0, 0}), mov(1000, 1000), mov(1000, 2000)});
  scene.add("Y", {rates({1000, 0, 0, 0}), mov(1000, 500), rates({0, 0, 0, 0}), mov(1000, 600)});
  scene.run();
  REQUIRE(scene.ids() == "ACR-E11 ACR-E13");
  CHECK(scene.notices[0].place.line_number == 40);
  CHECK(scene.notices[1].text.find("axis Y was stopped by ACR-E11 at line 40") != std::string::npos);
}

TEST_CASE("faults between cards: one is halted by its host", "[acr1000]") {
  Scene scene;
  scene.add("X", {rates({1000, 0, 0, 0}), mov(1000, 1000), mov(1000, 2000), mov(1000, 3000)});
  scene.add("Y", {rates({1000, 0, 0, 0}), mov(1000, 500), mov(1000, 600), mov(1000, 700)});
  scene.system.at(0.5, [&] { scene.system.halt(1); });
  scene.run();
  REQUIRE(scene.ids() == "ACR-E13");
  CHECK(scene.notices[0].time_s == Approx(1));
  CHECK(scene.system.time_s() == Approx(1));
}

TEST_CASE("faults between cards: one waits for ever while another polls a relay that nobody sets", "[acr1000]") {
  Scene scene;
  scene.add("X", {rates({1000, 0, 0, 0}), mov(1000, 1000)});
  scene.add("Y", {rates({1000, 0, 0, 0}), go_to(1)});
  scene.run();
  REQUIRE(scene.ids() == "ACR-E13");
  CHECK(scene.notices[0].text.find("axis Y loops at line 20 without a motion command") != std::string::npos);
}

TEST_CASE("faults between cards: a card that waits while another moves alone without end is named at the time limit", "[acr1000]") {
  Scene scene;
  scene.add("X", {rates({1000, 0, 0, 0}), mov(1000, 1000)});
  scene.add("Y", {rates({1000, 0, 0, 1000000}), mov(0, 1000), mov(0, 0), go_to(1)});
  SystemLimits limits;
  limits.max_s = 10;
  CHECK(scene.run(limits).end == SystemEnd::kTimeLimit);
  CHECK(scene.ids() == "ACR-W08 ACR-W08");
}

TEST_CASE("faults between cards: P28 differs", "[acr1000]") {
  Scene scene;
  scene.add("X", {rates({1000, 0, 0, 0}), mov(1000, 1000), mov(1000, 2000)});
  scene.add("Y", {rates({1000, 0, 0, 0}), mov(3000, 1000), mov(1000, 2000)});
  CHECK(scene.run().time_s == Approx(4));   // the second move waits for the slower card
  REQUIRE(scene.ids() == "ACR-W04");
  CHECK(scene.notices[0].text.find("coordinated move 1: P28 is 1000 on axis X and 3000 on axis Y") != std::string::npos);
  CHECK(scene.moves[1].end_s == Approx(3));
  CHECK(scene.moves[2].entry_speed_pulses_s == 0);      // X stood still for 2 s
}

TEST_CASE("loops: one that can change nothing any more ends the run", "[acr1000]") {
  Scene scene;
  scene.add("X", {rates({1000, 0, 0, 0}), mov(0, 5000), go_to(2)});
  const SystemOutcome outcome = scene.run();
  CHECK(outcome.end == SystemEnd::kIdle);
  CHECK(outcome.time_s == Approx(5));
  CHECK(scene.system.endless_loops().size() == 1);
}

TEST_CASE("loops: moves without end run to the time limit, with what was under way", "[acr1000]") {
  Scene scene;
  scene.add("X", {rates({1000, 0, 0, 1000000}), mov(0, 5000), mov(0, 0), go_to(1)});
  SystemLimits limits;
  limits.max_s = 12;
  const SystemOutcome outcome = scene.run(limits);
  CHECK(outcome.end == SystemEnd::kTimeLimit);
  CHECK(outcome.time_s == 12);
  CHECK(scene.ids() == "ACR-W08");
  REQUIRE(scene.moves.size() == 3);
  CHECK(scene.moves[2].end_s == 12);
  CHECK(scene.moves[2].to_pulses == Approx(1999));   // each stop ramp cost 0.5 ms
}

TEST_CASE("loops: moves that go nowhere do not hang", "[acr1000]") {
  Scene scene;
  scene.add("X", {rates({1000, 0, 0, 0}), mov(0, 0), go_to(1)});
  CHECK(scene.run().end == SystemEnd::kIdle);
}

TEST_CASE("loops: one that counts takes a millisecond a pass and sees its time limit", "[acr1000]") {
  Scene scene;
  scene.add("X", {[](ScriptedDriver& d) { d.values.resize(1); d.values[0] += 1; return DriverStop::kBudget; }, go_to(0)});
  SystemLimits limits;
  limits.max_s = 1;
  CHECK(scene.run(limits).end == SystemEnd::kTimeLimit);
}

TEST_CASE("a command limit ends a run that takes no time", "[acr1000]") {
  Scene scene;
  scene.add("X", {[](ScriptedDriver& d) { d.next = 0; return DriverStop::kBudget; }});
  SystemLimits limits;
  limits.max_commands = 1000;
  const SystemOutcome outcome = scene.run(limits);
  CHECK(outcome.end == SystemEnd::kBudget);
  CHECK(scene.ids() == "ACR-W08");
}

TEST_CASE("a relay set by the host lets a polling program go on", "[acr1000]") {
  Scene scene;
  Card& x = scene.add("X", {rates({1000, 0, 0, 0}), if_relay(5, 3), go_to(1), mov(0, 1000)});
  scene.system.at(2.5, [&] { x.set_relay(5, true); scene.system.wake(0); });
  CHECK(scene.run().time_s == Approx(3.5));
  CHECK(scene.moves[0].start_s == 2.5);
}
