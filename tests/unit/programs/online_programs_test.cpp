// Command lines that act on programs and motors: killing under a program, open-loop output, where a program stands, what the set-up is
// backed up as. The servo period is 1 ms; moves run at 10 mu/ms without ramps.
#include "tests/unit/programs/bench.h"

using pmac::test::ProgramBench;

namespace {

const std::string kSetUp =
    "Sys.ServoPeriod=1\n&1 #1->1000X #2->1000Y\n"
    "Motor[1].InvAmax=0 Motor[1].InvDmax=0 Motor[2].InvAmax=0 Motor[2].InvDmax=0 Motor[1].AbortTa=100 Motor[2].AbortTa=100\n";
// lines 4 to 10
const std::string kThreeMoves = "open prog 1\nlinear abs ta0 ts0 F10\nX1\nX2\ndwell 100\nX3\nclose\n";

pmac::runtime::RunLimits until(double ms) {
  pmac::runtime::RunLimits limits;
  limits.until_ms = ms;
  return limits;
}

using Answers = std::vector<std::string>;

}  // namespace

TEST_CASE("a motor that is killed under a program ends it with a fault at the line in motion", "[programs]") {
  for (const std::string command : {"#1k", "#1dkill", "#1out0"}) {
    INFO(command);
    ProgramBench bench("a.pmc", kSetUp + kThreeMoves);
    bench.machine->at(150, command);
    bench.machine->at(200, "Coord[1].ProgActive Coord[1].ErrorStatus Motor[1].ClosedLoop");
    bench.run("&1 b1r");
    REQUIRE(bench.faults.size() == 1);
    CHECK(bench.faults[0].fault.kind == pmac::runtime::FaultKind::kMotorKilled);
    CHECK(bench.faults[0].fault.source.line == 7);   // X2 begins at 100 ms
    CHECK(bench.faults[0].fault.detail.find("motor 1") != std::string::npos);
    CHECK(bench.answers == Answers{"Coord[1].ProgActive=0", "Coord[1].ErrorStatus=16", "Motor[1].ClosedLoop=0"});
  }
}

TEST_CASE("abort and disable end a program without a fault", "[programs]") {
  for (const std::string command : {"&1a", "&1disable"}) {
    ProgramBench bench("a.pmc", kSetUp + kThreeMoves);
    bench.machine->at(150, command);
    bench.run("&1 b1r");
    CHECK(bench.faults.empty());
  }
}

TEST_CASE("a delayed kill that comes due under a program is a fault", "[programs]") {
  ProgramBench bench("a.pmc", kSetUp + "Motor[1].BrakeOnDelay=50\n" + kThreeMoves);
  bench.machine->at(10, "#1dkill");
  bench.machine->at(20, "&1 b1r");
  bench.run("P1=0");
  REQUIRE(bench.faults.size() == 1);
  CHECK(bench.faults[0].time_ms == 60);
}

TEST_CASE("open-loop output is a part of MaxDac, and an ideal motor stands under it", "[programs]") {
  ProgramBench bench("a.pmc", kSetUp);
  bench.machine->command("Motor[2].MaxDac=10000");
  bench.run("#1out10 #2out-25", until(1));
  bench.answers.clear();
  bench.refusals.clear();
  bench.machine->command("Motor[1].ServoOut Motor[2].ServoOut Motor[1].ClosedLoop Motor[1].AmpEna #1p #1j/ Motor[1].ServoOut Motor[1].ClosedLoop");
  // 10 % of the default 28000; -25 % of 10000
  CHECK(bench.answers == Answers{"Motor[1].ServoOut=2800", "Motor[2].ServoOut=-2500", "Motor[1].ClosedLoop=0", "Motor[1].AmpEna=1", "0", "Motor[1].ServoOut=0", "Motor[1].ClosedLoop=1"});
  bench.machine->command("#1out101");
  REQUIRE(bench.refusals.size() == 1);
  CHECK(bench.refusals[0].find("error #23") != std::string::npos);
}

TEST_CASE("worst speed and acceleration do not count the step of the origin when home is found", "[programs]") {
  // 10 mu/ms and ramps of 100 ms: 0.1 mu/ms^2. Home is at 1000 mu, a step of 1000 mu in the position from home.
  ProgramBench bench("a.pmc", kSetUp + "Motor[1].JogTa=100 Motor[1].JogTs=0 Motor[1].HomeVel=10 Sim.Motor[1].TriggerPos=1000\n");
  bench.run("#1hm");
  CHECK(bench.motor(1).final_mu == Approx(0).margin(1e-9));
  CHECK(bench.motor(1).max_speed_mu_ms == Approx(10).margin(1e-9));
  CHECK(bench.motor(1).max_accel_mu_ms2 < 0.2001);   // turning round: from 10 to -10 mu/ms in 100 ms
}

TEST_CASE("list pc is where a program calculates, list apc where it moves or was aborted", "[programs]") {
  ProgramBench bench("a.pmc", kSetUp + kThreeMoves);
  bench.machine->at(150, "list pc list apc &1a");
  bench.machine->at(300, "list apc list pc");
  bench.machine->at(350, "&1r list apc");
  bench.run("list apc &1 b1r");
  // without the text of the source the place is answered; the dwell in line 8 stops the calculation before line 9, X2 in line 7 moves from
  // 100 to 200 ms, and line 5 is where a program that was started anew begins
  CHECK(bench.answers == Answers{"a.pmc:9", "a.pmc:7", "a.pmc:7", "a.pmc:5"});
  REQUIRE(bench.refusals.size() == 2);
  CHECK(bench.refusals[0].find("error #22") != std::string::npos);
  CHECK(bench.refusals[1].find("no program is active") != std::string::npos);
}

TEST_CASE("a run that reaches its limit names the line in motion", "[programs]") {
  ProgramBench bench("a.pmc", kSetUp + kThreeMoves);
  pmac::runtime::RunLimits limits;
  limits.max_ms = 350;   // X3 moves from 300 ms on, and all is calculated
  CHECK(bench.run("&1 b1r", limits).running == Answers{"prog 1 at a.pmc:9"});
}

TEST_CASE("L variables of command lines keep their values from line to line", "[programs]") {
  ProgramBench bench("a.pmc", kSetUp + "open prog 1\nL3=7\nclose\n");
  bench.run("L3=5 L200=1");
  bench.machine->command("L3 L200 L8191");
  CHECK(bench.answers == Answers{"L3=5", "L200=1", "L8191=0"});
}

TEST_CASE("a list of values goes on from an index that a local holds", "[programs]") {
  ProgramBench bench("a.pmc", "L2=1\nModbus[3].Config.ServerIpAddr[L2]=10,20,30\nopen plc 1\nlocal i\ni=4\nSys.P[i]=1,2,3\ndisable plc 1\nclose\n");
  bench.run("enable plc 1 L2", until(5));
  bench.machine->command("Modbus[3].Config.ServerIpAddr[0] Modbus[3].Config.ServerIpAddr[1] Modbus[3].Config.ServerIpAddr[3] P3..7");
  CHECK(bench.answers == Answers{"L2=1", "Modbus[3].Config.ServerIpAddr[0]=0", "Modbus[3].Config.ServerIpAddr[1]=10", "Modbus[3].Config.ServerIpAddr[3]=30",
                                 "P3=0", "P4=1", "P5=2", "P6=3", "P7=0"});
  bench.machine->command("L2=2 Modbus[3].Config.ServerIpAddr[L2]=1,2,3");
  REQUIRE(bench.refusals.size() == 1);
  CHECK(bench.refusals[0].find("out of range") != std::string::npos);
}

TEST_CASE("programs begin by a name that is glued to the command", "[programs]") {
  const std::string programs = "open prog Main\nP1=P1+1\nclose\nopen prog 5\nP2=P2+1\nclose\n";
  for (const std::string command : {"&1bMain r", "&1 bMainr", "&1startMain", "&1 startMain", "&1BEGINMain r", "&1 b Main r", "&1 start Main", "&1 begin:Main r"}) {
    INFO(command);
    ProgramBench bench("a.pmc", kSetUp + programs);
    bench.run(command);
    CHECK(bench.refusals.empty());
    bench.machine->command("P1");
    CHECK(bench.answers == Answers{"P1=1"});
  }
}

TEST_CASE("begin and start take lists of coordinate systems", "[programs]") {
  const std::string text = "&2 #3->X\nopen prog 5\nP100=P100+1 Q1=1\nclose\n";
  for (const std::string command : {"start1,2:5", "start1..2:5", "&1,2start5", "&1,2 b5r", "begin1,2:5 &1,2r", "start1:5,2:5"}) {
    INFO(command);
    ProgramBench bench("a.pmc", kSetUp + text);
    bench.run(command);
    CHECK(bench.refusals.empty());
    bench.machine->command("P100 Coord[1].Q[1] Coord[2].Q[1]");
    CHECK(bench.answers == Answers{"P100=2", "Coord[1].Q[1]=1", "Coord[2].Q[1]=1"});
  }
  ProgramBench bench("a.pmc", kSetUp + text);
  bench.run("start1,2");
  REQUIRE(bench.refusals.size() == 1);
  CHECK(bench.refusals[0].find("start needs the program too") != std::string::npos);
}

TEST_CASE("bits of the status words stand where clients look for them", "[programs]") {
  // public clients: motors 63 TriggerMove ... 40 PhaseFound, 31 Csolve; coordinate systems 47 HomeComplete 46 DesVelZero 45 ClosedLoop
  // 44 AmpEna 43 InPos, 39..32 ErrorStatus, 31 Csolve, 29..28 FeedHold, 17 SegEnabled, 8 LookAheadActive; controller: 7 Default
  ProgramBench bench("a.pmc", kSetUp + "Coord[1].SegMoveTime=5\n");
  bench.run("#1? #3? &1?", until(10));
  bench.machine->command("?");
  bench.machine->command("Coord[1].ErrorStatus=255 &1? &1 define lookahead 100 Coord[1].LHDistance=10 &1?");
  REQUIRE(bench.answers.size() == 6);
  CHECK(bench.answers[0] == "$0000f90080000000");
  CHECK(bench.answers[1] == "$0000f90000000000");   // belongs to no coordinate system
  CHECK(bench.answers[2] == "$0000f80080020000");
  CHECK(bench.answers[3] == "$00000000");
  CHECK(bench.answers[4] == "$0000f8ff80020000");
  CHECK(bench.answers[5] == "$0000f8ff80020100");
  bench.machine->command("$$$***");
  bench.machine->command("? Sys.Default");
  CHECK(bench.answers[6] == "$00000080");
  CHECK(bench.answers[7] == "Sys.Default=1");
}

TEST_CASE("echo leaves out names, definitions' names, signs and hexadecimal digits", "[programs]") {
  ProgramBench bench("a.pmc", kSetUp);
  const std::string questions = "P1 #1-> M5-> # & Motor[1].AdcMask";
  const std::vector<Answers> expected = {
      {"P1=0", "#1->1000x", "M5->*", "#1", "&1", "Motor[1].AdcMask=$fff00000"}, {"0", "#1->1000x", "M5->*", "#1", "&1", "$fff00000"},
      {"P1=0", "1000x", "*", "#1", "&1", "Motor[1].AdcMask=$fff00000"},         {"P1=0", "#1->1000x", "M5->*", "1", "1", "Motor[1].AdcMask=$fff00000"},
      {"P1=0", "#1->1000x", "M5->*", "#1", "&1", "Motor[1].AdcMask=4293918720"}};
  const int modes[] = {0, 1, 2, 4, 8};
  for (std::size_t i = 0; i < expected.size(); ++i) {
    bench.answers.clear();
    bench.machine->command("echo " + std::to_string(modes[i]));
    bench.machine->command(questions);
    INFO("echo " << modes[i]);
    CHECK(bench.answers == expected[i]);
  }
}

TEST_CASE("what backup answers gives the same set-up when it is loaded", "[programs]") {
  const std::string set_up =
      "&2 #3->1000X+5 #4->I\n&1 #1->866.25X-5000.5Y #2->-Y #5->S\nMotor[1].JogSpeed=1/3\nMotor[2].InvAmax=0.1\nMotor[2].InvJmax=50\n"
      "Coord[2].SegMoveTime=0.1+0.2\nM5->u.io:$A0000C.12.1\nM6->Motor[1].ActPos\nMotor[3].pEnc=EncTable[4].a\nSys.WpKey=$AAAAAAAA\nCoord[3].MaxFeedRate=-1e-7\n";
  ProgramBench first("a.pmc", set_up);
  first.run("backup", until(1));
  std::string saved;
  for (const std::string& line : first.answers) saved += line + "\n";
  CHECK(saved.find("Motor[2].InvJmax=50\n") != std::string::npos);   // assigned, if to the default
  ProgramBench second("b.pmc", saved);
  second.run("backup", until(1));
  CHECK(second.refusals.empty());
  CHECK(second.answers == first.answers);
  second.answers.clear();
  second.machine->command("P1=Motor[1].JogSpeed-1/3 P2=Coord[2].SegMoveTime-(0.1+0.2) P1 P2");
  CHECK(second.answers == Answers{"P1=0", "P2=0"});
}

TEST_CASE("backup of a structure answers its defaults too", "[programs]") {
  ProgramBench bench("a.pmc", "M5->u.io:$A0000C.12.1\n");
  bench.run("backup mdefs", until(1));
  CHECK(bench.answers == Answers{"M5->u.io:$A0000C.12.1"});
  bench.answers.clear();
  bench.machine->command("backup Motor[3].");
  CHECK(std::count(bench.answers.begin(), bench.answers.end(), "Motor[3].JogSpeed=32") == 1);
  const std::size_t one = bench.answers.size();
  bench.answers.clear();
  bench.machine->command("backup motor[31]..");
  CHECK(bench.answers.size() == 2 * one);
  bench.machine->command("backup motors");
  bench.machine->command("backup motor[1");
  bench.machine->command("backup motor[33].");
  bench.machine->command("undefine X");
  CHECK(bench.refusals.size() == 4);
}

TEST_CASE("date is the version's, time counts simulated seconds", "[programs]") {
  ProgramBench bench("a.pmc", kSetUp);
  bench.machine->at(62'500, "time");
  bench.run("time", until(62'501));
  CHECK(bench.answers == Answers{"00:00:00", "00:01:02"});
}

TEST_CASE("set-up values without sense are warned of, once a line and text", "[programs]") {
  ProgramBench bench("a.pmc", kSetUp);
  bench.run("Motor[1].MaxSpeed=-5 Coord[1].SegMoveTime=-1 Motor[1].JogSpeed=-3 Coord[1].FeedTime=0 Motor[1].InvAmax=0");
  bench.machine->command("Motor[1].MaxSpeed=-5", "-e");
  REQUIRE(bench.warnings.size() == 4);
  CHECK(bench.warnings[0].find("Motor[1].MaxSpeed is set to -5; it is 0 or more") == 0);
  CHECK(bench.warnings[1].find("Coord[1].SegMoveTime is set to -1") == 0);
  CHECK(bench.warnings[2].find("Motor[1].JogSpeed is set to -3") == 0);
  CHECK(bench.warnings[3].find("Coord[1].FeedTime is set to 0; it is above 0") == 0);
  bench.machine->command("#1j+");
  REQUIRE(bench.refusals.size() == 1);
  CHECK(bench.refusals[0].find("JogSpeed is not above 0") != std::string::npos);
}

TEST_CASE("nan has no sign in messages", "[programs]") {
  ProgramBench bench("a.pmc", kSetUp + "open prog 1\nccr(sqrt(-1))\nclose\n");
  bench.run("&1 b1r");
  REQUIRE(bench.faults.size() == 1);
  CHECK(bench.faults[0].fault.detail.find("ccr is nan;") == 0);
}
