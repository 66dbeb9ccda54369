// What a card refuses and what it warns of: each id with the smallest move that shows it.
#include <catch2/catch.hpp>

#include "tests/unit/acr1000/scripted_driver.h"

using namespace pmac::acr1000;

namespace {

/// Ids that a single card reports for these steps.
std::string ids_of(std::vector<ScriptedDriver::Step> steps) {
  Scene scene;
  scene.add("X", std::move(steps));
  scene.run();
  return scene.ids();
}

std::string ids_of_pair(ScriptedDriver::Step x, ScriptedDriver::Step y) {
  Scene scene;
  scene.add("X", {rates({1000, 0, 0, 0}), std::move(x)});
  scene.add("Y", {rates({1000, 0, 0, 0}), std::move(y)});
  scene.run();
  return scene.ids();
}

const ScriptedDriver::Step kSlow = rates({1000, 0, 0, 0});

}  // namespace

TEST_CASE("ACR-E11: a move with VEL 0", "[acr1000]") {
  CHECK(ids_of({mov(0, 100)}) == "ACR-E11");
  CHECK(ids_of({mov(100, 0)}) == "ACR-E11");
  CHECK(ids_of({mov(0, 0)}) == "");        // no way to go
}

TEST_CASE("ACR-E10: CIRCLE with an impossible rot, radius or distance", "[acr1000]") {
  CHECK(ids_of({kSlow, circle(0, 0, {2, 100, 100, 0, 628})}) == "ACR-E10");
  CHECK(ids_of({kSlow, circle(0, 0, {1, 0, 100, 0, 628})}) == "ACR-E10");
  CHECK(ids_of({kSlow, circle(0, 0, {1, 100, 100, 0, -628})}) == "ACR-E10");
}

TEST_CASE("ACR-E04: P28 below 0, and a target beyond 32 bits", "[acr1000]") {
  CHECK(ids_of({kSlow, mov(-5, 100)}) == "ACR-E04");
  CHECK(ids_of({kSlow, [](ScriptedDriver& d) {
                  MoveRequest request;
                  request.kind = MoveKind::kMoveBy;
                  request.distance = 3'000'000'000;
                  return d.move(request);
                }}) == "ACR-E04");
}

TEST_CASE("ACR-W02: P29 more than 2 pulses from the end of the arc", "[acr1000]") {
  CHECK(ids_of({kSlow, circle(0, 2, {1, 10000, 10000, 0, 62832})}) == "");
  CHECK(ids_of({kSlow, circle(0, 3, {1, 10000, 10000, 0, 62832})}) == "ACR-W02");
}

TEST_CASE("ACR-W03: I and J more than 1.5 pulses from the radius", "[acr1000]") {
  CHECK(ids_of({kSlow, circle(0, 0, {1, 10000, 10001, 0, 62832})}) == "");
  CHECK(ids_of({kSlow, circle(0, 0, {1, 10000, 10002, 0, 62832})}) == "ACR-W03");
}

TEST_CASE("ACR-W05: an axis that goes further than P28", "[acr1000]") {
  CHECK(ids_of({kSlow, mov(1000, 1000)}) == "");
  CHECK(ids_of({kSlow, mov(1000, 1001)}) == "ACR-W05");
}

TEST_CASE("ACR-W06: STP that cannot stop in time", "[acr1000]") {
  const auto steps = [](std::int64_t length) {
    return std::vector<ScriptedDriver::Step>{rates({1000, 0, 0, 0}), mov(0, 10000), rates({1000, 0, 0, 1000}), mov(0, 10000 + length)};
  };
  CHECK(ids_of(steps(500)) == "");        // v^2 / 2 a = 500
  CHECK(ids_of(steps(499)) == "ACR-W06");
}

TEST_CASE("ACR-W07: turning back without a stop ramp", "[acr1000]") {
  CHECK(ids_of({kSlow, mov(0, 1000), mov(0, 0)}) == "ACR-W07");
  CHECK(ids_of({rates({1000, 0, 0, 5000}), mov(0, 1000), mov(0, 0)}) == "");
  CHECK(ids_of({kSlow, mov(0, 1000), mov(0, 2000)}) == "");
}

TEST_CASE("ACR-W09: two CIRCLEs that turn alike and draw no circle", "[acr1000]") {
  const auto arc = [](std::int64_t i, std::int64_t j) { return circle(62832, 0, {1, 10000, i, j, 62832}); };
  CHECK(ids_of_pair(arc(10000, 0), arc(0, -10000)) == "");
  CHECK(ids_of_pair(arc(10000, 0), arc(0, 10000)) == "");     // Y of the first is X of the second
  CHECK(ids_of_pair(arc(10000, 0), arc(10000, 0)) == "ACR-W09");
  // An ellipse has different radii and is none of this.
  CHECK(ids_of_pair(circle(125664, 0, {1, 20000, 20000, 0, 125664}), circle(125664, 0, {1, 10000, 0, -10000, 62832})) == "");
}
