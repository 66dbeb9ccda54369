// Host, line and servos together.
#include <catch2/catch.hpp>

#include <cmath>

#include "runtime/drives/silverlode/network.h"
#include "runtime/drives/silverlode/units.h"
#include "tests/unit/silverlode/circles.h"

using namespace pmac::drives::silverlode;
using pmac::test::circle;
using pmac::test::table_of;

namespace {

struct Run {
  NetworkResult result;
  double radial_min = 1e300, radial_max = -1e300, x = 0, y = 0, furthest_x = 0;
  bool has(const std::string& text, bool is_error) const {
    for (const NetworkEvent& event : result.events)
      if (event.is_error == is_error && event.text.find(text) != std::string::npos) return true;
    return false;
  }
  bool has_errors() const {
    for (const NetworkEvent& event : result.events)
      if (event.is_error) return true;
    return false;
  }
};

Run run(const CircleSetup& circle_setup, const NetworkSetup& setup) {
  Run r;
  REQUIRE_FALSE(problem_of(setup, 2));
  r.result = run_network(table_of(circle_setup, false), setup, [&](std::int64_t, std::span<const Profile> servos) {
    r.x = static_cast<double>(servos[0].position) / kUnitsPerCount;
    r.y = static_cast<double>(servos[1].position) / kUnitsPerCount;
    r.furthest_x = std::max(r.furthest_x, r.x);
    const double error = radial_error_counts(circle_setup, r.x, r.y);
    r.radial_min = std::min(r.radial_min, error);
    r.radial_max = std::max(r.radial_max, error);
  });
  return r;
}

}  // namespace

TEST_CASE("network: a late follower widens the radial error by v t / 2 on each side", "[silverlode]") {
  const auto late = [](int ticks) {
    NetworkSetup setup;
    setup.start_latency_ticks = ticks;
    return run(circle(72), setup);
  };
  const Run none = late(0), one = late(1), eight = late(8), many = late(42);
  CHECK(none.radial_min == Approx(-3.807).margin(0.001));
  CHECK(none.radial_max == Approx(0).margin(0.001));
  CHECK(one.radial_min == Approx(-3.867).margin(0.001));
  CHECK(one.radial_max == Approx(0.055).margin(0.001));
  CHECK(eight.radial_min == Approx(-4.285).margin(0.001));
  CHECK(eight.radial_max == Approx(0.458).margin(0.001));
  CHECK(many.radial_min == Approx(-6.317).margin(0.001));
  CHECK(many.radial_max == Approx(2.407).margin(0.001));
  CHECK(eight.has("Y started 8 ticks", false));
  CHECK_FALSE(eight.has_errors());
  CHECK(eight.result.executed == std::vector<std::size_t>{73, 73});
}

TEST_CASE("network: a leader that waits makes up for the followers' latency", "[silverlode]") {
  NetworkSetup setup;
  setup.start_latency_ticks = 42;
  setup.compensate_start = true;
  const Run waited = run(circle(72), setup);
  CHECK(waited.radial_min == Approx(-3.807).margin(0.001));
  CHECK(waited.radial_max == Approx(0).margin(0.001));
}

TEST_CASE("network: a full queue refuses with code 6 and the entry comes again", "[silverlode]") {
  const Run r = run(circle(72), {});
  CHECK(r.result.full_queue_refusals > 0);
  CHECK(r.has("buffer full (6)", false));
  CHECK_FALSE(r.has_errors());
  CHECK(std::hypot(r.x, r.y) < 0.001);
}

TEST_CASE("network: a line that is too slow lets the queues run dry, and every axis says so", "[silverlode]") {
  CircleSetup fast = circle(360);
  fast.velocity = 8000;      // 26 slices of 8.7 ms a line of 16.7 ms an entry
  const Run r = run(fast, {});
  CHECK(r.has("X: the queue ran dry", true));
  CHECK(r.has("Y: the queue ran dry", true));
  CHECK(r.has("were not executed", true));
  fast.min_slice_s = 0.02;
  CHECK_FALSE(run(fast, {}).has_errors());
}

TEST_CASE("network: a frame that is lost and not repeated ends in an underrun of both axes", "[silverlode]") {
  NetworkSetup setup;
  setup.lost_frames = {20};
  setup.retries = 0;
  const Run r = run(circle(72), setup);
  CHECK(r.has("no answer after 1 tries", true));
  CHECK(r.result.gave_up);
  CHECK(r.result.ran_dry == std::vector<bool>{true, true});
  setup.retries = 2;
  CHECK_FALSE(run(circle(72), setup).has_errors());
}

TEST_CASE("network: wrong and doubled ids are found before anything moves", "[silverlode]") {
  NetworkSetup setup;
  setup.servo_ids = {16, 19};
  const Run wrong = run(circle(72), setup);
  CHECK(wrong.has("RUN to 17: 2: no answer", true));
  CHECK(wrong.has("X never started", true));
  setup.servo_ids = {16, 16};
  CHECK(run(circle(72), setup).has("two servos answer at once", true));
}

TEST_CASE("network: without the wire of I/O 1 the follower never starts", "[silverlode]") {
  NetworkSetup setup;
  setup.wired = false;
  const Run r = run(circle(72), setup);
  CHECK(r.has("Y never started", true));
  CHECK(r.has("the queue has been full", true));
  CHECK(r.y == 0);
}

TEST_CASE("network: an entry takes 17 ms on a line of 57600 baud", "[silverlode]") {
  CHECK(link_time_per_entry_s(table_of(circle(72), false), {}) == Approx(0.017).margin(0.0005));
  NetworkSetup fast;
  fast.baud = 115200;
  CHECK(link_time_per_entry_s(table_of(circle(72), false), fast) == Approx(0.0086).margin(0.0005));
}

TEST_CASE("network: stop, restart, jog and centre", "[silverlode]") {
  using Kind = PanelAction::Kind;
  NetworkSetup setup;
  setup.actions = {{5, Kind::kStop}, {6, Kind::kRestart}, {6.5, Kind::kJog, 0, 500}, {16.5, Kind::kJog, 0, 0}, {18, Kind::kCenter, 0, 2000}};
  const Run r = run(circle(72), setup);
  CHECK(r.has("STOP: STP to every axis", false));
  CHECK(r.has("Restart: RST to every axis", false));
  CHECK_FALSE(r.has_errors());
  CHECK(r.x == 0);
  CHECK(r.y == 0);
  // At 5 s the circle is 5 of 25.13 s round; the jog then goes 10 s at 500 counts/s.
  CHECK(r.furthest_x == Approx(-4000 + 4000 * std::cos(2 * std::acos(-1.0) * 4.96 / 25.13) + 5000).margin(20));
}

TEST_CASE("network: a jog waits for the end of a move", "[silverlode]") {
  NetworkSetup setup;
  setup.actions = {{5, PanelAction::Kind::kJog, 0, 500}};
  const Run r = run(circle(72), setup);
  CHECK(r.has("press STOP first", true));
  CHECK(std::hypot(r.x, r.y) < 0.001);
}

TEST_CASE("network: a queue that fills before the start is refused", "[silverlode]") {
  NetworkSetup setup;
  setup.queue_depth = 1;
  CHECK(problem_of(setup, 2)->find("make it deeper") != std::string::npos);
}

TEST_CASE("device: commands with wrong numbers of parameters, ranges or at the wrong time are refused", "[silverlode]") {
  const CommandSet commands;
  Device device({"X", 16}, commands, [](bool, const std::string&) {});
  const auto code = [&](int command, std::vector<std::int64_t> parameters) {
    const ReplyFrame reply = device.handle({16, command, std::move(parameters)});
    const Nak* nak = std::get_if<Nak>(&reply);
    return nak == nullptr ? 0 : nak->code;
  };
  CHECK(code(99, {}) == 1);
  CHECK(code(253, {1, 2, 3}) == 5);
  CHECK(code(253, {-1, kFarPosition, 1, 1}) == 5);
  CHECK(code(253, {10, kFarPosition, 1'073'741'824, 1}) == 5);
  CHECK(code(253, {10, kFarPosition, 1, 2'147'483'648}) == 5);
  for (int k = 0; k < 10; ++k) CHECK(code(253, {10, kFarPosition, 1, 1}) == 0);
  CHECK(code(253, {10, kFarPosition, 1, 1}) == 6);
  CHECK(code(11, {21, 5}) == 5);      // reserved for the queue
  CHECK(code(11, {11, 1}) == 0);
  CHECK(code(252, {}) == 0);
  CHECK(code(134, {0, 1000, 1000, 0, 0}) == 2);
  CHECK(code(252, {}) == 2);
  CHECK(code(3, {0}) == 0);
  CHECK(code(254, {}) == 0);
  CHECK(device.queued() == 0);
}

TEST_CASE("device: the queue copies its entry into registers 20 to 23", "[silverlode]") {
  const CommandSet commands;
  Device device({"X", 16}, commands, [](bool, const std::string&) {});
  (void)device.handle({16, 253, {7, -kFarPosition, 100, 70000}});
  (void)device.handle({16, 252, {}});
  device.step(true);
  const auto value = [&](int number) {
    const Data data = std::get<Data>(device.handle({16, 12, {number}}));
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(data.words[0]) << 16 | data.words[1]);
  };
  CHECK(value(20) == 7);
  CHECK(value(21) == -kFarPosition);
  CHECK(value(22) == 100);
  CHECK(value(23) == 70000);
}
