#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <limits>

#include "compiler/bytecode/bytecode.h"
#include "compiler/bytecode/control.h"
#include "compiler/bytecode/element.h"
#include "compiler/bytecode/function.h"
#include "compiler/bytecode/opcode.h"
#include "tests/reference/random_module.h"

using namespace pmac::bytecode;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// A small sound module: one program that uses every table, one subprogram, one load script.
Module sound_module() {
  Module module;
  module.files = {"a.pmc"};
  module.constants = {1.5};
  module.strings = {"text"};
  module.element_refs = {{ElementId::kMotorJogSpeed, {{false, 3}}}, {ElementId::kMotorJogSpeed, {{true, 1}}},
                         {ElementId::kMotorJogSpeed, {{false, 1}}, true}};
  module.sync_targets = {{VariableClass::kP, 10}, {VariableClass::kElement, 0, 0xffff, 0}};
  module.call_targets = {{100, -1}};
  module.axis_definitions = {{1, AxisDefinitionKind::kLinear, 0, {{6, 1000.0}}, 0}};
  module.pointer_definitions = {{5, 5, PointerKind::kIo, false, 0xa00000, 8, 1, false, 0, "Point0"}};
  module.symbols = {{SymbolKind::kGlobal, "Speed", 8192, 0, ""}};
  Program program;
  program.number = 1;
  program.local_count = 2;
  program.frame_size = 4;
  program.outgoing_count = 2;
  program.code = {Instruction::with_imm(Opcode::kLoadConst, 0, 0), Instruction::with_bc(Opcode::kAdd, 5, 0, 1),
                  Instruction::with_imm(Opcode::kSyncStore, 0, 0), Instruction::with_imm(Opcode::kReturn, 0, 0)};
  program.lines = {{0, {0, 1, 1}}};
  program.labels = {{10, 0}, {20, 2}};
  module.programs = {program, program, program};
  module.programs[1].kind = ProgramKind::kSubprog;
  module.programs[2].kind = ProgramKind::kOnline;
  module.programs[2].code[2] = Instruction::with_imm(Opcode::kInstallProgram, 0, 0);
  module.load_order = {2};
  return module;
}

struct Damage {
  const char* what;
  std::function<void(Module&)> apply;
};

Damage instruction(const char* what, Instruction in) {
  return {what, [in](Module& module) { module.programs[0].code[1] = in; }};
}

}  // namespace

TEST_CASE("verify: accepts a sound module", "[verify]") { CHECK(verify(sound_module()) == ""); }

TEST_CASE("verify: accepts random modules that keep the rules", "[verify]") {
  for (std::uint32_t seed = 0; seed < 300; ++seed) {
    INFO("seed " << seed);
    CHECK(verify(pmac::reference::random_module(seed)) == "");
  }
}

TEST_CASE("verify: refuses operands out of range", "[verify]") {
  const auto bc = [](Opcode op, unsigned a, unsigned b, unsigned c = 0) { return Instruction::with_bc(op, a, b, c); };
  const auto imm = [](Opcode op, unsigned a, std::int32_t value) { return Instruction::with_imm(op, a, value); };
  const auto function_count = static_cast<unsigned>(Function::kCount);
  const auto verb = [](ControlVerb v) { return static_cast<unsigned>(v); };
  const Damage cases[] = {
      instruction("unknown opcode", imm(static_cast<Opcode>(999), 0, 0)),
      instruction("register a", imm(Opcode::kLoadInt, 6, 0)),
      instruction("register a of three", imm(Opcode::kSetNormal, 4, 0)),
      instruction("register b", bc(Opcode::kMove, 0, 6)),
      instruction("register c", bc(Opcode::kAdd, 0, 0, 6)),
      instruction("constant", imm(Opcode::kLoadConst, 0, 1)),
      instruction("negative constant", imm(Opcode::kLoadConst, 0, -1)),
      instruction("P", imm(Opcode::kLoadP, 0, kPCount)),
      instruction("negative P", imm(Opcode::kStoreP, 0, -1)),
      instruction("Q", imm(Opcode::kLoadQ, 0, kQCount)),
      instruction("M", imm(Opcode::kStoreM, 0, kMCount)),
      instruction("I", imm(Opcode::kLoadI, 0, kICount)),
      instruction("C", imm(Opcode::kLoadC, 0, kCCount)),
      instruction("D", imm(Opcode::kStoreD, 0, kDCount)),
      instruction("class", bc(Opcode::kLoadIndexed, 0, 0, 8)),
      instruction("indexed number register", bc(Opcode::kLoadIndexed, 0, 6, 0)),
      instruction("element", imm(Opcode::kLoadElement, 0, 3)),
      instruction("assignment to an address", imm(Opcode::kStoreElement, 0, 2)),
      instruction("function", bc(Opcode::kFunction, 0, function_count, 0)),
      instruction("function argument", bc(Opcode::kFunction, 0, static_cast<unsigned>(Function::kMadd), 4)),
      instruction("jump to itself", imm(Opcode::kJump, 0, 1)),
      instruction("jump back", imm(Opcode::kJump, 0, 0)),
      instruction("jump past the end", imm(Opcode::kJumpIfTrue, 0, 4)),
      instruction("loop forward", imm(Opcode::kLoop, 0, 2)),
      instruction("loop to nowhere", imm(Opcode::kLoopIfTrue, 0, -1)),
      instruction("gosub past the end", imm(Opcode::kGosub, 0, 4)),
      instruction("callsub before the start", imm(Opcode::kCallsub, 0, -2)),
      instruction("call target", imm(Opcode::kCall, 0, 1)),
      instruction("synchronous target", imm(Opcode::kSyncStore, 0, 2)),
      instruction("move mode", imm(Opcode::kSetMode, 8, 0)),
      instruction("axis set", imm(Opcode::kSetAbs, 2, 1)),
      instruction("motion parameter", bc(Opcode::kSetMotion, 0, static_cast<unsigned>(MotionParameter::kCount))),
      instruction("axis", bc(Opcode::kAxisWord, 0, 32, static_cast<unsigned>(WordKind::kTarget))),
      instruction("centre", bc(Opcode::kAxisWord, 0, 6, static_cast<unsigned>(WordKind::kCenter))),
      instruction("radius", bc(Opcode::kAxisWord, 0, 1, static_cast<unsigned>(WordKind::kRadius))),
      instruction("word kind", bc(Opcode::kAxisWord, 0, 0, static_cast<unsigned>(WordKind::kCount))),
      instruction("verb", bc(Opcode::kControl, verb(ControlVerb::kCount), 0, 0)),
      instruction("verb arguments", bc(Opcode::kControl, verb(ControlVerb::kJogTo), 0, 1)),
      instruction("verb registers", bc(Opcode::kControl, verb(ControlVerb::kJogTo), 5, 2)),
      instruction("verb without arguments", bc(Opcode::kControl, verb(ControlVerb::kSave), 999, 0)),
      instruction("text", imm(Opcode::kCommand, 0, 1)),
      instruction("text of a port", imm(Opcode::kSend, 0, 1)),
      instruction("on-line only", imm(Opcode::kAddressCoord, 0, 0)),
  };
  for (const Damage& damage : cases) {
    INFO(damage.what);
    Module module = sound_module();
    damage.apply(module);
    CHECK(verify(module) != "");
  }
}

TEST_CASE("verify: refuses load-script operands out of range", "[verify]") {
  for (const Opcode op : {Opcode::kDefineAxis, Opcode::kDefinePointer, Opcode::kInstallProgram, Opcode::kReport}) {
    for (const std::int32_t value : {-1, 3}) {
      Module module = sound_module();
      module.programs[2].code[2] = Instruction::with_imm(op, 0, value);
      INFO(opcode_info(op).text << " " << value);
      CHECK(verify(module) != "");
    }
  }
  Module module = sound_module();
  module.programs[2].code[2].imm = 2;  // a load script is not a buffer
  CHECK(verify(module) != "");
}

TEST_CASE("verify: refuses damaged tables and frames", "[verify]") {
  const Damage cases[] = {
      {"element id", [](Module& m) { m.element_refs[0].id = ElementId::kCount; }},
      {"element index", [](Module& m) { m.element_refs[0].index[0].value = 33; }},
      {"index that the name has not", [](Module& m) { m.element_refs[0].index[1].value = 1; }},
      {"index register outside the frame",
       [](Module& m) {
         m.element_refs[1].index[0].value = 6;
         m.programs[0].code[1] = Instruction::with_imm(Opcode::kLoadElement, 0, 1);
       }},
      {"huge index register",
       [](Module& m) {
         m.element_refs[1].index[0].value = 0xffffffff;
         m.programs[0].code[1] = Instruction::with_imm(Opcode::kLoadElement, 0, 1);
       }},
      {"sync class R", [](Module& m) { m.sync_targets[0].variable_class = VariableClass::kR; }},
      {"sync class unknown", [](Module& m) { m.sync_targets[0].variable_class = static_cast<VariableClass>(77); }},
      {"sync number", [](Module& m) { m.sync_targets[0].number = kPCount; }},
      {"sync negative number", [](Module& m) { m.sync_targets[0].number = -1; }},
      {"sync register", [](Module& m) { m.sync_targets[0].number_register = 6; }},
      {"sync local", [](Module& m) { m.sync_targets[0] = {VariableClass::kL, 2}; }},
      {"sync operator", [](Module& m) { m.sync_targets[0].op = AssignOp::kCount; }},
      {"sync element", [](Module& m) { m.sync_targets[1].element = 3; }},
      {"sync to an address",
       [](Module& m) {
         m.sync_targets[1].element = 2;
         m.programs[0].code[1] = Instruction::with_imm(Opcode::kSyncStore, 0, 1);
       }},
      {"call label", [](Module& m) { m.call_targets[0].label = -2; }},
      {"call label too large", [](Module& m) { m.call_targets[0].label = 0x100000000; }},
      {"axis motor", [](Module& m) { m.axis_definitions[0].motor = kMaxMotors; }},
      {"axis kind", [](Module& m) { m.axis_definitions[0].kind = AxisDefinitionKind::kCount; }},
      {"axis of a term", [](Module& m) { m.axis_definitions[0].terms[0].axis = 32; }},
      {"axis coefficient", [](Module& m) { m.axis_definitions[0].terms[0].coefficient_mu_per_uu = kNan; }},
      {"axis terms", [](Module& m) { m.axis_definitions[0].terms.resize(33); }},
      {"axis offset", [](Module& m) { m.axis_definitions[0].offset_mu = kNan; }},
      {"axis spindle", [](Module& m) { m.axis_definitions[0].spindle = 3; }},
      {"pointer M", [](Module& m) { m.pointer_definitions[0].last_m = kMCount; }},
      {"pointer range", [](Module& m) { m.pointer_definitions[0].last_m = 6; }},
      {"pointer kind", [](Module& m) { m.pointer_definitions[0].kind = PointerKind::kCount; }},
      {"pointer bits", [](Module& m) { m.pointer_definitions[0].start_bit = 32; }},
      {"pointer width", [](Module& m) { m.pointer_definitions[0].width = 0; }},
      {"pointer element",
       [](Module& m) {
         m.pointer_definitions[0].kind = PointerKind::kElement;
         m.pointer_definitions[0].element = 1;  // has a register index
       }},
      {"symbol kind", [](Module& m) { m.symbols[0].kind = SymbolKind::kCount; }},
      {"program kind", [](Module& m) { m.programs[0].kind = ProgramKind::kCount; }},
      {"PLC number", [](Module& m) { m.programs[0].kind = ProgramKind::kPlc, m.programs[0].number = 32; }},
      {"kinematic number", [](Module& m) { m.programs[0].kind = ProgramKind::kForward, m.programs[0].number = 17; }},
      {"no code", [](Module& m) { m.programs[0].code.clear(); }},
      {"runs past the end", [](Module& m) { m.programs[0].code.pop_back(); }},
      {"more locals than registers", [](Module& m) { m.programs[0].local_count = 5; }},
      {"too many locals", [](Module& m) { m.programs[0].local_count = m.programs[0].frame_size = kLCount + 1; }},
      {"frame too large", [](Module& m) { m.programs[0].frame_size = kMaxFrameSize + 1; }},
      {"frame too small", [](Module& m) { m.programs[0].outgoing_count = 1; }},
      {"too many outgoing", [](Module& m) { m.programs[0].outgoing_count = kMaxOutgoing + 1; }},
      {"labels not ascending", [](Module& m) { m.programs[0].labels[1].number = 10; }},
      {"label outside", [](Module& m) { m.programs[0].labels[1].pc = 4; }},
      {"line outside", [](Module& m) { m.programs[0].lines[0].pc = 4; }},
      {"line of an unknown file", [](Module& m) { m.programs[0].lines[0].source.file = 1; }},
      {"lines not ascending", [](Module& m) { m.programs[0].lines = {{2, {}}, {1, {}}}; }},
      {"negative line", [](Module& m) { m.programs[0].source.line = -1; }},
      {"load order", [](Module& m) { m.load_order[0] = 3; }},
      {"load order of a buffer", [](Module& m) { m.load_order[0] = 0; }},
  };
  for (const Damage& damage : cases) {
    INFO(damage.what);
    Module module = sound_module();
    damage.apply(module);
    CHECK(verify(module) != "");
  }
}

TEST_CASE("verify: the reason names the program and the instruction", "[verify]") {
  Module module = sound_module();
  module.programs[0].code[1] = Instruction::with_imm(Opcode::kLoadP, 0, 70000);
  CHECK(verify(module) == "prog 1: instruction 1 (load.p): variable number 70000 is not below 65536");
}
