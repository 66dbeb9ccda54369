// Lines of CNC part programs: code letters and what their subprograms read, order of execution, flags, canned cycles. Each case
// shows in moves and variables what the line meant.
#include "tests/unit/programs/bench.h"

using pmac::test::ProgramBench;

namespace {

const std::string kSetUp = "&1 #1->X #2->Y #3->Z\nCoord[1].SegMoveTime=5\n";
const std::string kLibrary =
    "open subprog 1000\nP9++ return\n"
    "N0: rapid return\nN1000: linear return\nN2000: circle1 return\n"
    "N4000: read(P) dwell(D16*1000) return\n"
    "N65000: read(A,B,C) P65=D0 return\n"
    "N90000: abs return\nN91000: inc return\nN50100: P50=1 return\n"
    "N81000: read(X,Y,Z,R) P24=D24 P26=D26 cdef 1000.181 return\n"
    "N80000: cundef return\n"
    "N181000: read(X,Y,R) P80++ rapid X(D24) Y(D25) linear Z(P26) rapid Z10 return\n"
    "close\n"
    "open subprog 1001\nN3000: P3=Coord[1].CdPos[6] return\nN6000: read(T) P6=D20 return\nN30000: stop\nclose\n"
    "open subprog 1002\nread(X) P20++ return\nclose\n";

struct Ran {
  ProgramBench bench;
  explicit Ran(const std::string& lines, const std::string& before = {}, const std::string& commands = "&1 b1r")
      : bench("a.pmc", kSetUp + kLibrary + before + "\nopen prog 1\nF100 ta10 ts0\n" + lines + "\nclose\n") {
    bench.run(commands);
    REQUIRE(bench.refusals.empty());
  }
  double x() { return bench.motor(1).final_mu; }
  double y() { return bench.motor(2).final_mu; }
  double z() { return bench.motor(3).final_mu; }
  /// Final X, without a fault.
  double sound_x() {
    INFO((bench.faults.empty() ? std::string() : bench.faults[0].fault.detail));
    REQUIRE(bench.faults.empty());
    return x();
  }
  std::string fault() { return bench.faults.empty() ? "" : std::to_string(bench.faults[0].fault.source.line) + ": " + bench.faults[0].fault.detail; }
};

double sound_x(const std::string& lines, const std::string& before = {}) { return Ran(lines, before).sound_x(); }

}  // namespace

TEST_CASE("codes on one line act in order, each on what follows it", "[programs][lines]") {
  Ran ran("G90 G1 X10 G91 X5 Y1 G90 Y7");  // 10, then 10 + 5, then back to absolute
  CHECK(ran.sound_x() == 15);
  CHECK(ran.y() == 7);
}

TEST_CASE("computed and fractional codes", "[programs][lines]") {
  CHECK(sound_x("local n; n=26 G(n+65) X3 G(n+64) X3 G50.1 X(P50+6)") == 7);  // inc 3, abs 3, abs 7
}

TEST_CASE("a code without a label comes to the top of its subprogram", "[programs][lines]") {
  CHECK(sound_x("G77 G78 X(P9)") == 2);
}

TEST_CASE("a subprogram reads the words behind its code; the others execute after it", "[programs][lines]") {
  CHECK(sound_x("G65 A1 B2 X5 C3") == 5);           // C stands behind X: it is the axis
  CHECK(sound_x("G65 A1 B2 X5 C3 X(P65)") == 3);    // A and B: bits 1 and 2
  CHECK(sound_x("G65 X(P65)") == 0);
  CHECK(sound_x("M6 T5 X(P6+P20)") == 5);           // M6 has read T5: no tool code
  CHECK(sound_x("T5 M6 X(P6+P20)") == 1);           // a tool code; M6 finds no T behind it
}

TEST_CASE("a word is evaluated again after the code that may have changed its variables", "[programs][lines]") {
  CHECK(sound_x("P9=4 G77 X(P9)") == 5);
}

TEST_CASE("F at the end of a line is the feed rate of that line's move", "[programs][lines]") {
  Ran ran("Coord[1].SegMoveTime=0 G1 X100 F1000 M30", "Coord[1].MaxFeedRate=0");
  CHECK(ran.sound_x() == 100);
  CHECK(ran.bench.moves[0].end_ms - ran.bench.moves[0].start_ms == Approx(100 + 10).epsilon(0.01));  // 100 au at 1000 au/s, and a ramp of ta = 10
}

TEST_CASE("a code behind axis words acts after their move was calculated", "[programs][lines]") {
  CHECK(sound_x("G1 X12 M3\ndwell 0 X(P3+1)") == 13);   // M3 saw X at 12
  CHECK(sound_x("M3 G1 X12\ndwell 0 X(P3+1)") == 1);
}

TEST_CASE("the words behind a call are its arguments for read", "[programs][lines]") {
  const std::string sub = "open subprog 500(a)\nread(X,Y) P1=a+D24*10+D0/8388608*100\nreturn\nN700000: read(Q) P1=D17 return\nclose\n";
  CHECK(sound_x("call 500(1) X2 Z4\nX(P1)", sub) == 121);
  CHECK(sound_x("call 500.7 Q8\nX(P1)", sub) == 8);
  CHECK(sound_x("P5=500.7 call(P5) Q9\nX(P1)", sub) == 9);
  CHECK(sound_x("gosub 20 X3\nX(P1) return\nN20: read(X) P1=D24 return") == 3);
  CHECK(sound_x("callsub 20 X4\nX(P1) return\nN20: read(X) P1=D24 return") == 4);
}

TEST_CASE("a routine sees the words of the line that called it, not those of lines further out", "[programs][lines]") {
  const std::string sub = "open subprog 500\ngosub 10\nread(X) P1+=D24 return\nN10: D24=50 read(X) P1=D24+D0 return\nclose\n";
  CHECK(sound_x("call 500 X2\nX(P1)", sub) == 52);
}

TEST_CASE("a word that nobody reads, and a code that calls nothing, are faults with their names", "[programs][lines]") {
  CHECK(Ran("G65 A1 P1000").fault() == "28: the word P1000 of this line was read by no subprogram, and is no word of a move");
  CHECK(Ran("G1 X5 L3").fault() == "28: the word L3 of this line was read by no subprogram, and is no word of a move");
  CHECK(Ran("S500").fault() == "28: S500 calls no subprogram: Coord[1].Sprog is 0");
  CHECK(Ran("H1").fault() == "28: H1 calls no subprogram: Coord[1].Hprog is 0");
  CHECK(Ran("D1").fault() == "28: D1 calls subprogram 1003 (Coord[1].Dprog), which does not exist; load a library that opens it");
  CHECK(sound_x("S500\nX(P20)", "Coord[1].Sprog=1002") == 1);
  CHECK(sound_x("F7\nX(P20)", "Coord[1].Fprog=1002") == 2);   // F100 in the line before, too
}

TEST_CASE("cexec and cskip leave out the rest of their line by a flag of the coordinate system", "[programs][lines]") {
  CHECK(sound_x("P1=1 cexec3 P1=2\nX(P1)") == 1);
  CHECK(sound_x("P1=1 cset3 cexec3 P1=2 P1++\nX(P1)") == 3);
  CHECK(sound_x("P1=1 cset3 cskip3 P1=2 P1++\nX(P1)") == 1);
  CHECK(sound_x("P1=1 cset3 cclr3 cskip3 P1=2; P1++\nX(P1)") == 3);
  CHECK(sound_x("cset0 cset(2+2) X(Coord[1].Cflags)") == 17);
  CHECK(sound_x("P1=5 cexec1 if (P1 > 1) {\nP1=0\n}\nX(P1)") == 5);
}

TEST_CASE("a canned cycle runs for every move line until it is cancelled", "[programs][lines]") {
  Ran ran("G81 Z-3 R1\nX1 Y1\nX2 Y2 R5\nG80\nX(100*P80+1) Y3");
  CHECK(ran.sound_x() == 201);  // twice
  CHECK(ran.bench.motor(3).min_mu == Approx(-3).margin(1e-4));  // the turn lies between two servo ticks
  CHECK(ran.z() == 10);
  CHECK(ran.y() == 3);
}

TEST_CASE("words that a canned cycle leaves move; moves of code letters' routines do not run it", "[programs][lines]") {
  const std::string sub = "open subprog 700\nread(X) P1+=D24 return\nclose\nopen subprog 1003\nX77 return\nclose\n";
  Ran ran("rapid cdef 700 X1000\nX3 Y4\nX5\nY6\nD1\ncundef\ndwell 0 Z(P1)", sub);
  CHECK(ran.sound_x() == 77);      // D1 moved X by itself
  CHECK(ran.y() == 6);
  CHECK(ran.z() == 1008);          // 3 + 5, and 1000 from the words of cdef for the line without X
  CHECK(Ran("cdef 700 X1\nX3 L5", sub).fault() == "35: the word L5 of this line was not read by the canned cycle, and is no word of a move");
  CHECK(Ran("ccall").fault() == "28: ccall without a number calls what cdef has set, and nothing is set");
  CHECK(sound_x("rapid ccall 700 X9\nX(P1)", sub) == 9);
}

TEST_CASE("bstart and bstop take no part in a program that runs through", "[programs][lines]") {
  CHECK(sound_x("bstart G0 X5 X6 bstop X7") == 7);
}

TEST_CASE("a while loop of a PLC program is tested at the beginning of the next scan", "[programs][plc]") {
  // P1 becomes 0 between two scans; the body must not run again, and what follows the loop runs in the scan that finds it 0
  ProgramBench bench("a.plc", "Sys.MaxRtPlc=1\nopen plc 1\nP2=0\nwhile (P1 == 1) { P2++ P3=Sys.ServoCount }\nP4=Sys.ServoCount P5=P2\ndisable plc 1\nclose\n");
  bench.machine->at(10.0, "P1=0");
  pmac::runtime::RunLimits limits;
  limits.until_ms = 20.0;
  bench.run("P1=1 enable plc 1", limits);
  bench.machine->command("Coord[1].Q[1]=P4-P3 Coord[1].Q[2]=P5", "-e");
  std::string answers;
  REQUIRE(bench.faults.empty());
  bench.machine->command("&2 #5->X\nopen prog 7\nrapid X(1000*Coord[1].Q[1]+Coord[1].Q[2])\nclose\n&2 b7r", "-e");
  bench.machine->run({});
  const double result = bench.motor(5).final_mu;
  CHECK(std::floor(result / 1000) == 1);             // one servo cycle between the last body and what follows
  CHECK(result - 1000 == Approx(23).margin(1));      // a body each servo cycle of 0.4427 ms for 10 ms
}
