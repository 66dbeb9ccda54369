// Home searches, moves until a trigger, moves from PLC programs, killing and enabling, against closed forms. The servo period is 1 ms; jog
// ramps last 100 ms whatever the change of speed.
#include <cmath>

#include "tests/unit/programs/bench.h"

using pmac::test::ProgramBench;

namespace {

const std::string kSetUp =
    "Sys.ServoPeriod=1\n&1 #1->1000X #2->1000Y\n"
    "Motor[1].JogTa=100 Motor[1].JogTs=0 Motor[1].HomeVel=10 Motor[2].JogTa=100 Motor[2].JogTs=0 Motor[2].HomeVel=-10\n"
    "Motor[1].InvAmax=0 Motor[1].InvDmax=0 Motor[1].AbortTa=100 Motor[2].AbortTa=100\n";
const std::string kTriggers = "Sim.Motor[1].TriggerPos=5000 Sim.Motor[2].TriggerPos=-2000\n";

double position_mu(const ProgramBench& bench, double time_ms, std::size_t motor = 1) {
  return bench.motor_mu[static_cast<std::size_t>(std::lround(time_ms))][motor];
}

pmac::runtime::RunLimits until(double ms) {
  pmac::runtime::RunLimits limits;
  limits.until_ms = ms;
  return limits;
}

std::string raw_position(int motor) { return "Motor[" + std::to_string(motor) + "].ActPos"; }

}  // namespace

TEST_CASE("a home search passes the trigger, slows down and comes back to it", "[programs]") {
  ProgramBench bench("a.pmc", kSetUp + kTriggers);
  const std::string status = "Motor[1].HomeInProgress Motor[1].TriggerMove Motor[1].HomeComplete";
  bench.machine->at(500, status);
  bench.machine->at(600, status);
  bench.machine->at(900, status + " Motor[1].HomePos");
  bench.run("#1hm");
  REQUIRE(bench.refusals.empty());
  // 500 mu while it speeds up, then 10 mu/ms: the trigger at 100 + 450 ms. Two ramps of 100 ms from 10 over -5 to 0 end where they began.
  CHECK(position_mu(bench, 550) == Approx(5000).margin(1e-9));
  CHECK(position_mu(bench, 650) == Approx(5250).margin(1e-9));
  CHECK(position_mu(bench, 749) == Approx(5000 + 0.5 * 0.05).margin(1e-9));
  CHECK(bench.motor(1).final_mu == 0);
  REQUIRE(bench.moves.size() == 1);
  CHECK(bench.moves[0].mode == "home");
  CHECK(bench.moves[0].motor == 1);
  CHECK(bench.moves[0].end_ms == Approx(750).margin(1e-9));
  CHECK(bench.moves[0].length == Approx(5000).margin(1e-9));
  CHECK(bench.answers == std::vector<std::string>{"Motor[1].HomeInProgress=1", "Motor[1].TriggerMove=1", "Motor[1].HomeComplete=0",
                                                  "Motor[1].HomeInProgress=1", "Motor[1].TriggerMove=0", "Motor[1].HomeComplete=0",
                                                  "Motor[1].HomeInProgress=0", "Motor[1].TriggerMove=0", "Motor[1].HomeComplete=1",
                                                  "Motor[1].HomePos=5000"});
}

TEST_CASE("home is HomeOffset from the trigger", "[programs]") {
  ProgramBench bench("a.pmc", kSetUp + kTriggers + "Motor[1].HomeOffset=-1000\n");
  bench.machine->at(2000, raw_position(1));
  bench.run("#1hm");
  REQUIRE(bench.moves.size() == 1);
  // from 10 over -10: 500 - 500 mu on the ramps to 0 and -10, -500 cruising, -500 to rest
  CHECK(bench.moves[0].end_ms == Approx(550 + 100 + 50 + 100).margin(1e-9));
  CHECK(bench.motor(1).final_mu == 0);
  CHECK(bench.answers == std::vector<std::string>{"Motor[1].ActPos=4000"});
}

TEST_CASE("a motion program waits for its home searches; those of a list go together", "[programs]") {
  ProgramBench bench("a.pmc", kSetUp + kTriggers + "open prog 1\nlinear abs ta0 ts0 F10\nhome1..2\nP1=Sys.Time\nX1\nclose\n");
  bench.machine->at(3000, "P1");
  bench.run("&1 b1r");
  REQUIRE(bench.faults.empty());
  // motor 2: 500 mu while it speeds up, 150 ms at -10, 200 ms to come back
  CHECK(bench.moves[0].end_ms == Approx(450).margin(1e-9));
  CHECK(bench.moves[1].end_ms == Approx(750).margin(1e-9));
  CHECK(bench.moves[1].start_ms == 0);
  CHECK(bench.moves[2].start_ms == Approx(750).margin(1e-9));
  CHECK(bench.motor(1).final_mu == 1000);   // from the new home
  CHECK(bench.motor(2).final_mu == 0);
  CHECK(std::stod(bench.answers[0].substr(3)) == Approx(0.75).margin(1e-9));
}

TEST_CASE("a PLC program starts a home search and does not wait", "[programs]") {
  ProgramBench bench("a.pmc", kSetUp + kTriggers + "open plc 1\nhome1\nP1=Motor[1].HomeInProgress\ndisable plc 1\nclose\n");
  bench.machine->at(2000, "P1");
  bench.run("enable plc 1");
  REQUIRE(bench.faults.empty());
  CHECK(bench.answers[0] == "P1=1");
  CHECK(bench.moves[0].mode == "home");
}

TEST_CASE("a home search without a trigger is refused, one away from it goes on", "[programs]") {
  ProgramBench bench("a.pmc", kSetUp);
  bench.run("#1hm", until(10));
  REQUIRE(bench.refusals.size() == 1);
  CHECK(bench.refusals[0].find("Sim.Motor[1].TriggerPos") != std::string::npos);
  ProgramBench away("a.pmc", kSetUp + "Sim.Motor[1].TriggerPos=-100\n");
  away.machine->at(1000, "#1j/");
  away.machine->at(1500, "Motor[1].HomeInProgress Motor[1].HomeComplete");
  away.run("#1hm");
  CHECK(away.motor(1).final_mu == Approx(500 + 9000 + 500));
  CHECK(away.answers == std::vector<std::string>{"Motor[1].HomeInProgress=0", "Motor[1].HomeComplete=0"});
}

TEST_CASE("a rapid move until a trigger ends at its distance from it, and the next moves start there", "[programs]") {
  const std::string program = "open prog 1\nrapid abs X50^-5\nP1=Motor[1].TriggerNotFound\nlinear inc ta0 ts0 F10 X1\nclose\n";
  ProgramBench bench("a.pmc", kSetUp + "Sim.Motor[1].TriggerPos=20000\n" + program);
  bench.machine->at(9000, "P1");
  bench.run("&1 b1r");
  REQUIRE(bench.faults.empty());
  CHECK(position_mu(bench, 675) == Approx(20000).margin(1e-9));   // 1600 mu in 100 ms, then 32 mu/ms
  CHECK(bench.motor(1).final_mu == 16000);
  CHECK(bench.answers[0] == "P1=0");
  ProgramBench none("a.pmc", kSetUp + program);
  none.machine->at(9000, "P1");
  none.run("&1 b1r");
  CHECK(none.motor(1).final_mu == 51000);
  CHECK(none.answers[0] == "P1=1");
}

TEST_CASE("jogs until a trigger", "[programs]") {
  ProgramBench bench("a.pmc", kSetUp + kTriggers + "Motor[1].ProgJogPos=8000\nopen plc 1\njog1^*^-200\ndisable plc 1\nclose\n");
  bench.run("enable plc 1");
  CHECK(bench.motor(1).final_mu == 4800);
  ProgramBench online("a.pmc", kSetUp + kTriggers);
  online.run("#1j:20000^10");
  REQUIRE(online.refusals.empty());
  CHECK(online.motor(1).final_mu == 5010);
  ProgramBench short_of_it("a.pmc", kSetUp + kTriggers);
  short_of_it.machine->at(3000, "Motor[1].TriggerNotFound");
  short_of_it.run("#1j:2000^10");
  CHECK(short_of_it.motor(1).final_mu == 2000);
  CHECK(short_of_it.answers[0] == "Motor[1].TriggerNotFound=1");
}

TEST_CASE("the trigger of a motor that slows down on an S-curve is caught where it lies", "[programs]") {
  ProgramBench bench("a.pmc", kSetUp + "Motor[1].JogTa=-10 Motor[1].JogTs=-50\nSim.Motor[1].TriggerPos=1234.5\n");
  bench.run("#1j:2000^0");
  CHECK(bench.motor(1).final_mu == 1234.5);
}

TEST_CASE("axis moves of a PLC program are rapid and are not waited for", "[programs]") {
  ProgramBench bench("a.pmc", kSetUp + "Motor[1].MaxSpeed=10\nopen plc 1\nLdata.Coord=1\npmatch\nlinear abs X5\nP1=Motor[1].DesVelZero\ndisable plc 1\nclose\n");
  bench.machine->at(3000, "P1");
  bench.run("enable plc 1");
  REQUIRE(bench.faults.empty());
  REQUIRE(bench.moves.size() == 1);
  CHECK(bench.moves[0].mode == "rapid");
  CHECK(bench.moves[0].end_ms - bench.moves[0].start_ms == Approx(600).margin(1e-9));   // 5000/10 + 100
  CHECK(bench.answers[0] == "P1=0");
  CHECK(bench.motor(1).final_mu == 5000);
}

TEST_CASE("a PLC program changes the target of its rapid move in mid-move", "[programs]") {
  ProgramBench bench("a.pmc", kSetUp + "Motor[1].MaxSpeed=10\nopen plc 1\nLdata.Coord=1\n"
                                       "if (P1 == 0) { pmatch abs X5 P1=1 }\nif (P1 == 1 && Sys.Time >= 0.3) { X1 P1=2 disable plc 1 }\nclose\n");
  bench.run("enable plc 1");
  REQUIRE(bench.faults.empty());
  REQUIRE(bench.moves.size() == 2);
  CHECK(bench.moves[1].start_ms == Approx(300).margin(1.1));
  CHECK(bench.moves[0].end_ms == bench.moves[1].start_ms);
  CHECK(bench.motor(1).final_mu == 1000);
  CHECK(bench.motor(1).max_accel_mu_ms2 <= 0.2 + 1e-9);   // 10 to -10 in 100 ms; no jump
}

TEST_CASE("dwell and delay do not make a PLC program wait", "[programs]") {
  ProgramBench bench("a.pmc", kSetUp + "open plc 1\ndwell 1000\ndelay 1000\nP1=Sys.Time\ndisable plc 1\nclose\n");
  bench.run("enable plc 1", until(100));
  REQUIRE(bench.faults.empty());
  bench.run("P1", until(200));
  CHECK(std::stod(bench.answers[0].substr(3)) < 0.01);
}

TEST_CASE("with RapidVelCtrl motors arrive together, without each as fast as it can", "[programs]") {
  const std::string program = "open prog 1\nrapid abs X10 Y5\nclose\n";
  for (const bool together : {false, true}) {
    ProgramBench bench("a.pmc", kSetUp + "Motor[1].MaxSpeed=10 Motor[2].MaxSpeed=10 Coord[1].RapidVelCtrl=" + (together ? "1\n" : "0\n") + program);
    bench.run("&1 b1r");
    CHECK(position_mu(bench, 550, 1) == Approx(5000).margin(1e-9));
    CHECK(position_mu(bench, 550, 2) == Approx(together ? 2500 : 4875).margin(1e-9));
  }
}

TEST_CASE("RapidSpeedSel 0 is the jog speed", "[programs]") {
  ProgramBench bench("a.pmc", kSetUp + "Motor[1].JogSpeed=5 Motor[1].RapidSpeedSel=0\nopen prog 1\nrapid abs X10\nclose\n");
  bench.run("&1 b1r");
  CHECK(bench.moves[0].end_ms == Approx(2100).margin(1e-9));
}

TEST_CASE("disable kills at once, ddisable after the brakes, adisable at rest", "[programs]") {
  const std::string program = "Motor[1].BrakeOnDelay=30\nopen prog 1\nlinear abs ta0 ts0 F10 X10\nclose\n";
  const std::string loop = "Motor[1].ClosedLoop";
  for (const std::string verb : {"disable", "ddisable", "adisable"}) {
    INFO(verb);
    ProgramBench bench("a.pmc", kSetUp + program);
    bench.machine->at(200, "&1 " + verb);
    for (const double t : {210.0, 250.0, 310.0, 340.0}) bench.machine->at(t, loop);
    bench.machine->at(400, "&1 r");
    bench.machine->at(410, "&1 enable");
    bench.machine->at(420, "Motor[1].ClosedLoop");
    bench.run("&1 b1r");
    std::string bits;
    for (const std::string& answer : bench.answers) bits += answer.back();
    CHECK(bits == (verb == "disable" ? "00001" : verb == "ddisable" ? "10001" : "11101"));
    REQUIRE(bench.refusals.size() == 1);
    CHECK(bench.refusals[0].find("error #43") != std::string::npos);
    CHECK(bench.motor(1).final_mu == Approx(verb == "disable" ? 2000 : verb == "ddisable" ? 2000 + 10 * 30 - 0.05 * 900 : 2500));
  }
}

TEST_CASE("motors that are not active, not phased or open loop keep a program from starting", "[programs]") {
  ProgramBench bench("a.pmc", kSetUp + "open prog 1\nX1\nclose\n");
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"Motor[1].ServoCtrl=0", "error #45"}, {"Motor[1].ServoCtrl=1 Motor[1].PhaseFound=0", "error #44"}, {"#1$ #1k", "error #43"}, {"#1out0", "error #43"}};
  for (const auto& [command, number] : cases) {
    bench.machine->command(command);
    bench.refusals.clear();
    bench.machine->command("&1 b1r");
    INFO(command);
    REQUIRE(bench.refusals.size() == 1);
    CHECK(bench.refusals[0].find(number) != std::string::npos);
  }
  bench.refusals.clear();
  bench.run("#1j/ &1 r");
  CHECK(bench.refusals.empty());
  CHECK(bench.motor(1).final_mu == 1000);
}

TEST_CASE("a motion program that kills its motor at rest goes on to its next move, which is a fault", "[programs]") {
  ProgramBench bench("a.pmc", kSetUp + "open prog 1\nlinear abs ta0 ts0 F10 X1\ndwell 0\nkill1,2\nP1=1\nX2\nclose\n");
  bench.machine->at(500, "Coord[1].ProgActive Motor[1].AmpEna Motor[2].AmpEna P1");
  bench.run("&1 b1r");
  REQUIRE(bench.faults.size() == 1);
  CHECK(bench.faults[0].fault.detail.find("error #43: MOTOR NOT CLOSED LOOP: motor 1") == 0);
  CHECK(bench.motor(1).final_mu == 1000);
  CHECK(bench.answers == std::vector<std::string>{"Coord[1].ProgActive=0", "Motor[1].AmpEna=0", "Motor[2].AmpEna=0", "P1=1"});
}

TEST_CASE("a step of a PLC program is one scan", "[programs]") {
  ProgramBench bench("a.pmc", kSetUp + "open plc 1\nP1=P1+1\nclose\n");
  bench.machine->at(100, "enable plc 1 pause plc 1 P1=0");
  bench.machine->at(200, "step plc 1");
  bench.machine->at(300, "P1");
  bench.run("P2=0", until(400));
  REQUIRE(bench.refusals.empty());
  CHECK(bench.answers == std::vector<std::string>{"P1=1"});
}

TEST_CASE("status words", "[programs]") {
  ProgramBench bench("a.pmc", kSetUp);
  bench.run("#1?", until(10));
  CHECK(bench.answers == std::vector<std::string>{"$0000f90080000000"});   // HomeComplete DesVelZero ClosedLoop AmpEna InPos PhaseFound
}
