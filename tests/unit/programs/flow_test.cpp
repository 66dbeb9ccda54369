// What flow control and calls mean when they run: each small program leaves a number in the position of X.
#include "tests/unit/programs/bench.h"

using pmac::test::ProgramBench;

namespace {

/// Final position of X after `lines` in program 1; `before` stands in front of it.
double final_x(const std::string& lines, const std::string& before = {}) {
  ProgramBench bench("a.pmc", "&1 #1->X\n" + before + "\nopen prog 1\nrapid abs\n" + lines + "\nclose\n");
  bench.run("&1 b1r");
  INFO((bench.faults.empty() ? std::string() : bench.faults[0].fault.detail));
  REQUIRE(bench.refusals.empty());
  REQUIRE(bench.faults.empty());
  return bench.motor(1).final_mu;
}

std::string fault_of(const std::string& lines, const std::string& before = {}) {
  ProgramBench bench("a.pmc", "&1 #1->X\n" + before + "\nopen prog 1\nrapid abs\n" + lines + "\nclose\n");
  bench.run("&1 b1r");
  return bench.faults.empty() ? std::string() : bench.faults[0].fault.detail;
}

}  // namespace

TEST_CASE("an else belongs to the nearest if, also over lines", "[programs][flow]") {
  const std::string text = "P1=9\nif (P2)\nif (P3) P1=1\nelse P1=2\nX(P1)";
  CHECK(final_x("P2=0 P3=0\n" + text) == 9);   // the outer if has no else
  CHECK(final_x("P2=1 P3=0\n" + text) == 2);
  CHECK(final_x("P2=1 P3=1\n" + text) == 1);
}

TEST_CASE("the first true branch of an else-if chain runs, and no other", "[programs][flow]") {
  const std::string chain = "if (P1 == 1) P2=10 else if (P1 > 1) P2=20 else if (P1 > 0) P2=30 else P2=40\nX(P2)";
  CHECK(final_x("P1=1 " + chain) == 10);
  CHECK(final_x("P1=2 " + chain) == 20);
  CHECK(final_x("P1=0.5 " + chain) == 30);
  CHECK(final_x("P1=0 " + chain) == 40);
}

TEST_CASE("do runs its body once before the test, with and without braces, the test on the next line", "[programs][flow]") {
  CHECK(final_x("P1=9\ndo P1++\nwhile (P1 < 5)\nX(P1)") == 10);
  CHECK(final_x("P1=1\ndo { P1++ } while (P1 < 5)\nX(P1)") == 5);
  CHECK(final_x("P1=0 P2=0\ndo { do P2++ while (P2 < 3) P1++ } while (P1 < 2)\nX(P1*10+P2)") == 24);  // the inner body: 3 times, then once
}

TEST_CASE("switch: cut to an integer, falls through, break leaves it alone, continue goes on with the loop around it", "[programs][flow]") {
  const std::string text = "P2=0\nswitch (P1) { case 0: P2+=1\ncase 1: P2+=10 break\ndefault: P2+=100\ncase -2: P2+=1000 }\nX(P2)";
  CHECK(final_x("P1=0.9 " + text) == 11);
  CHECK(final_x("P1=1 " + text) == 10);
  CHECK(final_x("P1=-0.9 " + text) == 11);
  CHECK(final_x("P1=-2.5 " + text) == 1000);
  CHECK(final_x("P1=7 " + text) == 1100);      // default stands in the middle and falls through
  CHECK(final_x("P1=0 P2=0\nwhile (P1 < 4) { P1++ switch (P1) { case 2: continue } P2+=P1 }\nX(P2)") == 8);  // 1 + 3 + 4
}

TEST_CASE("break and continue act on the innermost loop", "[programs][flow]") {
  CHECK(final_x("P1=0 P2=0\nwhile (P1 < 3) { P1++ P3=0 while (1) { P3++ if (P3 > 4) break\nif (P3 % 2 == 1) continue\nP2++ } }\nX(P2)") == 6);
}

TEST_CASE("goto with a constant or computed label, forward, backward and out of loops", "[programs][flow]") {
  CHECK(final_x("P1=1 goto 10\nP1=2\nN10: X(P1)") == 1);
  CHECK(final_x("P1=20 goto(P1+10)\nN20: X1 return\nN30: X2") == 2);
  CHECK(final_x("P1=0\nN5: P1++ if (P1 < 3) goto(2+3)\nX(P1)") == 3);
  CHECK(final_x("P1=0\nwhile (1) { P1++ if (P1 == 4) goto 7 }\nN7: X(P1)") == 4);
  CHECK(fault_of("P1=77 goto(P1)") == "the program has no label N77");
}

TEST_CASE("gosub keeps the locals, callsub opens new ones with arguments and results", "[programs][flow]") {
  CHECK(final_x("local n; n=3 gosub 10 X(n) return\nN10: n=n*2 return") == 6);
  CHECK(final_x("local n; n=3 callsub 10 X(n) return\nN10: n=n*2 return") == 3);
  CHECK(final_x("R0=4 callsub 10 X(R0) return\nN10: L0=L0*2 return") == 8);                    // R(i) is L(i) of the routine, and comes back
  CHECK(final_x("P1=10 gosub(P1) callsub(P1+10) X(P2) return\nN10: P2+=1 return\nN20: P2+=5 return") == 6);
  CHECK(final_x("local r; callsub half(9, r) X(r) return\nsub: half(n, &result)\nresult = n/2") == 4.5);
}

TEST_CASE("results come back through & arguments into variables, array elements and elements", "[programs][flow]") {
  const std::string sub = "open subprog Twice(a, &b)\nb = 2*a a = 99\nclose\n";
  CHECK(final_x("local x2; x2=1 call Twice(4, x2) X(x2)", sub) == 8);
  CHECK(final_x("P1=4 call Twice(P1, P(P1+1)) X(P1*10+P5)", sub) == 48);       // a is by value: P1 keeps 4
  CHECK(final_x("local t(3), i; i=2 call Twice(3, t(i)) X(t(2))", sub) == 6);
  CHECK(final_x("call Twice(5, Coord[1].Td) X(Coord[1].Td)", sub) == 10);
}

TEST_CASE("SUB: routines have entries and locals of their own", "[programs][flow]") {
  const std::string sub = "open subprog Tool\nP1=1 return\nsub: drill(depth)\nlocal k; k=depth*2 P1=k\nsub: stop1\nP1=3\nclose\n";
  CHECK(final_x("call Tool X(P1)", sub) == 1);
  CHECK(final_x("call Tool.drill(8) X(P1)", sub) == 16);   // a routine ends where the next one begins
  CHECK(final_x("call Tool.stop1 X(P1)", sub) == 3);
}

TEST_CASE("call: label as fraction in millionths, missing labels at the top, missing subprograms are faults", "[programs][flow]") {
  const std::string sub = "open subprog 123\nP1=5 return\nN456000: P1=6 return\nN1: P1=7 return\nclose\n";
  CHECK(final_x("call 123.456 X(P1)", sub) == 6);
  CHECK(final_x("call 123.000001 X(P1)", sub) == 7);
  CHECK(final_x("P2=123.456 call(P2) X(P1)", sub) == 6);
  CHECK(final_x("call 123.5 X(P1)", sub) == 5);
  CHECK(fault_of("call 124").find("subprogram 124 does not exist") != std::string::npos);
}

TEST_CASE("stop ends the program from any depth, return only the routine", "[programs][flow]") {
  const std::string sub = "open subprog 5\nX1 return\nX2\nclose\nopen subprog 6\ncall 7 X8\nclose\nopen subprog 7\nX3 stop X4\nclose\n";
  CHECK(final_x("call 5 X(9)", sub) == 9);
  CHECK(final_x("call 6 X9", sub) == 3);
}

TEST_CASE("calls are nested at most 255 deep", "[programs][flow]") {
  const std::string sub = "open subprog 5(n)\nP1=n if (n < P2) call 5(n+1)\nclose\n";
  CHECK(final_x("P2=255 call 5(1) X(P1)", sub) == 255);
  CHECK(fault_of("P2=256 call 5(1)", sub).find("255") != std::string::npos);
}

TEST_CASE("sizes behind the open name change nothing", "[programs][flow]") {
  CHECK(final_x("call 7(2) X(P1)", "open subprog 7(a), 20, 30\nP1=a\nclose\n") == 2);
}

TEST_CASE("labels share a line with statements, a number without colon is no label", "[programs][flow]") {
  CHECK(final_x("goto 20\nN10 P1=1\nN20: N21: P1+=2 X(P1)") == 2);
}
