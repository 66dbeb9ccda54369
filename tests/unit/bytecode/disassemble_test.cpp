#include <catch2/catch.hpp>

#include "compiler/bytecode/bytecode.h"
#include "compiler/bytecode/element.h"
#include "compiler/bytecode/opcode.h"
#include "tests/reference/random_module.h"

using namespace pmac::bytecode;

TEST_CASE("disassembly: locals, temporaries, arguments, labels and source lines are named", "[bytecode]") {
  Module module;
  module.files = {"move.pmc"};
  module.constants = {2.5};
  module.element_refs.push_back({ElementId::kMotorJogSpeed, {{true, 0}}});
  Program program;
  program.number = 5;
  program.local_count = 1;
  program.frame_size = 2;
  program.outgoing_count = 1;
  program.source = {0, 1, 1};
  program.code = {Instruction::with_imm(Opcode::kLoadConst, 0, 0), Instruction::with_bc(Opcode::kAdd, 1, 0, 2),
                  Instruction::with_imm(Opcode::kStoreElement, 1, 0), Instruction::with_imm(Opcode::kLoopIfTrue, 0, 1),
                  Instruction::with_imm(Opcode::kReturn, 0, 0)};
  program.lines = {{0, {0, 2, 1}}, {1, {0, 3, 5}}};
  program.labels = {{100, 1}};
  module.programs = {program};
  REQUIRE(verify(module).empty());
  CHECK(disassemble(module) ==
        "files\n"
        "     0  move.pmc\n"
        "\n"
        "prog 5: 1 locals, 2 registers, 1 outgoing         ; move.pmc:1\n"
        "     0  load.const    L0, 2.5                     ; move.pmc:2\n"
        "  N100:\n"
        "     1  add           t0, L0, R0                  ; move.pmc:3\n"
        "     2  store.element t0, Motor[L0].JogSpeed\n"
        "     3  loop.true     L0, -> 1\n"
        "     4  return\n"
        "\n");
}

TEST_CASE("disassembly: damaged modules can be looked at", "[bytecode]") {
  std::mt19937 random(11);
  for (std::uint32_t seed = 0; seed < 200; ++seed) {
    Module module = pmac::reference::random_module(seed);
    for (int i = 0; i < 5; ++i) pmac::reference::damage(module, random);
    CHECK_FALSE(disassemble(module).empty());
  }
}

TEST_CASE("source places: an instruction belongs to the last line entry at or before it", "[bytecode]") {
  Module module;
  module.files = {"a.pmc"};
  Program program;
  program.lines = {{2, {0, 10, 1}}, {5, {0, 12, 3}}};
  CHECK(source_of(program, 0) == SourceLine{});
  CHECK(source_of(program, 2).line == 10);
  CHECK(source_of(program, 4).line == 10);
  CHECK(source_of(program, 900).line == 12);
  CHECK(to_string(module, {0, 12, 3}) == "a.pmc:12");
  CHECK(to_string(module, {}) == "<no source>");
  CHECK(to_string(module, {7, 1, 1}) == "<no source>");
}
