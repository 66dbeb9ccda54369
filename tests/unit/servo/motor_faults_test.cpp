// Overtravel switches, amplifier faults, software position limits with and without lookahead, and who goes on. 1000 mu a millimetre, servo
// period 1 ms, abort ramps of 100 ms.
#include <cmath>

#include "tests/unit/programs/bench.h"

using pmac::runtime::FaultKind;
using pmac::test::ProgramBench;

namespace {

const std::string kSetUp =
    "Sys.ServoPeriod=1\n&1 #1->1000X #2->1000Y\n"
    "Motor[1].JogTa=100 Motor[1].JogTs=0 Motor[1].JogSpeed=10 Motor[1].MaxSpeed=10 Motor[1].AbortTa=100 Motor[2].AbortTa=100\n"
    "Motor[1].InvAmax=0 Motor[1].InvDmax=0 Motor[2].InvAmax=0 Motor[2].InvDmax=0\n"
    "Motor[1].pLimits=Gate3[0].Chan[0].Status.a Motor[1].pAmpFault=Gate3[0].Chan[0].Status.a\n";
const std::string kLine = "open prog 1\nlinear abs ta100 ts0 F10 X20 Y10\nclose\n";   // line 6 is the move
const std::string kLookahead =
    "Coord[1].SegMoveTime=5 Coord[1].LHDistance=60\ndefine lookahead 1000\nMotor[1].MaxSpeed=50 Motor[2].MaxSpeed=50 Motor[1].InvAmax=10 Motor[2].InvAmax=10\n";

pmac::runtime::RunLimits until(double ms) {
  pmac::runtime::RunLimits limits;
  limits.until_ms = ms;
  return limits;
}

double position_mu(const ProgramBench& bench, double time_ms, std::size_t motor = 1) {
  return bench.motor_mu[static_cast<std::size_t>(std::lround(time_ms))][motor];
}

double largest_mu(const ProgramBench& bench, std::size_t motor = 1) {
  double largest = -1e300;
  for (const auto& row : bench.motor_mu) largest = std::max(largest, row[motor]);
  return largest;
}

}  // namespace

TEST_CASE("a program that runs into an overtravel switch is aborted, and the message names motor and line", "[faults]") {
  ProgramBench bench("a.pmc", kSetUp + kLine + "Sim.Motor[1].PlusLimitPos=5000\n");
  bench.machine->at(3000, "Motor[1].PlusLimit Coord[1].LimitStop Coord[1].ProgActive Coord[1].ErrorStatus Motor[1].AmpEna");
  bench.run("&1 b1r");
  REQUIRE(bench.faults.size() == 1);
  CHECK(bench.faults[0].fault.kind == FaultKind::kOvertravel);
  CHECK(bench.faults[0].motor == 1);
  CHECK(bench.faults[0].fault.source.line == 7);
  CHECK(bench.faults[0].fault.detail.find("motor 1") != std::string::npos);
  // 22.36 mm at 10 mm/s: motor 1 at 8.944 mu/ms passes 5000 mu at 50 + 5000 / 8.944 ms; seen at the next interrupt; then 100 ms to rest
  const double seen_ms = std::ceil(50 + 5000 / (20000 / (std::hypot(20, 10) * 100)));
  CHECK(bench.faults[0].time_ms == Approx(seen_ms).margin(1e-9));
  const double v = 10 * 20 / std::hypot(20, 10);
  CHECK(bench.motor(1).final_mu == Approx(v * (seen_ms - 50) + v * 50).epsilon(1e-9));
  CHECK(bench.motor(2).final_mu == Approx(bench.motor(1).final_mu / 2).epsilon(1e-9));
  CHECK(bench.answers == std::vector<std::string>{"Motor[1].PlusLimit=1", "Coord[1].LimitStop=1", "Coord[1].ProgActive=0", "Coord[1].ErrorStatus=0", "Motor[1].AmpEna=1"});
}

TEST_CASE("a motor on its switch may leave it, and not go on", "[faults]") {
  ProgramBench bench("a.pmc", kSetUp + "Sim.Motor[1].PlusLimitPos=5000\n");
  bench.machine->at(2000, "#1j+");
  bench.machine->at(3000, "Motor[1].LimitStop #1j=0");
  bench.machine->at(5000, "Motor[1].PlusLimit Motor[1].LimitStop");
  bench.run("#1j+");
  CHECK(bench.faults.empty());                      // a jog that looks for a switch is no fault
  CHECK(largest_mu(bench) < 5500 + 30);             // 10 mu/ms, 100 ms to rest; and a step into the switch at the second try
  CHECK(bench.motor(1).final_mu == 0);
  CHECK(bench.answers == std::vector<std::string>{"Motor[1].LimitStop=1", "Motor[1].PlusLimit=0", "Motor[1].LimitStop=0"});
}

TEST_CASE("a switch that nothing looks at stops nothing", "[faults]") {
  ProgramBench bench("a.pmc", kSetUp + kLine + "Sim.Motor[1].PlusLimitPos=5000 Motor[1].pLimits=0\n");
  bench.run("&1 b1r");
  CHECK(bench.faults.empty());
  CHECK(bench.motor(1).final_mu == 20000);
}

TEST_CASE("the negative switch, and a program that does not start with both tripped", "[faults]") {
  ProgramBench bench("a.pmc", kSetUp + "open prog 1\nlinear abs ta100 ts0 F10 X-20\nclose\nSim.Motor[1].MinusLimitPos=-3000\n");
  bench.run("&1 b1r");
  REQUIRE(bench.faults.size() == 1);
  CHECK(bench.motor(1).final_mu == Approx(-3500).margin(10));
  bench.machine->command("Sim.Motor[1].PlusLimitPos=-9000");
  bench.run("", until(bench.machine->time_ms() + 10));
  bench.machine->command("&1 r");
  REQUIRE(bench.refusals.size() == 1);
  CHECK(bench.refusals[0].find("error #39") != std::string::npos);
}

TEST_CASE("an amplifier fault kills its motor and aborts the others, or with FaultMode kills all; others go on", "[faults]") {
  for (const bool kills_all : {false, true}) {
    ProgramBench bench("a.pmc", kSetUp + kLine + "&2 #3->1000X\n#4->0\n&1#5->0\nMotor[3].InvAmax=0 Motor[3].InvDmax=0\nopen prog 2\nlinear abs ta100 ts0 F10 X30\nclose\n" +
                                    (kills_all ? "Motor[1].FaultMode=1\n" : "Motor[1].FaultMode=0\n"));
    bench.machine->at(500, "Sim.Motor[1].AmpFault=1");
    bench.machine->at(1000, "Coord[1].AmpFault Motor[1].AmpEna Motor[2].AmpEna Motor[5].AmpEna Motor[4].AmpEna");
    bench.machine->at(1100, "Sim.Motor[1].AmpFault=0 Motor[1].AmpFault");
    bench.machine->at(1200, "&1 enable Motor[1].AmpFault");
    bench.run("&1 b1r &2 b2r");
    REQUIRE(bench.faults.size() == 1);
    CHECK(bench.faults[0].time_ms == 501);
    CHECK(bench.faults[0].fault.kind == FaultKind::kAmplifier);
    CHECK(bench.motor(3).final_mu == Approx(30000));
    const double v = 10 * 10 / std::hypot(20, 10);
    CHECK(bench.motor(1).final_mu == Approx(2 * v * (501 - 50)).epsilon(1e-9));
    CHECK(bench.motor(2).final_mu == Approx(v * (501 - 50) + (kills_all ? 0 : v * 50)).epsilon(1e-9));
    const std::string others = kills_all ? "=0" : "=1";
    CHECK(bench.answers == std::vector<std::string>{"Coord[1].AmpFault=1", "Motor[1].AmpEna=0", "Motor[2].AmpEna" + others, "Motor[5].AmpEna" + others,
                                                    "Motor[4].AmpEna=1", "Motor[1].AmpFault=1", "Motor[1].AmpFault=0"});
  }
}

TEST_CASE("a jog ends at a software limit", "[faults]") {
  ProgramBench bench("a.pmc", kSetUp + "Motor[1].MaxPos=5000 Motor[1].MinPos=-1000\n");
  bench.machine->at(2000, "Motor[1].SoftPlusLimit Motor[1].LimitStop");
  bench.machine->at(2001, "#1j=-30000");
  bench.machine->at(4000, "Motor[1].SoftPlusLimit Motor[1].SoftMinusLimit");
  bench.machine->at(4001, "#1j=0");
  bench.run("#1j+");
  CHECK(bench.faults.empty());
  CHECK(largest_mu(bench) == 5000);
  CHECK(position_mu(bench, 600) == 5000);       // 5000/10 + 100 ms
  CHECK(position_mu(bench, 4000) == -1000);
  CHECK(bench.motor(1).final_mu == 0);
  CHECK(bench.answers == std::vector<std::string>{"Motor[1].SoftPlusLimit=1", "Motor[1].LimitStop=1", "Motor[1].SoftPlusLimit=0", "Motor[1].SoftMinusLimit=1"});
}

TEST_CASE("without lookahead a target beyond a software limit aborts when it is calculated", "[faults]") {
  for (const std::string& moves : {std::string("linear abs ta100 ts0 F10 X2\nX20\n"), std::string("rapid abs X2\nX20\n")}) {
    ProgramBench bench("a.pmc", kSetUp + "Motor[1].MaxPos=5000 Motor[1].MinPos=-1000\nopen prog 1\n" + moves + "close\n");
    bench.machine->at(3000, "Coord[1].ErrorStatus Coord[1].ProgActive");
    bench.run("&1 b1r");
    REQUIRE(bench.faults.size() == 1);
    CHECK(bench.faults[0].fault.kind == FaultKind::kSoftLimit);
    CHECK(bench.faults[0].fault.source.line == 9);
    CHECK(bench.faults[0].fault.detail.find("Motor[1].MaxPos = 5000") != std::string::npos);
    CHECK(largest_mu(bench) <= 2000);
    CHECK(bench.answers == std::vector<std::string>{"Coord[1].ErrorStatus=32", "Coord[1].ProgActive=0"});
  }
}

TEST_CASE("an arc that bulges beyond a software limit is aborted there", "[faults]") {
  ProgramBench bench("a.pmc", kSetUp + "Coord[1].SegMoveTime=5 Motor[1].MaxPos=8000 Motor[1].MinPos=-1000\n"
                                       "open prog 1\nlinear abs ta100 ts0 F10\ncircle2 X0 Y20 I0 J10\nclose\n");
  bench.run("&1 b1r");
  REQUIRE(bench.faults.size() == 1);
  CHECK(bench.faults[0].fault.kind == FaultKind::kSoftLimit);
  CHECK(bench.faults[0].fault.source.line == 9);
  // at x = 8 mm of a radius of 10 mm the motor runs at 6 mu/ms; 100 ms to rest
  CHECK(bench.motor(1).final_mu == Approx(8000 + 300).margin(10));
  CHECK(bench.motor(1).max_accel_mu_ms2 < 0.101);   // the ramp at the start; 0.08 of the abort
}

TEST_CASE("with SoftLimitStopDis the motor waits at its limit while the others go on", "[faults]") {
  ProgramBench bench("a.pmc", kSetUp + "Motor[1].MaxPos=5000 Motor[1].MinPos=-1000 Coord[1].SoftLimitStopDis=1\n"
                                       "open prog 1\nlinear abs ta100 ts0 F10\nX20 Y20\nX0\nrapid X9\nclose\n");
  bench.machine->at(2500, "Motor[1].SoftPlusLimit");
  bench.run("&1 b1r");
  REQUIRE(bench.faults.empty());
  CHECK(largest_mu(bench) == 5000);
  CHECK(largest_mu(bench, 2) == 20000);
  CHECK(bench.motor(1).final_mu == 5000);
  CHECK(bench.answers[0] == "Motor[1].SoftPlusLimit=1");
}

TEST_CASE("inside lookahead the path ends where the motor meets its limit, and the program waits for abort", "[faults]") {
  ProgramBench bench("a.pmc", kSetUp + kLookahead + "Motor[1].MaxPos=12000 Motor[1].MinPos=-1000\n"
                                       "open prog 1\nlinear abs ta0 ts0 F10 X10\nX20 Y5\nX30\nclose\n");
  bench.machine->at(5000, "Coord[1].ErrorStatus Coord[1].ProgActive Coord[1].ProgRunning Motor[1].SoftPlusLimit");
  bench.machine->at(5001, "&1 r");
  bench.machine->at(5002, "&1 a");
  bench.run("&1 b1r");
  REQUIRE(bench.faults.size() == 1);
  CHECK(bench.faults[0].fault.kind == FaultKind::kSoftLimit);
  CHECK(bench.faults[0].fault.source.line == 12);
  CHECK(position_mu(bench, 4000) == Approx(12000).margin(1e-5));
  CHECK(position_mu(bench, 4000, 2) == Approx(1000).margin(0.1));   // on the path: 2 of 10 mm
  CHECK(largest_mu(bench) <= 12000 + 1e-5);
  CHECK(bench.motor(1).max_accel_mu_ms2 <= 0.1001);
  CHECK(bench.answers == std::vector<std::string>{"Coord[1].ErrorStatus=32", "Coord[1].ProgActive=1", "Coord[1].ProgRunning=0", "Motor[1].SoftPlusLimit=1"});
  REQUIRE(bench.refusals.size() == 1);
  CHECK(bench.refusals[0].find("software position limit") != std::string::npos);
}

TEST_CASE("from a software limit the path may be retraced, and forward again", "[faults]") {
  ProgramBench bench("a.pmc", kSetUp + kLookahead + "define lookahead 5000\nMotor[1].MaxPos=12000 Motor[1].MinPos=-1000\nopen prog 1\nlinear abs ta0 ts0 F10 X10\nX20 Y5\nX30\nclose\n");
  bench.machine->at(5000, "&1 <");
  bench.machine->at(6000, "&1 >");
  bench.machine->at(10000, "Coord[1].ProgRunning #1j=0");
  bench.machine->at(10001, "&1 a #1j=0");
  bench.run("&1 b1r");
  CHECK(bench.faults.size() == 1);
  CHECK(position_mu(bench, 4900) == Approx(12000).margin(1e-5));
  CHECK(position_mu(bench, 6000) < 5000);
  CHECK(position_mu(bench, 9900) == Approx(12000).margin(1e-5));
  CHECK(largest_mu(bench) <= 12000 + 1e-5);
  CHECK(bench.motor(1).max_accel_mu_ms2 <= 0.1001);
  CHECK(bench.motor(1).final_mu == 0);
  CHECK(bench.refusals.size() == 1);
}

TEST_CASE("inside lookahead no commanded position passes the limit, wherever it lies on the path", "[faults]") {
  double worst_accel = 0;
  for (double limit_mu = 500; limit_mu < 30000; limit_mu += 1111) {
    const std::string limit = "Motor[1].MinPos=-11000 Motor[2].MinPos=-1 Motor[2].MaxPos=19000 Motor[1].MaxPos=" + std::to_string(limit_mu) + "\n";
    ProgramBench bench("a.pmc", kSetUp + kLookahead + limit +
                                    "open prog 2\nlinear abs ta0 ts0 F20 X20\ncircle2 X20 Y20 I0 J10\nlinear X0\ncircle2 X0 Y0 I0 J-10\nclose\n");
    bench.run("&1 b2r");
    INFO(limit_mu);
    REQUIRE(bench.faults.size() == 1);
    CHECK(largest_mu(bench) <= limit_mu + 1e-5);
    CHECK(largest_mu(bench, 2) <= 19000 + 1e-5);
    const bool first = std::abs(bench.motor(1).final_mu - limit_mu) < 1e-5;
    const bool second = std::abs(bench.motor(2).final_mu - 19000) < 1e-5;
    CHECK((first || second));
    worst_accel = std::max({worst_accel, bench.motor(1).max_accel_mu_ms2, bench.motor(2).max_accel_mu_ms2});
  }
  CHECK(worst_accel <= 0.1001);
}

TEST_CASE("a fault in the middle of a run of samples leaves the other coordinate systems' samples as they would be", "[faults]") {
  const std::string other = "&2 #3->1000X\nMotor[3].InvAmax=0 Motor[3].InvDmax=0\nopen prog 2\nlinear abs ta50 ts20 F13 X7\nX3\nX30\nclose\n";
  ProgramBench alone("a.pmc", kSetUp + other);
  alone.run("&2 b2r");
  ProgramBench bench("a.pmc", kSetUp + kLine + other + "Sim.Motor[1].PlusLimitPos=5000\n");
  bench.run("&1 b1r &2 b2r");
  REQUIRE(bench.faults.size() == 1);
  for (std::size_t k = 0; k < std::min(alone.motor_mu.size(), bench.motor_mu.size()); ++k) REQUIRE(alone.motor_mu[k][3] == bench.motor_mu[k][3]);
  for (std::size_t k = 0; k < bench.time_ms.size(); ++k) REQUIRE(bench.time_ms[k] == static_cast<double>(k));
}

TEST_CASE("the actual position of a motor with a plant is held against the software limits themselves", "[faults]") {
  // Twice the velocity feed-forward: at v the motor is ahead of its command by v (Kvff - Kvfb) / Kp = v (80 - 40) / 4, 89 mu here; more while
  // it brakes.
  const std::string ahead = kSetUp + "Sim.Motor[1].Plant=1 Motor[1].FatalFeLimit=0 Motor[1].Servo.Kvff=80\nMotor[1].MinPos=-10000 Motor[1].MaxPos=10000\n";
  const auto program = [](const char* x) { return "open prog 1\nlinear abs ta100 ts0 F10 X" + std::string(x) + " Y5\nclose\n"; };
  for (const char* x : {"9.95", "-9.95"}) {
    ProgramBench bench("a.pmc", ahead + program(x));
    bench.run("&1 b1r");
    REQUIRE(bench.faults.size() == 1);
    CHECK(bench.faults[0].fault.kind == FaultKind::kSoftLimit);
    CHECK(bench.faults[0].fault.detail.find("the actual position of motor 1") == 0);
    CHECK(bench.faults[0].fault.detail.find(x[0] == '-' ? "Motor[1].MinPos = -10000" : "Motor[1].MaxPos = 10000") != std::string::npos);
    CHECK(std::abs(position_mu(bench, bench.faults[0].time_ms)) < 9950);   // commanded
    bench.machine->command(x[0] == '-' ? "Motor[1].SoftMinusLimit Coord[1].ErrorStatus" : "Motor[1].SoftPlusLimit Coord[1].ErrorStatus");
    CHECK(bench.answers.at(0).back() == '1');
    CHECK(bench.answers.at(1) == "Coord[1].ErrorStatus=32");
  }
  for (const char* x : {"9.7", "-9.7"}) {
    ProgramBench bench("a.pmc", ahead + program(x));
    bench.run("&1 b1r");
    CHECK(bench.faults.empty());
    CHECK(bench.motor(2).final_mu == 5000);
  }
  ProgramBench jog("a.pmc", ahead);
  jog.run("#1j=9950");
  CHECK(jog.faults.empty());
  REQUIRE(jog.warnings.size() == 1);
  CHECK(jog.warnings[0].find("the actual position of motor 1") == 0);
}

TEST_CASE("SoftLimitOffset leaves room for a motor that overshoots", "[faults]") {
  ProgramBench bench("a.pmc", kSetUp + "Sim.Motor[1].Plant=1 Motor[1].FatalFeLimit=0 Motor[1].Servo.Kvff=80\nMotor[1].MinPos=-10000 Motor[1].MaxPos=10000 Motor[1].SoftLimitOffset=400\n");
  bench.run("#1j=20000");
  CHECK(largest_mu(bench) == 9600);
  REQUIRE(bench.warnings.size() == 1);   // the jog ends at the limit of commanded positions
  CHECK(bench.warnings[0].find("ends at Motor[1].MaxPos") != std::string::npos);
}
