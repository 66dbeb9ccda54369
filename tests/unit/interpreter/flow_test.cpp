#include <catch2/catch.hpp>

#include "tests/unit/interpreter/recording_host.h"

using namespace pmac::test;
using enum pmac::bytecode::Opcode;

TEST_CASE("jumps: taken and not taken", "[interpreter]") {
  Bench bench({imm(kLoadInt, 4, 1), imm(kJumpIfTrue, 4, 3), imm(kLoadInt, 0, 99),
               imm(kJumpIfFalse, 4, 5), imm(kLoadInt, 1, 7), imm(kJump, 0, 7), imm(kLoadInt, 2, 99), imm(kReturn)});
  bench.run();
  CHECK(bench.thread.local(0) == 0);
  CHECK(bench.thread.local(1) == 7);
  CHECK(bench.thread.local(2) == 0);
}

TEST_CASE("nan is true as a condition: it is not equal to 0", "[interpreter]") {
  Bench bench({imm(kLoadConst, 4, 0), imm(kJumpIfTrue, 4, 3), imm(kReturn), imm(kLoadInt, 0, 1), imm(kReturn)});
  bench.module.constants = {std::numeric_limits<double>::quiet_NaN()};
  CHECK(bench.local_after_run(0) == 1);
}

TEST_CASE("loops: a do-while sums 1 to 10", "[interpreter]") {
  Bench bench({imm(kLoadInt, 4, 1), imm(kLoadInt, 5, 10), bc(kAdd, 0, 0, 4), bc(kAdd, 1, 1, 0), bc(kLess, 6, 0, 5),
               imm(kLoopIfTrue, 6, 2), imm(kReturn)});
  CHECK(bench.local_after_run(1) == 55);
}

TEST_CASE("loops: an unconditional loop with an exit", "[interpreter]") {
  Bench bench({imm(kLoadInt, 4, 1), imm(kLoadInt, 5, 10), bc(kLess, 6, 0, 5), imm(kJumpIfFalse, 6, 6), bc(kAdd, 0, 0, 4),
               imm(kLoop, 0, 2), imm(kReturn)});
  const RunResult result = bench.run();
  CHECK(bench.thread.local(0) == 10);
  CHECK(result.instructions == 2 + 10 * 4 + 2 + 1);
}

TEST_CASE("goto label: forward, backward, and to a label that is not there", "[interpreter]") {
  // N10 counts L0 to 3 by going back, then goes forward to N20.
  const std::vector<Instruction> code = {
      imm(kLoadInt, 4, 10), imm(kLoadInt, 5, 20), imm(kLoadInt, 6, 1), imm(kLoadInt, 7, 3),
      bc(kAdd, 0, 0, 6),    bc(kLess, 8, 0, 7),   imm(kJumpIfFalse, 8, 8), imm(kGotoLabel, 4),
      imm(kGotoLabel, 5),   imm(kLoadInt, 1, 99), imm(kReturn)};
  Bench bench(code);
  bench.module.programs[0].labels = {{10, 4}, {20, 10}};
  CHECK(bench.local_after_run(0) == 3);
  CHECK(bench.thread.local(1) == 0);

  Bench missing({imm(kLoadInt, 4, 30), imm(kGotoLabel, 4), imm(kReturn)});
  CHECK(missing.fault_of_run() == "test.pmc:2: the program has no label N30");
  Bench negative({imm(kLoadInt, 4, -30), imm(kGotoLabel, 4), imm(kReturn)});
  CHECK(negative.fault_of_run() == "test.pmc:2: the computed label number is not in the range 0 to 4294967295");
}

TEST_CASE("stop ends the program from any depth", "[interpreter]") {
  Bench bench({imm(kGosub, 0, 2), imm(kLoadInt, 0, 99), imm(kGosub, 0, 4), imm(kReturn), imm(kLoadInt, 1, 5), imm(kStop)});
  CHECK(bench.run().stop == RunStop::kEnded);
  CHECK_FALSE(bench.thread.active());
  CHECK(bench.thread.local(0) == 0);
  CHECK(bench.thread.local(1) == 5);
}

TEST_CASE("begin: at a label, or at the top and false when there is none", "[interpreter]") {
  Bench bench({imm(kLoadInt, 0, 1), imm(kReturn), imm(kLoadInt, 0, 2), imm(kReturn)});
  bench.module.programs[0].labels = {{500000, 2}};
  bench.begin();
  const ProgramHandle program = bench.thread.program();
  CHECK(bench.thread.begin(program, 500000));
  CHECK(bench.thread.source().line == 3);
  bench.thread.run(bench.host, 100, 0);
  CHECK(bench.thread.local(0) == 2);
  CHECK_FALSE(bench.thread.begin(program, 7));
  bench.thread.run(bench.host, 100, 0);
  CHECK(bench.thread.local(0) == 1);
}

TEST_CASE("restart keeps the locals, begin clears them", "[interpreter]") {
  Bench bench({imm(kLoadInt, 4, 1), bc(kAdd, 0, 0, 4), imm(kReturn)});
  CHECK_FALSE(bench.thread.restart());
  bench.run();
  for (int scan = 0; scan < 3; ++scan) {
    CHECK(bench.thread.restart());
    bench.run();
  }
  CHECK(bench.thread.local(0) == 4);
  bench.thread.begin(bench.thread.top_program());
  CHECK(bench.thread.local(0) == 0);
}

TEST_CASE("a thread that was never begun has ended", "[interpreter]") {
  Bench bench;
  const RunResult result = bench.thread.run(bench.host, 100, 0);
  CHECK(result.stop == RunStop::kEnded);
  CHECK(result.instructions == 0);
  CHECK(bench.thread.source() == SourceLine{});
}
