#include <catch2/catch.hpp>
#include <limits>

#include "compiler/bytecode/function.h"
#include "compiler/bytecode/opcode.h"
#include "tests/unit/interpreter/recording_host.h"

using namespace pmac::test;
using enum pmac::bytecode::Opcode;

TEST_CASE("binary instructions agree with the operators they are named for", "[interpreter]") {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInf = std::numeric_limits<double>::infinity();
  const double values[] = {0, 1, -1, 3, -3, 2.5, 7, 10.3, -10.3, 1e18, -1e18, 1e300, kInf, -kInf, kNan};
  for (int op = static_cast<int>(kAdd); op <= static_cast<int>(kNear); ++op) {
    const auto opcode = static_cast<Opcode>(op);
    if (opcode == kNeg || opcode == kBitNot) continue;
    for (const double left : values) {
      for (const double right : values) {
        Bench bench({imm(kLoadConst, 4, 0), imm(kLoadConst, 5, 1), bc(opcode, 0, 4, 5), imm(kReturn)});
        bench.module.constants = {left, right};
        const double result = bench.local_after_run(0);
        const double expected = apply_binary(opcode, left, right);
        INFO(opcode_info(opcode).text << " " << left << " " << right);
        CHECK((result == expected || (std::isnan(result) && std::isnan(expected))));
      }
    }
  }
}

TEST_CASE("unary instructions", "[interpreter]") {
  Bench bench({imm(kLoadInt, 4, 5), bc(kNeg, 0, 4), bc(kBitNot, 1, 4), bc(kLogicalNot, 2, 4), bc(kLogicalNot, 3, 2),
               imm(kReturn)});
  bench.run();
  CHECK(bench.thread.local(0) == -5);
  CHECK(bench.thread.local(1) == -6);
  CHECK(bench.thread.local(2) == 0);
  CHECK(bench.thread.local(3) == 1);
}

TEST_CASE("functions take their arguments from consecutive registers", "[interpreter]") {
  Bench bench({imm(kLoadInt, 4, 2), imm(kLoadInt, 5, 3), imm(kLoadInt, 6, 4),
               bc(kFunction, 0, static_cast<unsigned>(Function::kMadd), 4), bc(kFunction, 1, static_cast<unsigned>(Function::kPow), 4),
               imm(kReturn)});
  CHECK(bench.local_after_run(0) == 10);  // 2 * 3 + 4
  CHECK(bench.thread.local(1) == 8);
}
