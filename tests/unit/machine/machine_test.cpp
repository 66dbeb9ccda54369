#include <catch2/catch.hpp>

#include "compiler/bytecode/control.h"
#include "compiler/bytecode/opcode.h"
#include "runtime/machine.h"
#include "tests/unit/machine/assemble.h"

using namespace pmac;
using namespace pmac::runtime;
using bytecode::ControlVerb;
using bytecode::ElementId;
using bytecode::MotionParameter;
using bytecode::MoveMode;
using bytecode::ProgramKind;
using test::ProgramBuilder;

namespace {

/// A machine that keeps what it reports.
struct Bench {
  std::vector<MoveRecord> moves;
  std::vector<FaultRecord> faults;
  std::vector<std::string> refusals;
  MotionStatistics statistics;
  Machine machine{options()};

  MachineOptions options() {
    MachineOptions o;
    o.observers.move = [this](const MoveRecord& m) { moves.push_back(m); };
    o.observers.fault = [this](const FaultRecord& f) { faults.push_back(f); };
    o.observers.refused = [this](const std::string&, const std::string& reason) { refusals.push_back(reason); };
    return o;
  }
  RunOutcome run(bytecode::Module module, const RunLimits& limits = {}) {
    REQUIRE(verify(module).empty());
    machine.add_sink(&statistics);
    machine.load(std::move(module));
    return machine.run(limits);
  }
};

/// #1->1000X, prog 1 installed and started.
void add_load_script(bytecode::Module& module, std::uint32_t program) {
  ProgramBuilder load(module, ProgramKind::kOnline, 0);
  load.address_coord(1);
  load.define_axis(1, "X", 1000);
  load.install(program);
  load.control(ControlVerb::kStart, {1, 1});
  module.load_order = {load.finish()};
}

bytecode::Module basic_moves() {
  bytecode::Module module;
  module.files = {"basic.pmc"};
  ProgramBuilder prog(module, ProgramKind::kProg, 1);
  prog.mode(MoveMode::kLinear);
  prog.set(MotionParameter::kTa, 500);
  prog.set(MotionParameter::kTs, 0);
  prog.set(MotionParameter::kFeed, 5);
  prog.line(7);
  prog.move("X", 10);
  prog.dwell(500);
  prog.line(9);
  prog.move("X", 0);
  prog.dwell(500);
  add_load_script(module, prog.finish());
  return module;
}

}  // namespace

TEST_CASE("basic moves take 2500 ms each and the program 6000 ms", "[machine]") {
  Bench bench;
  const RunOutcome outcome = bench.run(basic_moves());
  REQUIRE(bench.refusals.empty());
  REQUIRE(bench.moves.size() == 4);
  // Closed form: |D|/F + (Ta + Td)/2 = 10/5 s + 500 ms; dwells are exact.
  CHECK(bench.moves[0].start_ms == 0.0);
  CHECK(bench.moves[0].end_ms == Approx(2500.0).margin(1e-9));
  CHECK(bench.moves[0].length == Approx(10.0));
  CHECK(bench.moves[0].source.line == 7);
  CHECK(bench.moves[1].mode == "dwell");
  CHECK(bench.moves[1].end_ms == Approx(3000.0).margin(1e-9));
  CHECK(bench.moves[2].start_ms == Approx(3000.0).margin(1e-9));
  CHECK(bench.moves[3].end_ms == Approx(6000.0).margin(1e-9));
  CHECK(outcome.end == RunEnd::kIdle);
  CHECK(outcome.time_ms == Approx(6010.0).margin(1e-6));  // idle for 10 ms
  const auto rows = bench.statistics.rows();
  REQUIRE(rows.size() == 1);
  CHECK(rows[0].max_speed_mu_ms == Approx(5.0).epsilon(1e-9));        // 5 au/s at 1000 mu/au
  CHECK(rows[0].max_accel_mu_ms2 == Approx(0.01).epsilon(1e-6));      // 5 mu/ms in 500 ms
  CHECK(rows[0].final_mu == Approx(0.0).margin(1e-9));
  CHECK(rows[0].max_mu == Approx(10000.0).margin(1e-9));
}

TEST_CASE("rapid moves of 40 units take 1575 ms with the default jog set-up", "[machine]") {
  bytecode::Module module;
  module.files = {"rapid.pmc"};
  ProgramBuilder prog(module, ProgramKind::kProg, 1);
  prog.mode(MoveMode::kRapid);
  prog.move("X", 40);
  prog.move("X", 0);
  add_load_script(module, prog.finish());
  Bench bench;
  bench.run(std::move(module));
  REQUIRE(bench.moves.size() == 2);
  // 32 mu/ms reached in 320 + 5 ms at 0.1 mu/ms^2 and 0.02 mu/ms^3: |D|/V + T = 1250 + 325.
  CHECK(bench.moves[0].end_ms == Approx(1575.0).margin(1e-9));
  CHECK(bench.moves[1].start_ms == Approx(1575.0).margin(1e-9));
  CHECK(bench.moves[1].end_ms == Approx(3150.0).margin(1e-9));
}

TEST_CASE("an empty endless loop costs one interrupt a pass and ends at the time limit", "[machine]") {
  bytecode::Module module;
  module.files = {"loop.pmc"};
  ProgramBuilder prog(module, ProgramKind::kProg, 1);
  prog.line(3);
  prog.op(bytecode::Instruction::with_imm(bytecode::Opcode::kLoop, 0, 0));
  add_load_script(module, prog.finish());
  Bench bench;
  RunLimits limits;
  limits.max_ms = 1000;
  const RunOutcome outcome = bench.run(std::move(module), limits);
  CHECK(outcome.end == RunEnd::kTimeLimit);
  CHECK(outcome.time_ms == 1000.0);
  REQUIRE(outcome.running.size() == 1);
  CHECK(outcome.running[0] == "prog 1 at loop.pmc:3");
  CHECK(static_cast<double>(outcome.instructions) < 3 * 1000 / 0.44274211 + 100);  // two jump-backs a pass
}

TEST_CASE("a target that is not finite stops the program at its line and leaves the motor at rest", "[machine]") {
  bytecode::Module module;
  module.files = {"bad.pmc"};
  ProgramBuilder prog(module, ProgramKind::kProg, 1);
  prog.set(MotionParameter::kFeed, 10);
  prog.line(4);
  prog.move("X", 5);
  prog.line(5);
  prog.move("X", 1.0 / 0.0);
  add_load_script(module, prog.finish());
  Bench bench;
  const RunOutcome outcome = bench.run(std::move(module));
  CHECK(outcome.end == RunEnd::kIdle);
  REQUIRE(bench.faults.size() == 1);
  CHECK(bench.faults[0].fault.source.line == 5);
  CHECK(bench.faults[0].fault.detail.find("axis X") != std::string::npos);
  CHECK(bench.machine.any_fault());
}

TEST_CASE("starting a program that is not there is refused with the controller's number", "[machine]") {
  bytecode::Module module;
  ProgramBuilder load(module, ProgramKind::kOnline, 0);
  load.control(ControlVerb::kStart, {1, 77});
  module.load_order = {load.finish()};
  Bench bench;
  bench.run(std::move(module));
  REQUIRE(bench.refusals.size() == 1);
  CHECK(bench.refusals[0].find("error #22") == 0);
}

TEST_CASE("the same module gives the same samples twice", "[machine]") {
  struct Keep : SampleSink {
    std::vector<double> values;
    void take(const SampleBlock& b) override { values.insert(values.end(), b.position_mu.begin(), b.position_mu.end()); }
  };
  Keep first, second;
  for (Keep* keep : {&first, &second}) {
    Bench bench;
    bench.machine.add_sink(keep);
    bench.run(basic_moves());
  }
  REQUIRE(first.values.size() > 13000);  // 6 s at 2.26 kHz
  CHECK(first.values == second.values);
}

TEST_CASE("a synchronous assignment acts at the start of the blend into the next move", "[machine]") {
  bytecode::Module module;
  module.files = {"sync.pmc"};
  bytecode::PointerDefinition pump;
  pump.first_m = pump.last_m = 8192;
  pump.kind = bytecode::PointerKind::kIo;
  pump.address = 0xA0000C;
  pump.start_bit = 12;
  pump.width = 1;
  pump.name = "Pump";
  module.pointer_definitions = {pump};
  bytecode::SyncTarget target;
  target.variable_class = bytecode::VariableClass::kM;
  target.number = 8192;
  module.sync_targets = {target};
  ProgramBuilder prog(module, ProgramKind::kProg, 1);
  prog.set(MotionParameter::kTa, 100);
  prog.set(MotionParameter::kTs, 0);
  prog.set(MotionParameter::kFeed, 10);
  const auto sync = [&](double value) {
    prog.load(prog.temporary(), value);
    prog.op(bytecode::Instruction::with_imm(bytecode::Opcode::kSyncStore, prog.temporary(), 0));
  };
  prog.move("X", 10);
  sync(1);
  prog.move("X", 30);
  sync(0);
  prog.dwell(10);
  sync(1);  // after the last move: never executed
  const std::uint32_t index = prog.finish();
  ProgramBuilder load(module, ProgramKind::kOnline, 0);
  load.address_coord(1);
  load.define_axis(1, "X", 1000);
  load.op(bytecode::Instruction::with_imm(bytecode::Opcode::kDefinePointer, 0, 0));
  load.install(index);
  load.control(ControlVerb::kStart, {1, 1});
  module.load_order = {load.finish()};

  std::vector<OutputChange> changes;
  MachineOptions options;
  options.observers.output = [&](const OutputChange& c) { changes.push_back(c); };
  Machine machine(options);
  machine.load(std::move(module));
  machine.run({});
  REQUIRE(changes.size() == 2);
  // The corner lies at Ta/2 + 10/10 s = 1050 ms; the blend begins Ta/2 before it. The dwell begins when the second move has
  // stopped: 1050 + 20/10 s + Ta/2.
  CHECK(changes[0].time_ms == Approx(1000.0).margin(1e-9));
  CHECK(changes[0].value == 1.0);
  CHECK(changes[0].name == "Pump");
  CHECK(changes[1].time_ms == Approx(3100.0).margin(1e-9));
}
