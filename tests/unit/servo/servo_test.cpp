// The servo loop and its mass, against closed forms: second-order response, lag on ramps, and what programs see of it.
#include <cmath>
#include <numbers>

#include "runtime/servo/servo_loop.h"
#include "tests/unit/programs/bench.h"

using pmac::runtime::ServoGains;
using pmac::runtime::ServoLoop;
using pmac::runtime::ServoPlant;
using pmac::test::ProgramBench;

namespace {

/// 0.01 rad/ms whatever the servo period: gain * Kp = omega^2; damping 2 zeta / omega in ms, which Kvfb counts in cycles.
constexpr double kOmega = 0.01, kZeta = 0.5;

ServoGains gains_of_second_order(double period_ms) {
  ServoGains g;
  g.kp = 2;
  g.kvfb = 2 * kZeta / kOmega / period_ms;
  g.kvff = g.ki = 0;
  return g;
}

const ServoPlant kMass{kOmega * kOmega / 2, 0};

/// Step response of omega^2 / (s^2 + 2 zeta omega s + omega^2).
double step_response(double t) {
  const double damped = kOmega * std::sqrt(1 - kZeta * kZeta);
  return 1 - std::exp(-kZeta * kOmega * t) * (std::cos(damped * t) + kZeta / std::sqrt(1 - kZeta * kZeta) * std::sin(damped * t));
}

/// Largest difference from the closed form over 1.5 s, and the largest value.
std::pair<double, double> step_error(double period_ms) {
  ServoLoop loop;
  loop.start(0, 0, period_ms);
  double worst = 0, peak = 0;
  for (int k = 0; k * period_ms < 1500; ++k) {
    loop.step(1000, true, gains_of_second_order(period_ms), kMass, period_ms);
    worst = std::max(worst, std::abs(loop.position_mu() - 1000 * step_response(k * period_ms)));
    peak = std::max(peak, loop.position_mu());
  }
  return {worst, peak};
}

/// Error after `cycles` of a commanded motion.
template <class Position>
double lag_mu(const ServoGains& gains, const ServoPlant& plant, int cycles, Position position, double period_ms = 1) {
  ServoLoop loop;
  loop.start(0, 0, period_ms);
  for (int k = 0; k <= cycles; ++k) loop.step(position(k), true, gains, plant, period_ms);
  return loop.error_mu();
}

const std::string kSetUp =
    "Sys.ServoPeriod=1\n&1 #1->1000X #2->1000Y\n"
    "Motor[1].JogTa=100 Motor[1].JogTs=0 Motor[1].JogSpeed=10 Motor[1].AbortTa=100 Motor[2].AbortTa=100\n"
    "Motor[1].InvAmax=0 Motor[1].InvDmax=0 Motor[2].InvAmax=0 Motor[2].InvDmax=0\n"
    "Sim.Motor[1].Plant=1 Sim.Motor[1].AccelGain=0.0025 Motor[1].Servo.Kp=1 Motor[1].Servo.Ki=0 Motor[1].Servo.Kvfb=40\n";

pmac::runtime::RunLimits until(double ms) {
  pmac::runtime::RunLimits limits;
  limits.until_ms = ms;
  return limits;
}

double number(const std::string& answer) { return std::stod(answer.substr(answer.find('=') + 1)); }

}  // namespace

TEST_CASE("the servo's step response is that of a second-order system, the nearer the shorter its period", "[servo]") {
  const auto [slow, slow_peak] = step_error(1);
  const auto [fast, fast_peak] = step_error(0.25);
  CHECK(slow < 15);                      // 1.5 % of the step at omega * period = 0.01
  CHECK(fast < slow / 3.5);              // first order in the period
  const double overshoot = std::exp(-std::numbers::pi * kZeta / std::sqrt(1 - kZeta * kZeta));
  CHECK(fast_peak == Approx(1000 * (1 + overshoot)).epsilon(0.005));
}

TEST_CASE("lag on a ramp: velocity feedback against feed forward, friction, integrator", "[servo]") {
  ServoGains g;
  g.kp = 1;
  g.kvfb = 40;
  g.kvff = 15;
  g.ki = 0;
  const ServoPlant mass{0.0025, 0};
  const auto ramp = [](int k) { return 3.0 * k; };
  CHECK(lag_mu(g, mass, 3000, ramp) == Approx((40 - 15) * 3).epsilon(1e-9));
  // friction b needs the output b v / gain
  const ServoPlant with_friction{0.0025, 0.01};
  CHECK(lag_mu(g, with_friction, 3000, ramp) == Approx((40 - 15) * 3 + 0.01 * 3 / 0.0025).epsilon(1e-9));
  g.ki = 1e-3;
  CHECK(lag_mu(g, with_friction, 60000, ramp) == Approx(0).margin(1e-6));
  g.integrates_at_rest_only = true;
  CHECK(lag_mu(g, with_friction, 3000, ramp) == Approx((40 - 15) * 3 + 0.01 * 3 / 0.0025).epsilon(1e-9));
}

TEST_CASE("lag under acceleration is what the mass needs, and nothing with its feed forward", "[servo]") {
  ServoGains g;
  g.kp = 1;
  g.ki = 0;
  g.kvfb = g.kvff = 40;
  const ServoPlant mass{0.0025, 0};
  const auto parabola = [](int k) { return 0.005 * k * k; };   // 0.01 mu a cycle^2
  CHECK(lag_mu(g, mass, 3000, parabola) == Approx(0.01 / 0.0025).epsilon(1e-6));
  g.kaff = 1 / 0.0025;
  CHECK(lag_mu(g, mass, 3000, parabola) == Approx(0).margin(1e-6));
}

TEST_CASE("the output is limited, so that a loop with absurd gains stays finite", "[servo]") {
  ServoGains g;
  g.kp = 1e6;
  g.max_output = 100;
  const ServoPlant mass{0.0025, 0};
  ServoLoop loop;
  loop.start(0, 0, 1);
  for (int k = 0; k < 100'000; ++k) {
    loop.step(k % 2 * 1e6, true, g, mass, 1);
    REQUIRE(std::isfinite(loop.position_mu()));
    REQUIRE(std::abs(loop.output()) <= 100);
  }
  CHECK(std::abs(loop.position_mu()) <= 0.5 * 0.25 * 1e10);   // no further than the full output all the time
}

TEST_CASE("friction brings a free mass to rest where the closed form says", "[servo]") {
  ServoLoop loop;
  loop.start(100, 8, 1);
  for (int k = 0; k < 5000; ++k) loop.step(0, false, {}, {0.0025, 0.02}, 1);
  CHECK(loop.position_mu() == Approx(100 + 8 + 8 / 0.02).epsilon(1e-9));   // one cycle before friction is looked at, then v / b
}

TEST_CASE("programs and commands see the lag of a motor with a plant", "[servo]") {
  ProgramBench bench("a.pmc", kSetUp + "Motor[1].Servo.Kvff=0\n");
  for (const char* question : {"Motor[1].PosError", "#1f", "Motor[1].ActVel", "Motor[1].DesPos", "Motor[1].ActPos", "&1f", "#1p", "#1d"}) bench.machine->at(1500, question);
  bench.run("#1j+", until(1600));
  REQUIRE(bench.answers.size() == 8);
  CHECK(number(bench.answers[0]) == Approx(400).epsilon(1e-9));     // Kvfb * 10 mu a cycle
  CHECK(std::stod(bench.answers[1]) == Approx(400).epsilon(1e-9));
  CHECK(number(bench.answers[2]) == Approx(10).epsilon(1e-9));
  CHECK(number(bench.answers[3]) == Approx(14500).epsilon(1e-12));
  CHECK(number(bench.answers[4]) == Approx(14100).epsilon(1e-9));
  CHECK(std::stod(bench.answers[5].substr(1)) == Approx(0.4).epsilon(1e-9));
  CHECK(std::stod(bench.answers[6]) == Approx(14100).epsilon(1e-9));
  CHECK(std::stod(bench.answers[7]) == Approx(14500).epsilon(1e-12));
}

TEST_CASE("j^ counts from the actual position, j: from the commanded one", "[servo]") {
  for (const auto& [jog, end_mu] : std::vector<std::pair<std::string, double>>{{"#1j^1000", 14500 - 400 + 1000}, {"#1j:1000", 14500 + 1000}}) {
    ProgramBench bench("a.pmc", kSetUp + "Motor[1].Servo.Kvff=0\n");
    bench.machine->at(1500, jog);
    bench.run("#1j+");
    CHECK(bench.motor(1).final_mu == Approx(end_mu).epsilon(1e-9));
  }
}

TEST_CASE("a motor without a plant is where it is commanded to be", "[servo]") {
  ProgramBench bench("a.pmc", kSetUp + "Sim.Motor[1].Plant=0\n");
  bench.machine->at(500, "Motor[1].PosError Motor[1].FeWarn #1f");
  bench.run("#1j+", until(600));
  CHECK(bench.answers == std::vector<std::string>{"Motor[1].PosError=0", "Motor[1].FeWarn=0", "0"});
}

TEST_CASE("following error: a warning is a status, the fatal limit kills the motor and ends the program", "[servo]") {
  ProgramBench bench("a.pmc", kSetUp + "Motor[1].Servo.Kvff=0 Motor[1].WarnFeLimit=300 Motor[1].FatalFeLimit=500\n"
                                       "&2 #3->1000X\nopen prog 1\nlinear abs ta100 ts0 F10 X20 Y20\nF20\nX80 Y80\nclose\nopen prog 2\nlinear abs ta100 ts0 F10 X30\nclose\n"
                                       "Motor[3].InvAmax=0 Motor[3].InvDmax=0\n");
  const std::string status = "Motor[1].FeWarn Coord[1].FeFatal Coord[1].ProgActive Motor[1].AmpEna Motor[2].AmpEna";
  bench.machine->at(1500, status);   // 10/sqrt(2) mu a cycle: 283 mu
  bench.machine->at(5000, status + " Motor[1].ClosedLoop");
  bench.run("&1 b1r &2 b2r");
  REQUIRE(bench.faults.size() == 1);
  const auto& fault = bench.faults[0];
  CHECK(fault.motor == 1);
  CHECK(fault.coord == 1);
  CHECK(fault.fault.kind == pmac::runtime::FaultKind::kFollowingError);
  CHECK(fault.fault.source.line == 11);          // 14.14 mu a cycle: 566 mu behind
  CHECK(fault.fault.detail.find("FatalFeLimit = 500") != std::string::npos);
  CHECK(bench.motor(3).final_mu == Approx(30000));   // the other coordinate system goes on
  CHECK(bench.answers == std::vector<std::string>{"Motor[1].FeWarn=0", "Coord[1].FeFatal=0", "Coord[1].ProgActive=1", "Motor[1].AmpEna=1", "Motor[2].AmpEna=1",
                                                  "Motor[1].FeWarn=0", "Coord[1].FeFatal=1", "Coord[1].ProgActive=0", "Motor[1].AmpEna=0", "Motor[2].AmpEna=1",
                                                  "Motor[1].ClosedLoop=0"});
}

TEST_CASE("in position: within the band for so many interrupts", "[servo]") {
  ProgramBench bench("a.pmc", kSetUp + "Motor[1].Servo.Kvff=40 Motor[1].InPosBand=2 Motor[1].InPosTime=9\n"
                                       "open prog 1\nrapid abs X5\ndwell 0\nP1=Coord[1].InPos\nwhile (Coord[1].InPos==0) {}\nP2=Sys.Time\nP3=Motor[1].PosError\nclose\n"
                                       "Motor[1].MaxSpeed=10 Gather.Items=2 Gather.Addr[0]=Motor[1].PosError.a Gather.Addr[1]=Motor[1].InPos.a\n");
  std::vector<std::vector<double>> rows;
  bench.machine->set_gather_sink({[](const std::vector<std::string>&) {}, [&](std::span<const double> row) { rows.emplace_back(row.begin(), row.end()); }});
  bench.machine->at(3000, "P1 P2 P3");
  bench.run("Gather.Enable=2 &1 b1r", until(3100));
  REQUIRE(bench.faults.empty());
  CHECK(bench.answers[0] == "P1=0");
  double last_outside_ms = 0;
  for (const auto& row : rows)
    if (std::abs(row[1]) > 2 && row[0] < 2) last_outside_ms = row[0] * 1000;
  CHECK(last_outside_ms > 600);                                         // 5000/10 + 100 ms, and it still settles
  CHECK(number(bench.answers[1]) * 1000 == Approx(last_outside_ms + 10).margin(1.01));   // InPosTime + 1 checks
  CHECK(std::abs(number(bench.answers[2])) <= 2);
  for (const auto& row : rows)
    if (row[2] != 0 && row[0] * 1000 > 20) CHECK(std::abs(row[1]) <= 2);
}

TEST_CASE("a killed motor coasts, and closes its loop where it is", "[servo]") {
  ProgramBench bench("a.pmc", kSetUp + "Sim.Motor[1].Friction=0.02\nMotor[1].Servo.Kvff=48\n");   // Kvff makes up for the friction: 0.02/0.0025 = 8
  bench.machine->at(1000, "#1k Motor[1].ActPos");
  bench.machine->at(3000, "Motor[1].ActPos #1j/ Motor[1].PosError");
  bench.machine->at(3100, "Motor[1].ActPos");
  bench.run("#1j+", until(3200));
  REQUIRE(bench.refusals.empty());
  const double killed = number(bench.answers[0]), stands = number(bench.answers[1]);
  CHECK(stands - killed == Approx(10 / 0.02).epsilon(0.03));   // v / b, one or two cycles early or late
  CHECK(number(bench.answers[2]) == 0);
  CHECK(number(bench.answers[3]) == Approx(stands).margin(1e-6));
}

TEST_CASE("an open-loop output accelerates the mass until friction holds it", "[servo]") {
  ProgramBench bench("a.pmc", kSetUp + "Sim.Motor[1].Friction=0.02 Motor[1].MaxDac=1000\n&1 #2->0\n");
  bench.machine->at(2000, "Motor[1].ActVel #2out5 #1out101");
  bench.run("#1out10", until(2100));
  REQUIRE(bench.answers.size() == 1);
  CHECK(number(bench.answers[0]) == Approx(100 * 0.0025 / 0.02).epsilon(1e-9));   // gain * output / friction
  REQUIRE(bench.refusals.size() == 1);
  REQUIRE(bench.warnings.size() == 1);
  CHECK(bench.warnings[0].find("Sim.Motor[2].Plant=1") != std::string::npos);
  CHECK(bench.refusals[0].find("101") != std::string::npos);
}

TEST_CASE("a home search with a plant catches the trigger with the actual position", "[servo]") {
  ProgramBench bench("a.pmc", kSetUp + "Motor[1].Servo.Kvff=0 Motor[1].HomeVel=10 Sim.Motor[1].TriggerPos=5000\n");
  bench.machine->at(620, "Motor[1].DesPos");
  bench.machine->at(4000, "Motor[1].HomePos Motor[1].HomeComplete Motor[1].ActPos");
  bench.run("#1hm", until(4100));
  REQUIRE(bench.answers.size() == 4);
  CHECK(number(bench.answers[0]) > 5200);      // the actual position is 400 mu behind
  CHECK(number(bench.answers[1]) == 5000);
  CHECK(number(bench.answers[2]) == 1);
  CHECK(number(bench.answers[3]) == Approx(5000).margin(0.01));
}

TEST_CASE("gathered positions count from power-on, commanded and actual", "[servo]") {
  ProgramBench bench("a.pmc", kSetUp + "Motor[1].Servo.Kvff=0 Gather.Items=2 Gather.Addr[0]=Motor[1].DesPos.a Gather.Addr[1]=Motor[1].ActPos.a\n");
  std::vector<std::vector<double>> rows;
  bench.machine->set_gather_sink({[](const std::vector<std::string>&) {}, [&](std::span<const double> row) { rows.emplace_back(row.begin(), row.end()); }});
  bench.run("#1j=1000", until(2000));
  bench.run("#1hmz Gather.Enable=2 #1j+", until(3500));
  REQUIRE(rows.size() > 1000);
  CHECK(rows.front()[1] == Approx(1000).margin(0.2));
  CHECK(rows[1400][1] - rows[1400][2] == Approx(400).epsilon(1e-6));
}
