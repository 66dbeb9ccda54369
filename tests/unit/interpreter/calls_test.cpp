#include <catch2/catch.hpp>

#include "tests/unit/interpreter/recording_host.h"

using namespace pmac::test;
using enum pmac::bytecode::Opcode;

namespace {
constexpr unsigned kR0 = 12, kR1 = 13;  // see Bench

Bench calling(std::vector<CallTarget> targets, std::vector<Instruction> code, std::vector<Instruction> routine) {
  Bench bench(std::move(code));
  bench.module.call_targets = std::move(targets);
  bench.add(std::move(routine), ProgramKind::kSubprog, 100);
  return bench;
}
}  // namespace

TEST_CASE("gosub works on the same locals, and returns after the call", "[calls]") {
  Bench bench({imm(kGosub, 0, 3), bc(kAdd, 1, 0, 0), imm(kReturn), imm(kLoadInt, 0, 21), imm(kReturn)});
  CHECK(bench.local_after_run(1) == 42);
}

TEST_CASE("gosub to a computed label", "[calls]") {
  Bench bench({imm(kLoadInt, 4, 7), imm(kGosubLabel, 4), imm(kReturn), imm(kLoadInt, 0, 21), imm(kReturn)});
  bench.module.programs[0].labels = {{7, 3}};
  CHECK(bench.local_after_run(0) == 21);
  Bench missing({imm(kLoadInt, 4, 8), imm(kGosubLabel, 4), imm(kReturn)});
  CHECK(missing.fault_of_run() == "test.pmc:2: the program has no label N8");
}

TEST_CASE("callsub has locals of its own: R of the caller are L of the routine, both ways", "[calls]") {
  // Caller: L0 = 1, R0 = 20, R1 = 22, callsub, L1 = R0. Routine: L0 = L0 + L1; L3 = 99.
  Bench bench({imm(kLoadInt, 0, 1), imm(kLoadInt, kR0, 20), imm(kLoadInt, kR1, 22), imm(kCallsub, 0, 6), bc(kMove, 1, kR0),
               imm(kReturn), bc(kAdd, 0, 0, 1), imm(kLoadInt, 3, 99), imm(kReturn)});
  bench.run();
  CHECK(bench.thread.local(0) == 1);
  CHECK(bench.thread.local(1) == 42);
  CHECK(bench.thread.local(3) == 0);
}

TEST_CASE("callsub to a computed label", "[calls]") {
  Bench bench({imm(kLoadInt, 4, 7), imm(kLoadInt, kR0, 5), imm(kCallsubLabel, 4), bc(kMove, 1, kR0), imm(kReturn),
               bc(kAdd, 0, 0, 0), imm(kReturn)});
  bench.module.programs[0].labels = {{7, 5}};
  CHECK(bench.local_after_run(1) == 10);
}

TEST_CASE("call: arguments by R and L, results by reference, return into the caller", "[calls]") {
  Bench bench = calling({{100, -1}}, {imm(kLoadInt, kR0, 6), imm(kLoadInt, kR1, 7), imm(kCall, 0, 0), bc(kMove, 0, kR1), imm(kReturn)},
                        {bc(kMul, 1, 0, 1), imm(kReturn)});
  CHECK(bench.local_after_run(0) == 42);
  CHECK(bench.thread.top_program().program->number == 1);
}

TEST_CASE("call: a label, and a missing label that means the top", "[calls]") {
  const auto result = [](std::int64_t label) {
    Bench bench = calling({{100, label}}, {imm(kCall, 0, 0), bc(kMove, 0, kR0), imm(kReturn)},
                          {imm(kLoadInt, 0, 1), imm(kReturn), imm(kLoadInt, 0, 2), imm(kReturn)});
    bench.module.programs[1].labels = {{456000, 2}};
    return bench.local_after_run(0);
  };
  CHECK(result(-1) == 1);
  CHECK(result(456000) == 2);
  CHECK(result(456001) == 1);
}

TEST_CASE("call computed: the fraction times a million is the label", "[calls]") {
  const auto run = [](double target) {
    Bench bench = calling({}, {imm(kLoadConst, 4, 0), imm(kCallComputed, 4), bc(kMove, 0, kR0), imm(kReturn)},
                          {imm(kLoadInt, 0, 1), imm(kReturn), imm(kLoadInt, 0, 2), imm(kReturn)});
    bench.module.constants = {target};
    bench.module.programs[1].labels = {{456000, 2}};
    const RunResult result = bench.run();
    return result.fault ? result.fault->detail : std::to_string(static_cast<int>(bench.thread.local(0)));
  };
  CHECK(run(100) == "1");
  CHECK(run(100.456) == "2");
  CHECK(run(100.4560000001) == "2");
  CHECK(run(100.5) == "1");
  CHECK(run(101) == "subprogram 101 does not exist");
  CHECK(run(-5) == "the number of the called subprogram is not in the range 0 to 4294967295");
  CHECK(run(1e300) == "the number of the called subprogram is not in the range 0 to 4294967295");
  CHECK(run(std::numeric_limits<double>::quiet_NaN()) == "the number of the called subprogram is not in the range 0 to 4294967295");
}

TEST_CASE("call of a subprogram that does not exist is a fault at the call", "[calls]") {
  Bench bench({imm(kNop), imm(kCall, 0, 0), imm(kReturn)});
  bench.module.call_targets = {{55, -1}};
  CHECK(bench.fault_of_run() == "test.pmc:2: subprogram 55 does not exist");
}

TEST_CASE("a fault in a subprogram names its line there", "[calls]") {
  Bench bench = calling({{100, -1}}, {imm(kCall, 0, 0), imm(kReturn)},
                        {imm(kNop), imm(kNop), imm(kLoadInt, 4, -9), bc(kLoadIndexed, 0, 4, 0), imm(kReturn)});
  CHECK(bench.fault_of_run().substr(0, 11) == "test.pmc:4:");
}

TEST_CASE("locals of a routine that are no arguments are 0 at every call", "[calls]") {
  // The routine adds 1 to its L3 (no argument: only R0 is passed) and returns it in L0.
  Bench bench = calling({{100, -1}}, {imm(kCall, 0, 0), imm(kCall, 0, 0), bc(kMove, 0, kR0), imm(kReturn)},
                        {imm(kLoadInt, 4, 1), bc(kAdd, 3, 3, 4), bc(kMove, 0, 3), imm(kReturn)});
  bench.module.programs[0].outgoing_count = 1;
  CHECK(bench.local_after_run(0) == 1);
}

TEST_CASE("recursion: 10 factorial, each depth with a frame of its own", "[calls]") {
  // L0 = n. if n < 2 return 1 in L0, else R0 = n - 1, callsub, L0 = n * R0.
  Bench bench({imm(kLoadInt, kR0, 10), imm(kCallsub, 0, 4), bc(kMove, 0, kR0), imm(kReturn),
               imm(kLoadInt, 4, 2), bc(kLess, 5, 0, 4), imm(kJumpIfFalse, 5, 9), imm(kLoadInt, 0, 1), imm(kReturn),
               imm(kLoadInt, 4, 1), bc(kSub, kR0, 0, 4), imm(kCallsub, 0, 4), bc(kMul, 0, 0, kR0), imm(kReturn)});
  CHECK(bench.local_after_run(0) == 3628800);
}

TEST_CASE("calls nested deeper than 255 are a fault", "[calls]") {
  for (const Opcode op : {kGosub, kCallsub}) {
    Bench bench({imm(kNop), imm(op, 0, 0), imm(kReturn)});
    CHECK(bench.fault_of_run() == "test.pmc:2: calls are nested deeper than 255");
  }
}
