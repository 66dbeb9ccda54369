// Programs with machine I/O, and the jog PLC, under scripted inputs.
#include "tests/unit/programs/bench.h"

using pmac::test::ProgramBench;

TEST_CASE("looping and I/O: the laser is on for 100 ms after each move, in position, until the input is cleared", "[programs]") {
  for (const char* name : {"04_looping_and_io.pmc", "08_machine_io.pmc"}) {
    ProgramBench bench(name);
    bench.machine->at(4000.0, "LoopCtrlInput=0");
    bench.run("LoopCtrlInput=1 DirCtrlInput=1 &1 b3r");
    REQUIRE(bench.refusals.empty());
    // A round: 1575 ms out, at most one interrupt for the in-position check, 100 ms, 1575 ms back, 50 ms. Two rounds begin before 4 s.
    REQUIRE(bench.outputs.size() == 4);
    const double interrupt = bench.machine->servo_period_ms();
    CHECK(bench.outputs[0].time_ms >= 1575.0);
    CHECK(bench.outputs[0].time_ms <= 1575.0 + 2 * interrupt);
    CHECK(bench.outputs[1].time_ms - bench.outputs[0].time_ms == Approx(100.0).margin(1e-9));
    CHECK(bench.outputs[2].time_ms >= 2 * 1575.0 + 150 + 1575.0);
    CHECK(bench.outputs[2].time_ms <= 2 * 1575.0 + 150 + 1575.0 + 4 * interrupt);
    CHECK(bench.motor(3).max_mu == Approx(40000.0).margin(1e-6));
    CHECK(bench.motor(3).min_mu == Approx(0.0).margin(1e-6));
    for (std::size_t k = 0; k < bench.time_ms.size(); ++k)  // while the laser is on the motor stands at 40
      for (std::size_t on = 0; on < 4; on += 2)
        if (bench.time_ms[k] >= bench.outputs[on].time_ms && bench.time_ms[k] <= bench.outputs[on + 1].time_ms)
          REQUIRE(bench.motor_mu[k][3] == Approx(40000.0).margin(1e-6));
  }
}

TEST_CASE("looping and I/O: the direction input chooses the side; without the loop input nothing moves", "[programs]") {
  ProgramBench other("04_looping_and_io.pmc");
  other.machine->at(1000.0, "LoopCtrlInput=0");
  other.run("LoopCtrlInput=1 &1 b3r");
  CHECK(other.motor(3).min_mu == Approx(-40000.0).margin(1e-6));
  ProgramBench none("04_looping_and_io.pmc");
  none.run("&1 b3r");
  CHECK(none.moves.empty());
  CHECK(none.outputs.empty());
}

TEST_CASE("jog PLC: a held button jogs the selected motor, within its stopping distance after release", "[programs]") {
  ProgramBench bench("09_jog_plc.plc");
  bench.machine->at(100.0, "JogPlusButton=1");
  bench.machine->at(600.0, "JogPlusButton=0");
  bench.machine->at(1000.0, "MotorSelectSw=1");
  bench.machine->at(1200.0, "JogMinusButton=1");
  bench.machine->at(1500.0, "JogMinusButton=0");
  pmac::runtime::RunLimits limits;
  limits.until_ms = 2500.0;
  bench.run("enable plc 1", limits);
  REQUIRE(bench.refusals.empty());
  REQUIRE(bench.faults.empty());
  REQUIRE(bench.moves.size() == 2);
  CHECK(bench.moves[0].mode == "jog");
  CHECK(bench.moves[0].motor == 1);
  CHECK(bench.moves[0].start_ms >= 100.0);
  CHECK(bench.moves[0].start_ms <= 101.0 + 1e-9);  // a background scan every millisecond
  CHECK(bench.moves[1].motor == 2);
  CHECK(bench.motor(1).final_mu > 1000);
  CHECK(bench.motor(2).final_mu < -500);
  // V^2 |JogTa| / 2 + V Ts / 2 = 500 with JogTa = -10 and Ts = 5 ms
  const double steady = (-2.5 + std::sqrt(2.5 * 2.5 + 4 * 5.0 * 500.0)) / 10.0;
  CHECK(bench.motor(1).max_speed_mu_ms <= steady);
  CHECK(bench.motor(1).max_speed_mu_ms > 0.98 * steady);
  // After the release it stops within the distance.
  double at_release = 0;
  for (std::size_t k = 0; k < bench.time_ms.size() && bench.time_ms[k] <= 601.0; ++k) at_release = bench.motor_mu[k][1];
  CHECK(bench.motor(1).final_mu - at_release <= 500.0 + 1e-6);
}
