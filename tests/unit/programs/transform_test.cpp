// Transformations (tsel), position offsets (pset) and the feed rates that go with them. Expected values are closed forms: rotation and
// scaling of points, move times length / F, the ramp rule.
#include <numbers>

#include "tests/unit/programs/lines.h"

using namespace pmac::test;

TEST_CASE("transform: a rotated program moves the base axes by the rotated vector, at the same speed", "[programs][transform]") {
  const Lines bench(
      "Tdata[1].Diag[6]=cosd(30) Tdata[1].Diag[7]=cosd(30) Tdata[1].XYZ[0]=-sind(30) Tdata[1].XYZ[2]=sind(30)\n"
      "tsel 1 X10 Y4\ninc Y-2");
  REQUIRE(bench.faults.empty());
  const double c = std::sqrt(3.0) / 2, s = 0.5;
  CHECK(last(bench, 1) == Approx(10 * c - 2 * s).margin(1e-9));
  CHECK(last(bench, 2) == Approx(10 * s + 2 * c).margin(1e-9));
  CHECK(bench.moves[0].length == Approx(std::hypot(10.0, 4.0)).margin(1e-12));
  CHECK(bench.moves[1].end_ms == Approx((std::hypot(10.0, 4.0) + 2) / 10 * 1000 + 100).margin(1e-9));
}

TEST_CASE("transform: displacement alone blends across tsel", "[programs][transform]") {
  const Lines bench("X10\nTdata[2].Bias[6]=5 tsel 2\nX10 tsel-1 X20");
  REQUIRE(bench.faults.empty());
  CHECK(last(bench, 1) == Approx(20.0).margin(1e-9));
  CHECK(bench.moves[1].length == Approx(5.0).margin(1e-12));
  CHECK(bench.moves[2].end_ms == Approx(2000 + 100).margin(1e-9));  // no stop between: 20 at F10 and one ramp time
}

TEST_CASE("transform: F counts in program units, so inches take as long as their numbers say", "[programs][transform]") {
  const Lines bench(
      "Tdata[1].Diag[6]=25.4 Tdata[1].Diag[7]=25.4 Tdata[1].Diag[8]=25.4 tsel 1\nX3 Y4\ndwell 0\ncircle1 X3 Y8 I0 J2",
      "Coord[1].SegMoveTime=1");
  REQUIRE(bench.faults.empty());
  CHECK(last(bench, 1) == Approx(3 * 25.4).margin(1e-6));
  CHECK(bench.moves[0].end_ms == Approx(500 + 100).margin(1e-9));
  CHECK(bench.moves[2].end_ms - bench.moves[2].start_ms == Approx(2 * std::numbers::pi / 10 * 1000 + 100).margin(1e-6));
}

TEST_CASE("transform: AltFeedRate counts in program units", "[programs][transform]") {
  const Lines bench("Coord[1].AltFeedRate=30 Tdata[1].Diag[2]=2 tsel 1\nX1 C90");
  CHECK(last(bench, 4) == Approx(180.0).margin(1e-6));
  CHECK(bench.moves[0].end_ms == Approx(3000 + 100).margin(1e-9));
}

TEST_CASE("transform: a mirrored arc turns the other way about the mirrored centre", "[programs][transform]") {
  const Lines bench("Tdata[1].Diag[6]=-1 tsel 1\nX10\ndwell 0\ncircle2 X20 Y10 J10", "Coord[1].SegMoveTime=1");
  REQUIRE(bench.faults.empty());
  CHECK(bench.moves[2].length == Approx(5 * std::numbers::pi).margin(1e-9));
  for (std::size_t k = 0; k < bench.time_ms.size(); ++k)
    if (bench.time_ms[k] > bench.moves[2].start_ms)
      CHECK(std::hypot(bench.motor_mu[k][1] / 1000 + 10, bench.motor_mu[k][2] / 1000 - 10) == Approx(10.0).margin(1e-6));
  CHECK(last(bench, 1) == Approx(-20.0).margin(1e-9));
}

TEST_CASE("transform: circles that would become ellipses or leave their plane are a fault", "[programs][transform]") {
  const char* circle = "tsel 1 circle1 X10 Y10 I10";
  const std::string set_up = "Coord[1].SegMoveTime=1";
  for (const std::string matrix : {"Tdata[1].Diag[6]=2\n", "Tdata[1].XYZ[0]=0.1\n",
                                   "Tdata[1].Diag[7]=cosd(10) Tdata[1].Diag[8]=cosd(10) Tdata[1].XYZ[3]=-sind(10) Tdata[1].XYZ[5]=sind(10)\n"}) {
    const Lines bench(matrix + circle, set_up);
    REQUIRE(bench.faults.size() == 1);
    CHECK(bench.faults[0].fault.detail.find("makes no circle") != std::string::npos);
  }
  CHECK(Lines(std::string("Tdata[1].Diag[8]=3\n") + circle, set_up).faults.empty());  // only the normal is scaled
}

TEST_CASE("transform: a selected matrix that is changed acts on the next move, from the old program position", "[programs][transform]") {
  const Lines unmatched("tsel 1 X10 Y10\nTdata[1].Bias[7]=3\nX20");
  CHECK(last(unmatched, 2) == Approx(13.0).margin(1e-9));  // Y is still 10 in the program
  const Lines matched("tsel 1 X10 Y10\nTdata[1].Bias[7]=3\npmatch\nX20");
  CHECK(last(matched, 2) == Approx(10.0).margin(1e-9));
  CHECK(matched.moves[1].start_ms == Approx(matched.moves[0].end_ms));  // pmatch lets the motion end
  CHECK(matched.moves[0].end_ms == Approx(std::hypot(10.0, 10.0) / 10 * 1000 + 100).margin(1e-9));
}

TEST_CASE("transform: positions are asked for in program coordinates", "[programs][transform]") {
  Lines bench("Tdata[1].Diag[6]=2 Tdata[1].Bias[6]=1 tsel 1\nX10\ndwell 0\nP1=Coord[1].CdPos[6] P2=Coord[1].DesPos[6]\ntsel -1 P3=Coord[1].CdPos[6]");
  CHECK(value_of(bench, "P1") == 10.0);
  CHECK(value_of(bench, "P2") == Approx(10.0).margin(1e-9));
  CHECK(value_of(bench, "P3") == 21.0);
}

TEST_CASE("transform: matrices that cannot be used are named", "[programs][transform]") {
  CHECK(Lines("tsel 256 X1").faults.at(0).fault.detail.find("0 to 255") != std::string::npos);
  CHECK(Lines("Tdata[0].Diag[7]=0 tsel 0 X1").faults.at(0).fault.detail.find("singular") != std::string::npos);
}

TEST_CASE("pset: the present point gets a new name and the next move starts from there", "[programs][transform]") {
  Lines bench("X10 Y5\npset X0 Y1\nX2 Y1\ndwell 0\nP1=Coord[1].CdPos[6]\npstore pclr\nP2=Coord[1].CdPos[6]\nX0\npload\nP3=Coord[1].CdPos[6]");
  REQUIRE(bench.faults.empty());
  CHECK(bench.moves[1].start_ms == Approx(bench.moves[0].end_ms));  // no blending
  CHECK(value_of(bench, "P1") == 2.0);
  CHECK(value_of(bench, "P2") == 12.0);   // machine position
  CHECK(last(bench, 1) == Approx(0.0).margin(1e-9));
  CHECK(last(bench, 2) == Approx(5.0).margin(1e-9));
  CHECK(value_of(bench, "P3") == -10.0);  // machine 0 under the stored offset of 10
}

TEST_CASE("pset: acts in the selected matrix", "[programs][transform]") {
  const Lines bench("Tdata[1].Diag[6]=0 Tdata[1].Diag[7]=0 Tdata[1].XYZ[0]=-1 Tdata[1].XYZ[2]=1 tsel 1\nX10\npset X0\nX3");
  CHECK(last(bench, 1) == Approx(0.0).margin(1e-9));  // program X is base Y
  CHECK(last(bench, 2) == Approx(13.0).margin(1e-9));
}

TEST_CASE("frax2: the longer time of the two sets counts", "[programs][feed]") {
  const Lines bench("Coord[1].AltFeedRate=1000 frax(X,Y) frax2(Z)\nX3 Y4 Z20\ndwell 0\nX6 Y8 Z21");
  CHECK(bench.moves[0].end_ms == Approx(2000 + 100).margin(1e-9));
  CHECK(bench.moves[2].end_ms - bench.moves[2].start_ms == Approx(500 + 100).margin(1e-9));
}

TEST_CASE("AltFeedRate: the slowest axis beside the feed-rate axes may decide", "[programs][feed]") {
  CHECK(Lines("C90").moves[0].end_ms == Approx(90000 + 100).margin(1e-9));  // the factory value is 1 unit a second
  CHECK(Lines("Coord[1].AltFeedRate=0 C90").moves[0].end_ms == Approx(9000 + 100).margin(1e-9));  // F then
  CHECK(Lines("Coord[1].AltFeedRate=0 X1 C90").moves[0].end_ms == Approx(100 + 100).margin(1e-9));
}

TEST_CASE("InvTimeMode: F is moves per FeedTime; MaxFeedRate clips F", "[programs][feed]") {
  CHECK(Lines("Coord[1].InvTimeMode=1 F2 X30").moves[0].end_ms == Approx(500 + 100).margin(1e-9));
  CHECK(Lines("Coord[1].MaxFeedRate=5 X10").moves[0].end_ms == Approx(2000 + 100).margin(1e-9));
}

TEST_CASE("CornerDwellBp: a sharp corner stops and waits AddedDwellTime", "[programs][feed]") {
  const std::string dwell = "Coord[1].AddedDwellTime=40 Coord[1].CornerDwellBp=0.5\n";
  for (const char* segments : {"Coord[1].SegMoveTime=0", "Coord[1].SegMoveTime=2"}) {
    const Lines sharp(dwell + "X10\nY10", segments);
    CHECK(sharp.moves[1].start_ms == Approx(1100 + 40).margin(1e-6));
    CHECK(sharp.moves[1].end_ms == Approx(2200 + 40).margin(1e-6));
    CHECK(Lines(dwell + "X10\nX20 Y10", segments).moves[1].end_ms == Approx(1000 + std::sqrt(200.0) * 100 + 100).margin(1e-6));  // cos 45 degrees
  }
}

TEST_CASE("NoBlend and OnceNoBlend: moves end in a stop", "[programs][feed]") {
  CHECK(Lines("Coord[1].NoBlend=1\nX10\nX20\nX30").moves[2].end_ms == Approx(3300.0).margin(1e-9));
  CHECK(Lines("Coord[1].OnceNoBlend=1\nX10\nX20\nX30").moves[2].end_ms == Approx(3200.0).margin(1e-9));
}

TEST_CASE("PosRollOver: an absolute move goes the short way round", "[programs][feed]") {
  const std::string turn = "Coord[1].AltFeedRate=1000 Coord[1].PosRollOver[2]=360\n";
  CHECK(last(Lines(turn + "C350\nC10"), 4) == Approx(10.0).margin(1e-6));     // 350 is 10 back
  CHECK(last(Lines(turn + "C100\nC190\nC-90"), 4) == Approx(270.0).margin(1e-6));
  CHECK(last(Lines(turn + "inc C350\nC20"), 4) == Approx(370.0).margin(1e-6));  // distances are distances
  const std::string sign = "Coord[1].AltFeedRate=1000 Coord[1].PosRollOver[2]=-360\n";
  CHECK(last(Lines(sign + "C350\nC10"), 4) == Approx(370.0).margin(1e-6));
  CHECK(last(Lines(sign + "C100\nC-350"), 4) == Approx(10.0).margin(1e-6));
}
