// Cutter radius compensation in whole programs: motor positions against the programmed shape, error numbers, and its place among
// the other modes. Distances are plain geometry; the corners' closed forms are tested with the stage itself.
#include <numbers>

#include "tests/unit/programs/geometry.h"
#include "tests/unit/programs/lines.h"

using namespace pmac::test;

namespace {

const std::string kSegments = "Coord[1].SegMoveTime=1";
constexpr double kScale = 1000;

/// Least and greatest distance of the motor positions from a path between two times.
std::pair<double, double> distances(const ProgramBench& bench, const std::vector<Element>& path, double from_ms, double to_ms, double scale = 1) {
  double least = 1e9, greatest = 0;
  for (std::size_t k = 0; k < bench.time_ms.size(); ++k) {
    if (bench.time_ms[k] < from_ms || bench.time_ms[k] > to_ms) continue;
    const double d = distance_to(path, bench.motor_mu[k][1] / kScale / scale, bench.motor_mu[k][2] / kScale / scale);
    least = std::min(least, d);
    greatest = std::max(greatest, d);
  }
  return {least, greatest};
}

// The corners with lead-in and lead-out are blended over 50 ms on either side, so the distances are looked at in between.
const std::vector<Element> kSquare = {{0, 0, 0, 10}, {0, 10, 10, 10}, {10, 10, 10, 0}, {10, 0, 0, 0}};
const std::string kAroundTheSquare = "X0 Y0\nY10\nX10\nY0\nX0\nccmode0 X-5";

int error_status(ProgramBench& bench) { return static_cast<int>(value_of(bench, "Coord[1].ErrorStatus")); }

}  // namespace

TEST_CASE("compensation: the tool goes round a square at its radius, with an arc at each corner", "[programs][cc]") {
  const Lines bench("X0 Y-5\nccr2 ccmode1\n" + kAroundTheSquare, kSegments);
  REQUIRE(bench.faults.empty());
  REQUIRE(bench.moves.size() == 10);
  CHECK(bench.moves[3].mode == "added");
  CHECK(bench.moves[3].length == Approx(std::numbers::pi).margin(1e-9));
  CHECK(bench.moves[3].source.line == bench.moves[2].source.line);
  const auto [least, greatest] = distances(bench, kSquare, bench.moves[2].start_ms + 50, bench.moves[8].end_ms - 50);
  CHECK(least > 2 - 1e-6);
  CHECK(greatest < 2 + 1e-6);
  CHECK(last(bench, 1) == Approx(-5.0).margin(1e-9));
}

TEST_CASE("compensation: a mirrored program keeps its tool on the same side of the workpiece", "[programs][cc]") {
  const Lines bench("Tdata[1].Diag[6]=-1 tsel 1 X0 Y-5\nccr2 ccmode1\n" + kAroundTheSquare, kSegments);
  REQUIRE(bench.faults.empty());
  const std::vector<Element> mirrored = {{0, 0, 0, 10}, {0, 10, -10, 10}, {-10, 10, -10, 0}, {-10, 0, 0, 0}};
  const auto [least, greatest] = distances(bench, mirrored, bench.moves[2].start_ms + 50, bench.moves[8].end_ms - 50);
  CHECK(least > 2 - 1e-6);
  CHECK(greatest < 2 + 1e-6);
  CHECK(last(bench, 1) == Approx(5.0).margin(1e-9));
}

TEST_CASE("compensation: ccr is in program units", "[programs][cc]") {
  const Lines bench("Tdata[1].Diag[6]=25.4 Tdata[1].Diag[7]=25.4 tsel 1 X0 Y-5\nccr2 ccmode1\n" + kAroundTheSquare, kSegments);
  REQUIRE(bench.faults.empty());
  const auto [least, greatest] = distances(bench, kSquare, bench.moves[2].start_ms + 50, bench.moves[8].end_ms - 50, 25.4);
  CHECK(least > 2 - 1e-6);
  CHECK(greatest < 2 + 1e-6);
  CHECK(bench.moves[3].end_ms - bench.moves[3].start_ms == Approx(std::numbers::pi / 10 * 1000).margin(1e-6));  // F10, too
}

TEST_CASE("compensation: plunging and lifting between moves in the plane", "[programs][cc]") {
  Lines bench("Coord[1].AltFeedRate=100 X0 Y-5\nccr2 ccmode1 X0 Y0\nZ-3\nY10\nX10\nZ1\nccmode0 X20\ndwell 0\nP1=Coord[1].CdPos[8]", kSegments);
  REQUIRE(bench.faults.empty());
  CHECK(last(bench, 3) == Approx(1.0).margin(1e-9));
  CHECK(last(bench, 2) == Approx(10.0).margin(1e-9));
  CHECK(value_of(bench, "P1") == 1.0);
}

TEST_CASE("compensation: program variables read programmed positions while it is on", "[programs][cc]") {
  Lines bench("X0 Y-5\nccr2 ccmode1 X0 Y0\nY10\nP1=Coord[1].CdPos[6] P2=Coord[1].CCMode\nX10\nccmode0 X20\nP3=Coord[1].CCMode", kSegments);
  REQUIRE(bench.faults.empty());
  CHECK(value_of(bench, "P1") == 0.0);
  CHECK(value_of(bench, "P2") == 1.0);
  CHECK(value_of(bench, "P3") == 0.0);
}

TEST_CASE("compensation: synchronous assignments happen at the moves they belong to", "[programs][cc]") {
  Lines bench("P1=0 X0 Y-5\nccr2 ccmode1 X0 Y0\nY10\nP1==Sys.Time+1\nX10\nccmode0 X20\ndwell 0\nP2=Sys.Time", kSegments);
  REQUIRE(bench.faults.empty());
  CHECK(value_of(bench, "P1") > 0);
}

TEST_CASE("compensation: a dwell or the end of the program ends the move at right angles", "[programs][cc]") {
  Lines dwell("X0 Y-5\nccr2 ccmode1 X0 Y0\nY10\ndwell 10\nX10\nccmode0 X20", kSegments);
  REQUIRE(dwell.faults.empty());
  REQUIRE(dwell.moves.size() == 7);
  CHECK(dwell.moves[3].mode == "dwell");
  CHECK(dwell.moves[4].mode == "added");
  Lines end("X0 Y-5\nccr2 ccmode1 X0 Y0\nY10", kSegments);
  REQUIRE(end.faults.empty());
  CHECK(last(end, 1) == Approx(-2.0).margin(1e-9));
  CHECK(last(end, 2) == Approx(10.0).margin(1e-9));
  CHECK(value_of(end, "Coord[1].CCMode") == 0.0);  // over with the program
}

TEST_CASE("compensation: without segmentation nothing is compensated", "[programs][cc]") {
  const Lines bench("X0 Y-5\nccr2 ccmode1 X0 Y0\nY10\nccmode0 Y20");
  REQUIRE(bench.faults.empty());
  CHECK(bench.moves.size() == 4);
  CHECK(last(bench, 1) == 0.0);
}

TEST_CASE("compensation: each error has its number and line", "[programs][cc]") {
  const auto status_of = [](const std::string& lines) {
    Lines bench("X0 Y-5\nccr2 ccmode1\n" + lines, kSegments);
    REQUIRE(bench.faults.size() == 1);
    CHECK(bench.faults[0].fault.source.line > 0);
    return error_status(bench);
  };
  CHECK(status_of("X0 Y0\nY10\nrapid X10") == 3);
  CHECK(status_of("X0 Y0\nY10\npmatch") == 3);
  CHECK(status_of("X0 Y0\nY10\npset X0") == 3);
  CHECK(status_of("X0 Y0\nY10\ntsel 1") == 3);
  CHECK(status_of("X0 Y0\nY10\nnormal j-1 X1") == 3);
  CHECK(status_of("X0 Y0\nY10\nccmode0 Y11") == 5);
  CHECK(status_of("Y-4") == 6);
  CHECK(status_of("Coord[1].CCSize=1 Y0\nY10\nZ1\nZ2") == 7);
  CHECK(status_of("Y0\nY10\ntm100 Y20") == 9);
  CHECK(status_of("Coord[1].CCDistance=0 Y0\nY20\nX-3\nY0") == 10);
  CHECK(status_of("Y0\nY10\ncircle2 X-3 I-1.5") == 11);
  CHECK(status_of("Y0\nY20\nX-3\nY0") == 13);
  CHECK(status_of("ccr4 Y0\nY20\ncircle2 X0 Y10 J-5") == 14);
  CHECK(status_of("Y0\nccmode0 Y10") == 15);
}
