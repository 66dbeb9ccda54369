// Small programs of many statements, checked by what they leave in variables: each writes to P variables that an element of a
// motor's target then shows.
#include "tests/unit/programs/bench.h"

using pmac::test::ProgramBench;

namespace {

/// Final position of X after `lines` in program 1, with one unit of X a motor unit.
double final_x(const std::string& lines, const std::string& before = {}, const std::string& commands = "&1 b1r") {
  ProgramBench bench("a.pmc", "&1 #1->X\n" + before + "\nopen prog 1\nrapid abs\n" + lines + "\nclose\n");
  bench.run(commands);
  REQUIRE(bench.refusals.empty());
  REQUIRE(bench.faults.empty());
  return bench.motor(1).final_mu;
}

}  // namespace

TEST_CASE("subprograms return results, named and numbered, also recursively", "[programs]") {
  const std::string twice = "open subprog 201(n,&f)\nf = n*2\nclose\nopen subprog Twice(n,&f)\nf = n*2\nclose\n";
  CHECK(final_x("local a; call 201(6, a) X(a)", twice) == 12);
  CHECK(final_x("local a; call Twice(7, a) X(a)", twice) == 14);
  CHECK(final_x("call 200(6, P1) X(P1)",
                "open subprog 200(n,&f)\nlocal below;\nif (n <= 1) f = 1 else { call 200(n-1, below) f = n*below }\nclose\n") == 720);
}

TEST_CASE("control statements", "[programs]") {
  CHECK(final_x("P1=0 P2=0 while (P1<5) { P1++ if (P1==3) continue P2+=P1 } X(P2)") == 12);             // 1+2+4+5
  CHECK(final_x("P1=0 do P1+=2 while (P1<7) X(P1)") == 8);
  CHECK(final_x("P1=2 P2=0\nswitch (P1) { case 1: P2=10 break\ncase 2: P2=20\ncase 3: P2+=1 break\ndefault: P2=99 }\nX(P2)") == 21);
  CHECK(final_x("P1=0\nN10: P1++\nif (P1<4) goto10\nX(P1)") == 4);
  CHECK(final_x("P1=1 gosub100 gosub100 X(P1)\nreturn\nN100: P1=P1*3 return") == 9);
}

TEST_CASE("operators have the documented precedence and signs", "[programs]") {
  CHECK(final_x("if ($0F & $18 == 8) X1 else X2") == 1);         // (a & b) == c
  CHECK(final_x("X(2+3*4-8/2)") == 10);
  CHECK(final_x("X(-7 % 5)") == 3);                              // in [0, 5)
  CHECK(final_x("X(7 % -5)") == -3);                             // in [-5, 5)
  CHECK(final_x("X((3&-3)*100+(3|-3)*10+(3^-3))") == 88);        // 1, -1, -2
  CHECK(final_x("if (5 ~ 5.4 && 5 !~ 5.6) X1 else X2") == 1);    // equal to within 0.5
}

TEST_CASE("variables: arrays, computed numbers, csglobal, pointers to elements", "[programs]") {
  CHECK(final_x("local i; local T(4); i=0 while (i<4) { T(i)=i*i i++ } X(T(3)+T(2))") == 13);
  CHECK(final_x("P(100+1)=5 X(P101+Q(P101))") == 5);
  CHECK(final_x("X(Offset)", "csglobal Offset = 17;") == 17);
  CHECK(final_x("Speed = 20 X(Motor[1].JogSpeed)", "ptr Speed->Motor[1].JogSpeed") == 20);
}

TEST_CASE("an address behind a value on a command line is an address; glued or spaced it is a bitwise and", "[programs]") {
  CHECK(final_x("X(P1)", {}, "P1=40 &1 b1r") == 40);
  CHECK(final_x("X(P1)", {}, "P1=7&6 &1b1r") == 6);
  CHECK(final_x("X(P1)", {}, "P1=7 & 6\n&1b1r") == 6);
}

TEST_CASE("commanded velocity of programmed moves and jogs is read in motor units a servo cycle", "[programs]") {
  ProgramBench bench("a.pmc", "&1 #1->1000X #2->Y\nopen prog 1\nlinear F10 ta100 ts0\nX2 X4\nclose\n&2 #3->X\nopen prog 2\nrapid dwell 250 X(1000*Motor[1].DesVel)\nclose\n");
  bench.run("&1 b1r &2 b2r");
  CHECK(bench.motor(3).final_mu == Approx(1000 * 10 * 0.44274211).epsilon(1e-6));  // 10 mu/ms times the servo period
}

TEST_CASE("homez in a program makes the place where the motor has stopped the zero", "[programs]") {
  ProgramBench bench("a.pmc", "&1 #1->1000X\nopen prog 1\nlinear F10 ta100 ts0 inc\nX2\nhomez 1\nX3\nclose\n");
  bench.run("&1 b1r");
  REQUIRE(bench.faults.empty());
  CHECK(bench.motor(1).final_mu == 3000.0);
}

TEST_CASE("positions at rest are exactly the programmed ones", "[programs]") {
  ProgramBench bench("a.pmc", "&1 #1->1000X\nopen prog 1\nlinear F5 ta500 td800 ts100\nX10 dwell 0\nX0 dwell 0\nif (Motor[1].DesPos == 0) P1=7\nX(P1) dwell 0\nclose\n");
  bench.run("&1 b1r");
  CHECK(bench.motor(1).final_mu == 7000.0);
}

TEST_CASE("an aborted program stops its motors and can be started again", "[programs]") {
  ProgramBench bench("a.pmc", "&1 #1->1000X\nopen prog 1\nlinear abs F10 ta100 ts0\nX20 X0\nclose\n");
  bench.machine->at(1000.0, "&1 a");
  bench.machine->at(1500.0, "&1 b1r");
  bench.run("&1 b1r");
  REQUIRE(bench.refusals.empty());
  REQUIRE(bench.faults.empty());
  CHECK(bench.motor(1).final_mu == 0.0);
  CHECK(bench.motor(1).max_mu == Approx(20000.0).margin(0.01));  // the turn lies between two servo ticks
  CHECK(bench.motor(1).max_accel_mu_ms2 == Approx(0.5).epsilon(0.01));  // AbortTa = -2: 1/2 mu/ms^2
}
