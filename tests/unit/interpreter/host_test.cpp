#include <catch2/catch.hpp>

#include "compiler/bytecode/control.h"
#include "compiler/bytecode/element.h"
#include "tests/unit/interpreter/recording_host.h"

using namespace pmac::test;
using enum pmac::bytecode::Opcode;
using Log = std::vector<std::string>;

TEST_CASE("motion instructions reach the host with the registers", "[host]") {
  Bench bench({imm(kLoadInt, 0, 5), imm(kSetMode, 0), imm(kSetAbs, 0, 3), imm(kSetInc, 1, 3), imm(kSetFrax, 0, 7),
               imm(kSetNormal, 0), bc(kSetMotion, 0, 0), bc(kAxisWord, 0, 6, 0), imm(kBlockEnd), imm(kDwell, 0),
               imm(kDelay, 0), imm(kReturn)});
  bench.run();
  CHECK(bench.host.log == Log{"mode 5", "abs 5", "inc 0", "frax 5", "normal 5", "set.motion 5", "word 5", "block.end 5",
                              "dwell 5", "delay 5"});
}

TEST_CASE("control verbs get their arguments, commands and messages their text", "[host]") {
  const auto verb = [](ControlVerb v) { return static_cast<unsigned>(v); };
  Bench bench({imm(kLoadInt, 4, 3), imm(kLoadInt, 5, 800), bc(kControl, verb(ControlVerb::kJogTo), 4, 2),
               bc(kControl, verb(ControlVerb::kAbort), 4, 1), bc(kControl, verb(ControlVerb::kSave), 0, 0),
               imm(kCommand, 0, 0), imm(kSend, 2, 0), imm(kReturn)});
  bench.module.strings = {"hello"};
  bench.run();
  CHECK(bench.host.log == Log{"jog= 3 800", "abort 3", "save", "cmd hello", "send2 hello"});
}

TEST_CASE("load-script instructions reach the host", "[host]") {
  Bench bench({imm(kAddressCoord, 0), imm(kAddressMotor, 0), imm(kDefineAxis, 0, 0), imm(kDefinePointer, 0, 0),
               imm(kInstallProgram, 0, 1), imm(kReport, 0, 0), imm(kReturn)});
  bench.module.programs[0].kind = ProgramKind::kOnline;
  bench.module.axis_definitions.resize(1);
  bench.module.pointer_definitions.resize(1);
  bench.module.strings = {"P1"};
  bench.add({imm(kReturn)});
  bench.run();
  CHECK(bench.host.log == Log{"&", "#", "axis.define", "ptr.define", "install", "report"});
}

TEST_CASE("synchronous assignments: constant and computed targets, elements, operators", "[host]") {
  Bench bench({imm(kLoadInt, 0, 3), imm(kLoadConst, 1, 0), imm(kSyncStore, 0, 0), imm(kSyncStore, 0, 1), imm(kSyncStore, 0, 2),
               imm(kReturn)});
  bench.module.constants = {12.9};
  bench.module.element_refs = {{ElementId::kMotorJogSpeed, {{true, 0}}}};
  bench.module.sync_targets = {{VariableClass::kM, 5}, {VariableClass::kP, 0, 1, 0, AssignOp::kOr}, {VariableClass::kElement}};
  bench.run();
  CHECK(bench.host.log == Log{"M5 op0 3", "P12 op7 3", "Motor[].JogSpeed3 op0 3"});
}

TEST_CASE("synchronous assignments: a computed number out of range is a fault when the line is calculated", "[host]") {
  Bench bench({imm(kLoadInt, 1, -4), imm(kSyncStore, 0, 0), imm(kReturn)});
  bench.module.sync_targets = {{VariableClass::kP, 0, 1}};
  CHECK(bench.fault_of_run() == "test.pmc:2: variable P(-4) does not exist; the range is P0 to P65535");
  CHECK(bench.host.log.empty());
}

TEST_CASE("every fault kind has a controller error number", "[host]") {
  using pmac::runtime::FaultKind;
  CHECK(pmac::runtime::error_status(FaultKind::kSyncBuffer) == 1);
  CHECK(pmac::runtime::error_status(FaultKind::kSoftLimit) == 32);
  CHECK(pmac::runtime::error_status(FaultKind::kUserStatus) == 255);
  CHECK(pmac::runtime::error_status(FaultKind::kRunTime) == 16);
}
