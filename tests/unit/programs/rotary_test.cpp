// Lines that execute while they come in: rotary buffers and cx.
#include "tests/unit/programs/bench.h"

using pmac::test::ProgramBench;

namespace {

const std::string kSetUp = "&1 #1->1000X\n";

}  // namespace

TEST_CASE("a rotary buffer executes what has been appended, as program 0", "[programs][rotary]") {
  ProgramBench bench("a.pmc", kSetUp + "&1\nopen rotary\nrapid abs X5\nP1++\nclose\nopen rotary\nX7\nclose\n");
  bench.run("&1 b0 r");
  REQUIRE(bench.refusals.empty());
  REQUIRE(bench.faults.empty());
  CHECK(bench.motor(1).final_mu == 7000);
  CHECK(bench.moves.size() == 2);
}

TEST_CASE("moves blend from one piece of a rotary buffer to the next", "[programs][rotary]") {
  ProgramBench pieces("a.pmc", kSetUp + "&1\nopen rotary\nlinear inc F10 ta100 ts0 X5\nclose\nopen rotary\nX5\nclose\nopen rotary\nX5\nclose\n");
  const auto of_pieces = pieces.run("&1 b0 r");
  ProgramBench whole("a.pmc", kSetUp + "open prog 1\nlinear inc F10 ta100 ts0 X5\nX5\nX5\nclose\n");
  const auto of_whole = whole.run("&1 b1 r");
  CHECK(pieces.motor(1).final_mu == 15000);
  CHECK(of_pieces.time_ms == Approx(of_whole.time_ms).margin(1e-9));
}

TEST_CASE("a rotary buffer whose lines have run out goes on with those that come later", "[programs][rotary]") {
  ProgramBench bench("a.pmc", kSetUp);
  bench.machine->at(100, "&1 open rotary inc X5 close");
  bench.machine->at(3000, "&1 open rotary X2 close");
  bench.run("&1 b0 r");
  REQUIRE(bench.refusals.empty());
  CHECK(bench.motor(1).final_mu == 7000);
  REQUIRE(bench.moves.size() == 2);
  CHECK(bench.moves[0].start_ms == 100);
  CHECK(bench.moves[1].start_ms == 3000);
}

TEST_CASE("modes, D variables and canned cycles last from one piece of a rotary buffer to the next", "[programs][rotary]") {
  const std::string cycle = "open subprog 5\nread(X) P1+=D24 return\nclose\n";
  ProgramBench bench("a.pmc", kSetUp + cycle + "&1\nopen rotary\nrapid D60=3 cdef 5\nclose\nopen rotary\nX4\nclose\nopen rotary\ncundef X(P1+D60)\nclose\n");
  bench.run("&1 b0 r");
  REQUIRE(bench.faults.empty());
  CHECK(bench.motor(1).final_mu == 7000);
}

TEST_CASE("stop and abort end a rotary program, later lines wait for the next start", "[programs][rotary]") {
  ProgramBench bench("a.pmc", kSetUp + "&1\nopen rotary\nrapid X5 stop\nclose\nopen rotary\nX9\nclose\n");
  bench.run("&1 b0 r");
  CHECK(bench.motor(1).final_mu == 5000);
}

TEST_CASE("each coordinate system has a rotary buffer of its own", "[programs][rotary]") {
  ProgramBench bench("a.pmc", "&1 #1->1000X\n&2 #2->1000X\n&1 open rotary rapid X1 close\n&2 open rotary rapid X2 close\n");
  bench.run("&1 b0 r &2 b0 r");
  CHECK(bench.motor(1).final_mu == 1000);
  CHECK(bench.motor(2).final_mu == 2000);
}

TEST_CASE("cx executes buffered statements at once, one line at a time", "[programs][cx]") {
  ProgramBench bench("a.pmc", kSetUp + "open prog 1\nrapid X20 dwell 50\nclose\n");
  bench.machine->at(3000, "&1 cx X3 P1=P1+5 dwell 10");
  bench.machine->at(6000, "&1 b1 r");
  bench.machine->at(6010, "&1 cx X7");   // refused: the program runs
  bench.run("&1 cx linear abs X10 F5 ta100");
  REQUIRE(bench.faults.empty());
  REQUIRE(bench.refusals.size() == 1);
  CHECK(bench.refusals[0].find("error #38") != std::string::npos);
  REQUIRE(bench.moves.size() >= 3);
  CHECK(bench.motor(1).final_mu == 20000);
  CHECK(bench.moves[1].start_ms == 3000);
}

TEST_CASE("cx executes in the addressed coordinate system, code letters too", "[programs][cx]") {
  ProgramBench bench("a.pmc", "&1 #1->1000X\n&2 #2->1000X\nopen subprog 1000\nN0: rapid return\nclose\n");
  bench.run("&2 cx G0 X4");
  REQUIRE(bench.faults.empty());
  CHECK(bench.motor(1).final_mu == 0);
  CHECK(bench.motor(2).final_mu == 4000);
}

TEST_CASE("axes taken out of the feed-rate axes by nofrax do not count for F", "[programs]") {
  // X 3, Y 4 at F 1: 5 s with both as feed-rate axes, 3 s with X alone
  ProgramBench both("a.pmc", "&1 #1->X #2->Y\nopen prog 1\nlinear inc F1 ta1 ts0 X3 Y4\nclose\n");
  both.run("&1 b1 r");
  ProgramBench x("a.pmc", "&1 #1->X #2->Y\nopen prog 1\nnofrax(Y,Z) linear inc F1 ta1 ts0 X3 Y4\nclose\n");
  x.run("&1 b1 r");
  CHECK(both.moves[0].end_ms - both.moves[0].start_ms == Approx(5000).margin(2));
  CHECK(x.moves[0].end_ms - x.moves[0].start_ms == Approx(3000).margin(2));
}

TEST_CASE("normal with II JJ KK is the plane of the axes XX YY ZZ alone", "[programs]") {
  // circle3 is clockwise seen from +ZZ with KK-1, counter-clockwise with KK1: a quarter turn about (1,0) ends at (1,1) or (1,-1)
  const auto final_yy = [](const std::string& normal) {
    ProgramBench bench("a.pmc", "&1 #1->1000XX #2->1000YY\nCoord[1].SegMoveTime=5\nopen prog 1\n" + normal + " circle3 inc F5 ta10 ts0 XX1 YY(P1) II1 JJ0\nclose\n");
    bench.run(normal.find("KK1") != std::string::npos ? "P1=-1 &1 b1 r" : "P1=1 &1 b1 r");
    double length = 0;
    for (const auto& move : bench.moves) length += move.length;
    return length;
  };
  const double quarter = 3.14159265358979 / 2;
  CHECK(final_yy("normal KK-1") == Approx(quarter).epsilon(1e-6));
  CHECK(final_yy("normal KK1") == Approx(quarter).epsilon(1e-6));
  CHECK(final_yy("normal K1 KK-1") == Approx(quarter).epsilon(1e-6));
}
