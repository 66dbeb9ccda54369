// In-position waits (Coord[].InPosTimeOut) in whole programs. A motor with a plant lags and settles; the times of commanded motion are closed
// forms: 10 mm at 10 mm/s with ta 100 take 1100 ms from rest to rest.
#include <algorithm>
#include <cmath>

#include "tests/unit/programs/lines.h"

using namespace pmac::test;

namespace {

const std::string kPlant = "Sim.Motor[1].Plant=1 Motor[1].FatalFeLimit=0 ";

double start_of(const ProgramBench& bench, std::size_t move) { return bench.moves.at(move).start_ms; }
double end_of(const ProgramBench& bench, std::size_t move) { return bench.moves.at(move).end_ms; }

}  // namespace

TEST_CASE("InPosTimeOut 0: a stop is commanded rest, nothing waits", "[programs][in_position]") {
  const Lines bench("X10\nX20", "Coord[1].NoBlend=1 " + kPlant);
  REQUIRE(bench.moves.size() == 2);
  CHECK(end_of(bench, 0) == Approx(1100).margin(1e-6));
  CHECK(start_of(bench, 1) == Approx(1100).margin(1e-6));
}

TEST_CASE("InPosTimeOut: ideal motors are in position some interrupts after their rest", "[programs][in_position]") {
  for (const char* rule : {"Coord[1].NoBlend=1 ", "Coord[1].CornerBlendBp=0.5 ", "Coord[1].CornerDwellBp=0.5 "}) {
    INFO(rule);
    const Lines bench("X10\nY10", std::string(rule) + "Coord[1].InPosTimeOut=1000");
    REQUIRE(bench.moves.size() == 2);
    CHECK(bench.faults.empty());
    CHECK(end_of(bench, 0) == Approx(1100).margin(1e-6));
    CHECK(start_of(bench, 1) > 1100);
    CHECK(start_of(bench, 1) < 1100 + 5);
    CHECK(end_of(bench, 1) - start_of(bench, 1) == Approx(1100).margin(1e-6));
    CHECK(last(bench, 1) == Approx(10));
    CHECK(last(bench, 2) == Approx(10));
  }
}

TEST_CASE("InPosTimeOut: the next move begins when a motor that settles is within its band", "[programs][in_position]") {
  const Lines tight("X10\nX20", "Coord[1].NoBlend=1 Coord[1].InPosTimeOut=5000 Motor[1].InPosBand=0.1 Motor[1].InPosTime=9 " + kPlant);
  const Lines wide("X10\nX20", "Coord[1].NoBlend=1 Coord[1].InPosTimeOut=5000 Motor[1].InPosBand=100000 Motor[1].InPosTime=9 " + kPlant);
  CHECK(tight.faults.empty());
  CHECK(start_of(wide, 1) == Approx(1100 + 10 * wide.machine->servo_period_ms()).margin(3));
  CHECK(start_of(tight, 1) > start_of(wide, 1));
  CHECK(last(tight, 1) == Approx(20));
}

TEST_CASE("InPosTimeOut: a motor that does not come into position ends the program with ErrorStatus 17", "[programs][in_position]") {
  Lines bench("X10\nX20", "Coord[1].NoBlend=1 Coord[1].InPosTimeOut=200 Motor[1].InPosTime=1000000 " + kPlant);
  REQUIRE(bench.faults.size() == 1);
  CHECK(bench.faults[0].fault.kind == pmac::runtime::FaultKind::kInPosition);
  CHECK(bench.faults[0].time_ms == Approx(1300).margin(3));
  CHECK(bench.faults[0].fault.detail.find("motor 1 is not in position within Coord[1].InPosTimeOut = 200 ms") != std::string::npos);
  CHECK(value_of(bench, "Coord[1].ErrorStatus") == 17);
  CHECK(last(bench, 1) == Approx(10));
}

TEST_CASE("InPosTimeOut acts after rapid moves, and AddedDwellTime begins behind it", "[programs][in_position]") {
  const Lines rapid("rapid X10\nlinear X20", "Coord[1].InPosTimeOut=5000 Motor[1].InPosBand=100000 Motor[1].InPosTime=99 Motor[1].JogSpeed=100 Motor[1].JogTa=-1 Motor[1].JogTs=0");
  const double period_ms = rapid.machine->servo_period_ms();
  CHECK(start_of(rapid, 1) - end_of(rapid, 0) == Approx(100 * period_ms).margin(3));
  const Lines corner("X10\nY10", "Coord[1].CornerDwellBp=0.5 Coord[1].AddedDwellTime=300 Coord[1].InPosTimeOut=5000");
  CHECK(start_of(corner, 1) == Approx(1100 + 300).margin(4));
  const Lines gentle("X10\nX20", "Coord[1].CornerDwellBp=0.5 Coord[1].AddedDwellTime=300 Coord[1].InPosTimeOut=5000");
  CHECK(start_of(gentle, 1) == Approx(1050).margin(1e-6));   // mid-blend: no corner, no stop
}

TEST_CASE("InPosTimeOut: pause while the motors settle, and go on with the move that waits", "[programs][in_position]") {
  ProgramBench bench("lines.pmc", with_motors("X10\nX20", "Coord[1].NoBlend=1 Coord[1].InPosTimeOut=5000 Motor[1].InPosTime=999"));
  bench.machine->at(1300, "&1 q");
  bench.machine->at(3000, "&1 r");
  bench.run("&1 b1r");
  CHECK(bench.refusals.empty());
  REQUIRE(bench.moves.size() == 2);
  CHECK(start_of(bench, 1) == Approx(3000).margin(1));
  CHECK(last(bench, 1) == Approx(20));
}

TEST_CASE("InPosTimeOut under segmentation and lookahead", "[programs][in_position]") {
  const Lines bench("X10\nY10\nX0", "&1 define lookahead 2000\nCoord[1].SegMoveTime=5 Coord[1].LHDistance=50 Coord[1].CornerBlendBp=0.5 Coord[1].InPosTimeOut=1000");
  CHECK(bench.faults.empty());
  REQUIRE(bench.moves.size() == 3);
  CHECK(start_of(bench, 1) > end_of(bench, 0));
  CHECK(start_of(bench, 2) > end_of(bench, 1));
  CHECK(last(bench, 1) == Approx(0).margin(1e-9));
  CHECK(last(bench, 2) == Approx(10));
}
