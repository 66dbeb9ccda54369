// Home flags with two sides, spindles, null motors, gantries. Servo period 1 ms, jog ramps of 100 ms.
#include <cmath>

#include "tests/unit/programs/bench.h"

using pmac::test::ProgramBench;

namespace {

const std::string kSetUp =
    "Sys.ServoPeriod=1\n&1 #1->1000X #2->1000Y\nMotor[1].JogTa=100 Motor[1].JogTs=0 Motor[1].HomeVel=10 Motor[1].JogSpeed=10 Motor[1].AbortTa=100\n"
    "Motor[2].JogTa=100 Motor[2].JogTs=0 Motor[2].JogSpeed=10\n";

pmac::runtime::RunLimits until(double ms) {
  pmac::runtime::RunLimits limits;
  limits.until_ms = ms;
  return limits;
}

double position_mu(const ProgramBench& bench, double time_ms, std::size_t motor = 1) {
  return bench.motor_mu[static_cast<std::size_t>(std::lround(time_ms))][motor];
}

double number(const std::string& answer) { return std::stod(answer.substr(answer.find('=') + 1)); }

/// Raw place of home after a search with this plant and speed.
double home_of(const std::string& plant, const std::string& speed = "10") {
  ProgramBench bench("a.pmc", kSetUp + plant + "\nMotor[1].HomeVel=" + speed + "\n");
  bench.machine->at(8000, "Motor[1].HomePos Motor[1].HomeComplete");
  bench.run("#1hm", until(8010));
  REQUIRE(bench.refusals.empty());
  REQUIRE(bench.answers.size() == 2);
  CHECK(bench.answers[1] == "Motor[1].HomeComplete=1");
  CHECK(bench.motor(1).final_mu == 0);
  return number(bench.answers[0]);
}

}  // namespace

TEST_CASE("the flag is found at its edge, from either side", "[home]") {
  CHECK(home_of("Sim.Motor[1].FlagPos=3000 Sim.Motor[1].FlagEnd=4000") == 3000);
  CHECK(home_of("Sim.Motor[1].FlagPos=-4000 Sim.Motor[1].FlagEnd=-3000", "-10") == -3000);
  CHECK(home_of("Sim.Motor[1].FlagPos=3000") == 3000);
}

TEST_CASE("a flag that is there already is home at once, where the motor is when the search begins", "[home]") {
  ProgramBench bench("a.pmc", kSetUp + "Sim.Motor[1].FlagPos=-1000 Sim.Motor[1].FlagEnd=5000\n");
  bench.machine->at(1000, "#1j=2000");
  bench.machine->at(2000, "#1hm");
  bench.machine->at(3000, "Motor[1].HomePos");
  bench.run("P1=0");
  CHECK(number(bench.answers[0]) == 2000);
}

TEST_CASE("an inverted flag is found where it goes off", "[home]") {
  CHECK(home_of("Sim.Motor[1].FlagPos=-1000 Sim.Motor[1].FlagEnd=4000 Sim.Motor[1].FlagInvert=1") == 4000);
  CHECK(home_of("Sim.Motor[1].FlagPos=-1000 Sim.Motor[1].FlagEnd=4000 Sim.Motor[1].FlagInvert=1", "-10") == -1000);
  CHECK(home_of("Sim.Motor[1].FlagPos=1000 Sim.Motor[1].FlagEnd=4000 Sim.Motor[1].FlagInvert=1") == 0);   // off at the start
}

TEST_CASE("a motor on the edge that goes on into an inverted flag finds the other one", "[home]") {
  CHECK(home_of("Sim.Motor[1].FlagPos=0 Sim.Motor[1].FlagEnd=4000 Sim.Motor[1].FlagInvert=1") == 4000);
  CHECK(home_of("Sim.Motor[1].FlagPos=0 Sim.Motor[1].FlagEnd=4000 Sim.Motor[1].FlagInvert=1", "-10") == 0);
}

TEST_CASE("with a plant the flag is found by the actual position", "[home]") {
  const std::string plant = " Sim.Motor[1].Plant=1 Sim.Motor[1].AccelGain=0.0025 Motor[1].Servo.Kp=1 Motor[1].Servo.Kvfb=40 Motor[1].Servo.Kvff=0 Motor[1].Servo.Ki=0";
  CHECK(home_of("Sim.Motor[1].FlagPos=3000 Sim.Motor[1].FlagEnd=4000" + plant) == 3000);
  CHECK(home_of("Sim.Motor[1].FlagPos=-1000 Sim.Motor[1].FlagEnd=4000 Sim.Motor[1].FlagInvert=1" + plant, "-10") == -1000);
}

TEST_CASE("a search that meets a limit before its flag stops there, and is not complete", "[home]") {
  ProgramBench bench("a.pmc", kSetUp + "Sim.Motor[1].FlagPos=9000 Sim.Motor[1].PlusLimitPos=5000 Motor[1].pLimits=Gate3[0].Chan[0].Status.a\n");
  bench.machine->at(3000, "Motor[1].HomeInProgress Motor[1].HomeComplete Motor[1].LimitStop");
  bench.machine->at(3001, "Motor[1].HomeVel=-10 Sim.Motor[1].FlagPos=-500 Sim.Motor[1].FlagEnd=0");
  bench.machine->at(3002, "#1hm");
  bench.machine->at(6000, "Motor[1].HomePos");
  bench.run("#1hm");
  CHECK(bench.faults.empty());
  CHECK(position_mu(bench, 2999) == Approx(5500).margin(10));
  CHECK(std::vector<std::string>(bench.answers.begin(), bench.answers.begin() + 3) ==
        std::vector<std::string>{"Motor[1].HomeInProgress=0", "Motor[1].HomeComplete=0", "Motor[1].LimitStop=1"});
  CHECK(number(bench.answers[3]) == 0);
}

TEST_CASE("HomePos that is written renames the position, and the motor stands", "[home]") {
  ProgramBench bench("a.pmc", kSetUp + "open prog 1\nlinear abs ta0 ts0 F10 X1\nclose\nMotor[1].InvAmax=0 Motor[1].InvDmax=0\n");
  bench.machine->at(1000, "#1j=500");
  bench.machine->at(2000, "Motor[1].HomePos=300 Motor[1].ActPos #1p");
  bench.machine->at(2100, "&1 b1r");
  bench.machine->at(3000, "Motor[1].ActPos");
  bench.run("P1=0");
  CHECK(bench.answers == std::vector<std::string>{"Motor[1].ActPos=500", "200", "Motor[1].ActPos=1300"});
}

TEST_CASE("a spindle turns while a program executes, and the program does not wait for it", "[axes]") {
  ProgramBench bench("a.pmc", kSetUp + "#2->0\n#2->S\nMotor[1].InvAmax=0 Motor[1].InvDmax=0\n"
                                       "open prog 1\nlinear abs ta0 ts0 F10 X1\ndwell 100\nrapid X2\nlinear X3\nclose\n");
  bench.machine->at(10, "&1 b1r");
  bench.machine->at(20, "#2j-");
  bench.machine->at(2000, "#2j/ #2->");
  bench.run("#2j+");
  CHECK(bench.refusals.empty());
  CHECK(bench.faults.empty());
  CHECK(bench.answers == std::vector<std::string>{"#2->s"});
  CHECK(bench.motor(1).final_mu == 3000);
  CHECK(bench.moves.size() == 5);     // four of the program, and the spindle's jog
  CHECK(position_mu(bench, 1900, 2) < -15000);
}

TEST_CASE("a spindle's time base is that of its definition", "[axes]") {
  for (const auto& [definition, share] : std::vector<std::pair<std::string, double>>{{"S", 0.5}, {"S0", 0.25}, {"S1", 1.0}}) {
    ProgramBench bench("a.pmc", kSetUp + "#2->0\n#2->" + definition + "\nCoord[1].TimeBaseSlew=1000 Coord[0].TimeBaseSlew=1000 Coord[1].DesTimeBase=0.5 Coord[0].DesTimeBase=0.25\n");
    bench.machine->at(10, "#2j+");
    bench.run("P1=0", until(3010));
    INFO(definition);
    CHECK(position_mu(bench, 3000, 2) - position_mu(bench, 2000, 2) == Approx(10000 * share).epsilon(1e-9));
  }
}

TEST_CASE("a null motor has no axis, and shares time base and abort", "[axes]") {
  ProgramBench bench("a.pmc", kSetUp + "#2->0\nCoord[1].TimeBaseSlew=1000 Coord[1].DesTimeBase=0.5\n");
  bench.machine->at(10, "#2j+");
  bench.machine->at(2010, "&1 a");
  bench.run("P1=0", until(4000));
  CHECK(position_mu(bench, 2000, 2) - position_mu(bench, 1000, 2) == Approx(5000).epsilon(1e-9));
  CHECK(position_mu(bench, 3900, 2) == position_mu(bench, 3000, 2));
}

TEST_CASE("both motors of a gantry follow the axis, and a fault of one stops both", "[axes]") {
  ProgramBench bench("a.pmc", "Sys.ServoPeriod=1\n&1 #1->1000X #2->1000X+50\nMotor[1].InvAmax=0 Motor[1].InvDmax=0 Motor[2].InvAmax=0 Motor[2].InvDmax=0\n"
                              "Motor[1].AbortTa=100 Motor[2].AbortTa=100 Motor[2].pAmpFault=Gate3[0].Chan[0].Status.a\n"
                              "open prog 1\nlinear abs ta100 ts0 F10 X10\nclose\n");
  bench.machine->at(500, "Sim.Motor[2].AmpFault=1");
  bench.machine->at(100, "&1 b1r");
  bench.run("#2j=50");
  REQUIRE(bench.faults.size() == 1);
  CHECK(bench.faults[0].motor == 2);
  for (std::size_t k = 300; k < 500; ++k) REQUIRE(bench.motor_mu[k][2] - bench.motor_mu[k][1] == Approx(50).margin(1e-9));
  CHECK(bench.motor_mu.back()[1] - bench.motor_mu.back()[2] == Approx(500 - 50).margin(1e-6));   // the sound one needs 100 ms at 10 mu/ms to rest
}
