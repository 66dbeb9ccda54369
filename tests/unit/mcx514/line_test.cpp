// Lines: MCX514 manual p111, the long axis pulses at every event and the others stay within half a pulse.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <random>

#include "runtime/drives/mcx514/line.h"

using namespace pmac::drives::mcx514;

namespace {

struct Walk { std::int64_t events = 0, doubles = 0; AxisCounts at{}; double worst = 0; };

/// The distance of every axis from its share of the longest one.
Walk walk(const AxisCounts& finish) {
  Line line(finish);
  std::int64_t longest = 0;
  for (const std::int64_t f : finish) longest = std::max(longest, std::abs(f));
  Walk w;
  while (!line.done()) {
    const Event event = line.next();
    ++w.events;
    int moved = 0;
    for (std::size_t axis = 0; axis < 4; ++axis) {
      w.at[axis] += event.step[axis];
      moved += event.step[axis] != 0;
      const double ideal = static_cast<double>(finish[axis]) * static_cast<double>(w.events) / static_cast<double>(longest);
      w.worst = std::max(w.worst, std::abs(static_cast<double>(w.at[axis]) - ideal));
    }
    w.doubles += moved == 2;
  }
  return w;
}

}  // namespace

TEST_CASE("a line has an event for each pulse of its long axis", "[mcx514]") {
  const Walk w = walk({1000, 400, 0, 0});
  CHECK(w.events == 1000);
  CHECK(w.doubles == 400);
  CHECK(w.at == AxisCounts{1000, 400, 0, 0});
  CHECK(walk({-7, 3, 0, 0}).worst == Approx(3.0 / 7.0));   // at the fifth event: 2 pulses instead of 15/7, 3/7 at the first and last but one
  CHECK(walk({5, -5, 0, 0}).doubles == 5);
  CHECK(walk({5, -5, 0, 0}).worst == 0);
}

TEST_CASE("random lines of two to four axes end at their finish points within half a pulse of the line", "[mcx514]") {
  std::mt19937_64 random(61);
  std::uniform_int_distribution<std::int64_t> length(-3000, 3000);
  double worst = 0;
  for (int i = 0; i < 3000; ++i) {
    AxisCounts finish{length(random), length(random), i % 3 > 0 ? length(random) : 0, i % 3 > 1 ? length(random) : 0};
    const Walk w = walk(finish);
    REQUIRE(w.at == finish);
    worst = std::max(worst, w.worst);
  }
  INFO(worst);
  CHECK(worst <= 0.5 + 1e-9);
}

TEST_CASE("passing over events of a line gives the same as making them", "[mcx514]") {
  std::mt19937_64 random(62);
  std::uniform_int_distribution<std::int64_t> length(-100'000, 100'000), part(1, 30'000);
  for (int i = 0; i < 50; ++i) {
    const AxisCounts finish{length(random), length(random), 0, 0};
    Line line(finish);
    AxisCounts at{};
    std::uint64_t events = 0, doubles = 0;
    while (!line.done()) {
      const Skip skip = line.skip(static_cast<std::uint64_t>(part(random)));
      const Event event = line.next();
      events += skip.events + 1;
      doubles += skip.doubles + (event.step[0] != 0 && event.step[1] != 0);
      for (std::size_t axis = 0; axis < 4; ++axis) at[axis] += skip.steps[axis] + event.step[axis];
    }
    const Walk w = walk(finish);
    REQUIRE(at == finish);
    REQUIRE(events == static_cast<std::uint64_t>(w.events));
    REQUIRE(doubles == static_cast<std::uint64_t>(w.doubles));
  }
}

TEST_CASE("a maximum finish point spreads every axis over so many events", "[mcx514]") {
  Line line({100, -50, 0, 0}, 400);
  AxisCounts at{};
  int events = 0;
  for (; !line.done(); ++events) {
    const Event event = line.next();
    for (std::size_t axis = 0; axis < 4; ++axis) at[axis] += event.step[axis];
  }
  CHECK(events == 400);
  CHECK(at == AxisCounts{100, -50, 0, 0});
}

TEST_CASE("a bit pattern makes the pulses of its bits and ends where both are set", "[mcx514]") {
  BitPattern pattern({BitPattern::Bits{0b10011, 0b10100}, BitPattern::Bits{0, 0b00010}, {}, {}});
  AxisCounts at{};
  int events = 0;
  for (; !pattern.done(); ++events) {
    const Event event = pattern.next();
    for (std::size_t axis = 0; axis < 4; ++axis) at[axis] += event.step[axis];
  }
  CHECK(events == 4);
  CHECK(at == AxisCounts{1, -1, 0, 0});
  CHECK(pattern.stop() == Stop::kEndOfPattern);
}
