#include <catch2/catch.hpp>

#include "tests/unit/interpreter/recording_host.h"

using namespace pmac::test;
using enum pmac::bytecode::Opcode;

namespace {
/// while (1) { L0 = L0 + 1 }
Bench endless() { return Bench({imm(kLoadInt, 4, 1), bc(kAdd, 0, 0, 4), imm(kLoop, 0, 1)}); }
}  // namespace

TEST_CASE("jump-back limit: the jump that reaches it is made, then the run stops", "[stops]") {
  Bench bench = endless();
  CHECK(bench.run(1000, 3).stop == RunStop::kJumpBack);
  CHECK(bench.thread.local(0) == 3);
  CHECK(bench.thread.source().line == 2);  // stands at the top of the loop
  // Not reset: every further jump stops.
  CHECK(bench.run(1000, 3).stop == RunStop::kJumpBack);
  CHECK(bench.thread.local(0) == 4);
  bench.thread.reset_jump_backs();
  CHECK(bench.run(1000, 3).stop == RunStop::kJumpBack);
  CHECK(bench.thread.local(0) == 7);
}

TEST_CASE("jump-back limit: conditional loops count when taken, gotos when backward", "[stops]") {
  Bench conditional({imm(kLoadInt, 4, 1), imm(kLoopIfTrue, 5, 0), imm(kLoopIfTrue, 4, 0), imm(kReturn)});
  CHECK(conditional.run(1000, 2).stop == RunStop::kJumpBack);
  Bench labels({imm(kLoadInt, 4, 10), imm(kLoadInt, 5, 20), imm(kGotoLabel, 5), imm(kNop), bc(kAdd, 0, 0, 4),
                imm(kGotoLabel, 4), imm(kReturn)});
  labels.module.programs[0].labels = {{10, 0}, {20, 4}};
  CHECK(labels.run(1000, 2).stop == RunStop::kJumpBack);
  CHECK(labels.thread.local(0) == 20);
}

TEST_CASE("jump-back limit: calls and returns do not count", "[stops]") {
  Bench bench({imm(kGosub, 0, 3), imm(kGosub, 0, 3), imm(kReturn), imm(kReturn)});
  CHECK(bench.run(1000, 1).stop == RunStop::kEnded);
}

TEST_CASE("budget: an endless loop stops near it and goes on", "[stops]") {
  Bench bench = endless();
  std::uint64_t total = 0;
  for (int i = 0; i < 10; ++i) {
    const RunResult result = bench.run(100);
    CHECK(result.stop == RunStop::kBudget);
    CHECK(result.instructions >= 100);
    CHECK(result.instructions < 104);
    total += result.instructions;
  }
  CHECK(total == 1 + 2 * static_cast<std::uint64_t>(bench.thread.local(0)));
}

TEST_CASE("budget: endless recursion of gosubs and endless calls end", "[stops]") {
  Bench bench({imm(kGosub, 0, 2), imm(kReturn), imm(kGosub, 0, 4), imm(kLoop, 0, 2), imm(kReturn)});
  CHECK(bench.run(500).stop == RunStop::kBudget);
}

TEST_CASE("budget 0 does nothing", "[stops]") {
  Bench bench = endless();
  const RunResult result = bench.run(0);
  CHECK(result.stop == RunStop::kBudget);
  CHECK(result.instructions == 0);
}

TEST_CASE("the largest budget is no overflow", "[stops]") {
  Bench bench({imm(kReturn)});
  CHECK(bench.run(~std::uint64_t{0}).stop == RunStop::kEnded);
}

TEST_CASE("instructions are counted exactly", "[stops]") {
  Bench bench({imm(kLoadInt, 4, 1), imm(kJumpIfTrue, 4, 3), imm(kNop), imm(kGosub, 0, 5), imm(kReturn), imm(kNop), imm(kReturn)});
  CHECK(bench.run().instructions == 6);
}

TEST_CASE("suspension: the next run continues behind the instruction", "[stops]") {
  Bench bench({imm(kDwell, 0), imm(kLoadInt, 0, 5), imm(kReturn)});
  bench.host.answer = Flow::kSuspend;
  const RunResult first = bench.run();
  CHECK(first.stop == RunStop::kSuspended);
  CHECK(first.instructions == 1);
  CHECK(bench.thread.local(0) == 0);
  CHECK(bench.thread.source().line == 2);
  CHECK(bench.run().stop == RunStop::kEnded);
  CHECK(bench.thread.local(0) == 5);
  CHECK(bench.host.log.size() == 1);
}

TEST_CASE("Flow::kStop ends the program, Flow::kFault faults with the host's words", "[stops]") {
  Bench stop({imm(kDwell, 0), imm(kReturn)});
  stop.host.answer = Flow::kStop;
  CHECK(stop.run().stop == RunStop::kEnded);
  CHECK_FALSE(stop.thread.active());

  Bench fault({imm(kNop), imm(kBlockEnd), imm(kReturn)});
  fault.host.answer = Flow::kFault;
  fault.begin();
  fault.thread.set_host_fault({pmac::runtime::FaultKind::kBadTarget, {}, "target of axis X is not finite"});
  const RunResult result = fault.thread.run(fault.host, 100, 0);
  REQUIRE(result.fault);
  CHECK(result.stop == RunStop::kFault);
  CHECK(result.fault->kind == pmac::runtime::FaultKind::kBadTarget);
  CHECK(result.fault->source.line == 2);
  CHECK_FALSE(fault.thread.active());
}

TEST_CASE("a host may stop the thread from inside a statement", "[stops]") {
  Bench bench({imm(kGosub, 0, 1), imm(kBlockEnd), imm(kLoadInt, 0, 9), imm(kReturn)});
  bench.host.stops_thread = true;
  CHECK(bench.run().stop == RunStop::kEnded);
  CHECK(bench.thread.local(0) == 0);
}
