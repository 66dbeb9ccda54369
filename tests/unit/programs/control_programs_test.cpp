// Programs that control motors, coordinate systems and other programs.
#include "tests/unit/programs/bench.h"

using pmac::test::ProgramBench;

TEST_CASE("the list * is every motor that is in use", "[programs]") {
  ProgramBench bench("a.pmc", "&1 #1->X #3->Y\nopen plc 1\njog*:500\ndisable plc 1\nclose\n");
  bench.run("enable plc 1");
  REQUIRE(bench.faults.empty());
  CHECK(bench.motor(1).final_mu == 500);
  CHECK(bench.motor(3).final_mu == 500);
  CHECK(bench.statistics.rows().size() == 2);
}

TEST_CASE("on-line lists act once on each of their motors", "[programs]") {
  ProgramBench bench("a.pmc", "&1 #1->X #2->Y #3->Z\n");
  bench.run("#1,3j:70");
  REQUIRE(bench.refusals.empty());
  CHECK(bench.motor(1).final_mu == 70);
  CHECK(bench.motor(2).final_mu == 0);
  CHECK(bench.motor(3).final_mu == 70);
}

TEST_CASE("a jog with * uses ProgJogPos as position or distance", "[programs]") {
  ProgramBench bench("a.pmc", "&1 #1->X\nMotor[1].ProgJogPos = 300\nopen plc 1\njog1=*\ncall 5\njog1:*\ndisable plc 1\nclose\nopen subprog 5\nlocal end = Sys.Time + 1; while (Sys.Time < end) {}\nclose\n");
  pmac::runtime::RunLimits limits;
  limits.until_ms = 4000;
  bench.run("enable plc 1", limits);
  CHECK(bench.motor(1).final_mu == 600);
}
