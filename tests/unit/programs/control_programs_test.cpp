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

namespace {

pmac::runtime::RunLimits until(double ms) {
  pmac::runtime::RunLimits limits;
  limits.until_ms = ms;
  return limits;
}

}  // namespace

TEST_CASE("a PLC starts a motion program, waits for its end, and starts the next one", "[programs]") {
  ProgramBench bench("a.pmc",
                     "&1 #1->X\nglobal State = 0;\nopen prog 5\nrapid abs X100\nclose\nopen prog 6\nrapid abs X40\nclose\n"
                     "open plc 1\nLdata.Coord = 1\nswitch (State) {\n"
                     "case 0: start:5 State = 1 break\n"
                     "case 1: if (Coord[1].ProgActive == 0) { start1:6 State = 2 } break\n"
                     "case 2: if (Coord[1].ProgActive == 0) { State = 3 disable plc 1 } break }\nclose\n");
  bench.run("enable plc 1");
  REQUIRE(bench.faults.empty());
  REQUIRE(bench.moves.size() == 2);
  CHECK(bench.moves[1].start_ms > bench.moves[0].end_ms);             // one after the other, at most two background cycles later
  CHECK(bench.moves[1].start_ms <= bench.moves[0].end_ms + 2.5);
  CHECK(bench.motor(1).final_mu == 40);
  CHECK(bench.motor(1).max_mu == 100);
}

TEST_CASE("a PLC aborts a program of its coordinate system", "[programs]") {
  ProgramBench bench("a.pmc", "&1 #1->1000X\nopen prog 5\nlinear abs F1 ta100 ts0 X1000\nclose\n"
                              "open plc 1\nSys.CdTimer[0] = 500\nstart1:5\nwhile (Sys.CdTimer[0] > 0) {}\nabort1\ndisable plc 1\nclose\n");
  bench.run("enable plc 1");
  REQUIRE(bench.faults.empty());
  REQUIRE(bench.refusals.empty());
  CHECK(bench.motor(1).final_mu > 300);    // 1 mu/ms for half a second
  CHECK(bench.motor(1).final_mu < 520);
}

TEST_CASE("a motion program starts and stops PLC programs", "[programs]") {
  ProgramBench bench("a.pmc", "&1 #1->X\nglobal Count = 0;\nopen plc 3\nCount++\nclose\n"
                              "open prog 1\nrapid\nenable plc 3\ndwell 10\ndisable plc 3\nP1 = Count\ndwell 10\nif (P1 > 5 && Count == P1) X1 else X2\nclose\n");
  bench.run("&1 b1r");
  REQUIRE(bench.faults.empty());
  CHECK(bench.motor(1).final_mu == 1);   // a scan each ms, for 10 ms
}

TEST_CASE("programs of two coordinate systems and their PLCs run side by side", "[programs]") {
  ProgramBench bench("a.pmc", "&1 #1->1000X &2 #2->1000X\nopen prog 1\nlinear inc F10 ta100 ts0 X10\nstart2:2\nX10\nclose\nopen prog 2\nlinear inc F5 ta100 ts0 X5\nclose\n");
  bench.run("&1 b1r");
  REQUIRE(bench.faults.empty());
  CHECK(bench.motor(1).final_mu == 20000);
  CHECK(bench.motor(2).final_mu == 5000);
}

TEST_CASE("Q variables of a PLC are those of Ldata.Coord", "[programs]") {
  ProgramBench bench("a.pmc", "open plc 1\nLdata.Coord = 2\nQ5 = 7\nLdata.Coord = 3\nQ5 = 8\nsend1 \"%g %g %g\", Coord[2].Q[5], Coord[3].Q[5], Coord[0].Q[5]\ndisable plc 1\nclose\n");
  bench.run("enable plc 1", until(5));
  CHECK(bench.answers == std::vector<std::string>{"[send 1] 7 8 0"});
}

TEST_CASE("cmd texts are executed in their order behind the scan, with addresses of their own", "[programs]") {
  ProgramBench bench("a.pmc", "&1 #1->X &2 #2->X\nopen prog 5\nrapid X7\nclose\n"
                              "open plc 1\nLdata.CmdStatus = 1\ncmd \"&2\"\ncmd \"b5r\"\ncmd \"#%dj:%d\", 1, 30\nP1 = Ldata.CmdStatus\nsendallcmds\nP2 = Ldata.CmdStatus\n"
                              "send1 \"%d %d\", P1, P2\ndisable plc 1\nclose\n");
  bench.run("enable plc 1", until(500));
  REQUIRE(bench.refusals.empty());
  CHECK(bench.answers == std::vector<std::string>{"[send 1] 1 0"});
  CHECK(bench.motor(2).final_mu == 7);   // &2 holds for b5r
  CHECK(bench.motor(1).final_mu == 30);
}

TEST_CASE("Ldata.CmdStatus is minus the error number of a refused cmd", "[programs]") {
  ProgramBench bench("a.pmc", "open plc 1\nLdata.CmdStatus = 1\ncmd \"&1 b77r\"\ncmd \"P5=3\"\nsendallcmds\nsend1 \"%d %g\", Ldata.CmdStatus, P5\ndisable plc 1\nclose\n");
  bench.run("enable plc 1", until(5));
  CHECK(bench.answers == std::vector<std::string>{"[send 1] -39 3"});  // nothing selected: NOT READY TO RUN
  CHECK(!bench.refusals.empty());
}

TEST_CASE("sendallcmds in a motion program: the commands are done before the next statement", "[programs]") {
  ProgramBench bench("a.pmc", "&1 #1->X\nopen prog 1\nrapid X5\nLdata.CmdStatus = 1\ncmd \"P10=7\"\nsendallcmds\nX(P10)\nsend1 \"%d\", Ldata.CmdStatus\nclose\n");
  bench.run("&1 b1r");
  REQUIRE(bench.faults.empty());
  CHECK(bench.motor(1).final_mu == 7);
  CHECK(bench.answers == std::vector<std::string>{"[send 1] 0"});
}

TEST_CASE("a paused PLC goes on where it stood, a disabled one begins at the top", "[programs]") {
  const std::string text = "global Top = 0, Rest = 0;\nopen plc 1\nTop++\nwhile (Rest < 5) { Rest++ }\nwhile (1) {}\nclose\n";
  ProgramBench paused("a.pmc", text);
  paused.machine->at(3, "pause plc 1");
  paused.machine->at(10, "resume plc 1");
  paused.machine->at(20, "Top Rest Plc[1].Active");
  paused.run("enable plc 1", until(30));
  CHECK(paused.answers == std::vector<std::string>{"Top=1", "Rest=5", "Plc[1].Active=1"});
  ProgramBench disabled("a.pmc", text);
  disabled.machine->at(3, "disable plc 1");
  disabled.machine->at(5, "Plc[1].Active Plc[1].Running");
  disabled.machine->at(10, "enable plc 1");
  disabled.machine->at(20, "Top");
  disabled.run("enable plc 1", until(30));
  CHECK(disabled.answers == std::vector<std::string>{"Plc[1].Active=0", "Plc[1].Running=0", "Top=2"});
}

TEST_CASE("foreground PLCs are scanned at every real-time interrupt, background ones once a background cycle", "[programs]") {
  ProgramBench bench("a.pmc", "Sys.ServoPeriod = 0.25\nSys.RtIntPeriod = 1\nSys.MaxRtPlc = 2\nglobal Fore = 0, Back = 0;\nopen plc 2\nFore++\nclose\nopen plc 3\nBack++\nclose\n");
  bench.machine->at(100, "Fore Back");
  bench.run("enable plc 2..3", until(101));
  REQUIRE(bench.answers.size() == 2);
  CHECK(std::stod(bench.answers[0].substr(5)) == Approx(200).margin(1));   // every 0.5 ms
  CHECK(std::stod(bench.answers[1].substr(5)) == Approx(100).margin(1));   // every 1 ms
}

TEST_CASE("axis values of a coordinate system go to D variables", "[programs]") {
  // 10 au/s; the ramp of 0.1 s costs 0.05 s; Y = (0 - 250) / 500 at rest
  ProgramBench bench("a.pmc", "&1 #1->1000X #2->500Y+250\nopen prog 1\nlinear abs F10 ta100 ts0 X30\nclose\n"
                              "open plc 1\nLdata.Coord = 1\nif (Sys.Time < 1.5) return\npread send1 \"%.2f %.2f $%x\", D6 - 10*(Sys.Time-0.05), D7, D32\n"
                              "vread send1 \"%.2f\", D6\ntread send1 \"%.2f\", D6\nfread send1 \"%.2f\", D6\nD32=0 dread(X) send1 \"$%x\", D32\ndisable plc 1\nclose\n");
  bench.run("&1 b1r enable plc 1", until(2000));
  REQUIRE(bench.faults.empty());
  CHECK(bench.answers == std::vector<std::string>{"[send 1] -0.00 -0.50 $c0", "[send 1] 10.00", "[send 1] 30.00", "[send 1] 0.00", "[send 1] $40"});
}

TEST_CASE("step plc executes a line; then the PLC is paused there", "[programs]") {
  ProgramBench bench("a.pmc", "open plc 1\nP1 = P1 + 1 P2 = 10\nif (P1 == 1)\n{\nP3 = 5\n}\nP4 = 7\nclose\n");
  const auto step = [&](double ms) { bench.machine->at(ms, "step plc 1 P1 P2 P3 P4 Plc[1].Active Plc[1].Running"); };
  for (double ms : {1.0, 2.0, 3.0, 4.0, 5.0, 6.0}) step(ms);
  bench.run("P9=0", until(10));
  REQUIRE(bench.refusals.empty());
  REQUIRE(bench.answers.size() == 36);
  const auto seen = [&](int k) { return bench.answers[static_cast<std::size_t>(6 * k)] + " " + bench.answers[static_cast<std::size_t>(6 * k + 1)] + " " + bench.answers[static_cast<std::size_t>(6 * k + 2)] + " " + bench.answers[static_cast<std::size_t>(6 * k + 3)]; };
  CHECK(seen(0) == "P1=1 P2=10 P3=0 P4=0");   // the line, whole
  CHECK(seen(5) == "P1=2 P2=10 P3=5 P4=7");   // the last step is the first line of the next scan
  CHECK(bench.answers[4] == "Plc[1].Active=1");
  CHECK(bench.answers[5] == "Plc[1].Running=0");
}
