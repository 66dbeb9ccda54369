// Numbers that are not finite, computed by a program or command: an error with its place wherever a statement takes a number, and never
// silently something else.
#include "tests/unit/programs/lines.h"

using namespace pmac::test;

namespace {

constexpr int kLine = 15;   // of the statement, behind with_motors() of lines.h and two lines here

Lines with(const std::string& statement) { return Lines("P1=0\nP2=1\n" + statement + "\nlinear X1", "Motor[5].ProgJogPos=7777 Motor[5].JogSpeed=32 Coord[1].SegMoveTime=5"); }

}  // namespace

TEST_CASE("a program's numbers that are not finite are faults with their line", "[programs][not_finite]") {
  for (const char* number : {"(P1/P1)", "(P2/P1)", "(sqrt(-P2))", "(-P2/P1)"})
    for (const char* statement : {"jog5=@", "jog5:@", "jog5^@", "jog5==@", "jog5=100^@", "jog+@", "jog@=100", "home@", "homez@", "kill@", "enable plc(Q1+@)", "pset X@", "dwell@", "delay@",
                                  "F@", "ta@", "td@", "ts@", "tm@", "pvt@", "spline@", "tsel@", "ccr@", "ccmode@", "X@", "X1 Y@", "inc X@", "circle1 X1 Y1 I@ J0", "circle1 X1 Y1 R@",
                                  "normal I@", "rapid X1^@", "pvt100 X1:@", "call@", "Motor[1].JogSpeed=@", "Motor[5].ProgJogPos=@", "Motor[1].HomeOffset=@", "Motor[1].HomePos=@",
                                  "Coord[1].DesTimeBase=@", "Coord[1].SegMoveTime=@", "Sys.CdTimer[1]=@", "Ldata.GoBack=@", "Gather.Enable=@"}) {
      std::string text = statement;
      text.replace(text.find('@'), 1, number);
      INFO(text);
      Lines bench = with(text);
      REQUIRE(bench.faults.size() == 1);
      CHECK(bench.faults[0].fault.source.line == kLine);
      CHECK(bench.motor(1).final_mu == 0);
    }
}

TEST_CASE("a command line's numbers that are not finite are refused", "[programs][not_finite]") {
  for (const char* command : {"#1j=(0/0)", "#1j:(0/0)", "#1j^(0/0)", "#1j==(0/0)", "#1j=(1/0)", "#1j:(0/0)^5", "#1j=5^(0/0)", "#1out(0/0)", "&1%(0/0)", "Motor[1].JogSpeed=0/0",
                              "Motor[1].ProgJogPos=1/0", "Motor[1].HomeOffset=0/0", "Coord[1].Ta=0/0", "Coord[1].DesTimeBase=1/0"}) {
    INFO(command);
    ProgramBench bench("a.pmc", "&1 #1->1000X\nMotor[1].ProgJogPos=7777\n");
    bench.run(command);
    CHECK(bench.refusals.size() == 1);
    CHECK(bench.motor(1).final_mu == 0);
  }
}

TEST_CASE("the * forms of a jog take ProgJogPos, in lists too", "[programs][not_finite]") {
  ProgramBench one("a.pmc", "&1 #1->1000X #2->1000Y\nMotor[1].ProgJogPos=7777 Motor[2].ProgJogPos=-55\n");
  one.run("#1j=*");
  CHECK(one.refusals.empty());
  CHECK(one.motor(1).final_mu == 7777);
  ProgramBench all("a.pmc", "&1 #1->1000X #2->1000Y\nMotor[1].ProgJogPos=7777 Motor[2].ProgJogPos=-55\nopen plc 1\njog1..2=*\ndisable plc 1\nclose\n");
  all.run("enable plc 1");
  CHECK(all.motor(1).final_mu == 7777);
  CHECK(all.motor(2).final_mu == -55);
}
