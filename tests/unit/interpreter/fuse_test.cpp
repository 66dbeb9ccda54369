#include "runtime/interpreter/fuse.h"

#include <catch2/catch.hpp>
#include <cstring>
#include <random>
#include <set>

#include "tests/unit/interpreter/recording_host.h"

using namespace pmac::test;
using pmac::runtime::fuse;
using enum pmac::bytecode::Opcode;

namespace {

/// Programs of nothing but instructions that can be fused, with few registers and variables so that they meet.
std::vector<Instruction> fusible_code(std::mt19937& random) {
  static constexpr Opcode kOps[] = {kLoadInt, kLoadConst, kLoadP, kLoadP, kAdd, kSub, kMul, kDiv, kStoreP, kStoreP,
                                    kEqual, kNotEqual, kLess, kLessEqual, kJumpIfTrue, kJumpIfFalse, kLoopIfTrue};
  const auto below = [&](unsigned limit) { return static_cast<unsigned>(random() % limit); };
  const unsigned size = 5 + below(40);
  std::vector<Instruction> code;
  for (unsigned pc = 0; pc + 1 < size; ++pc) {
    const Opcode op = kOps[below(std::size(kOps))];
    switch (opcode_info(op).format) {
      case OperandFormat::kRegRegReg: code.push_back(bc(op, below(5), below(5), below(5))); break;
      case OperandFormat::kRegJump: code.push_back(imm(op, below(5), static_cast<int>(pc + 1 + below(size - pc - 1)))); break;
      case OperandFormat::kRegLoop: code.push_back(imm(op, below(5), static_cast<int>(below(pc + 1)))); break;
      default: code.push_back(imm(op, below(5), static_cast<int>(below(4)))); break;
    }
  }
  code.push_back(imm(kReturn));
  return code;
}

Bench fusible_bench() {
  Bench bench({imm(kReturn)});
  bench.module.constants = {0.5, -2, 3, 1e9};
  bench.module.programs[0].lines.clear();
  for (std::uint32_t pc = 0; pc < 5; ++pc) bench.module.programs[0].lines.push_back({pc, {0, static_cast<int>(pc), 1}});
  return bench;
}

/// Everything that can be seen of a run, bit by bit.
struct Trace {
  std::vector<std::uint64_t> facts;
  void add(double value) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    facts.push_back(value != value ? 0x7ff8000000000000u : bits);
  }
};

Trace trace_of(const std::shared_ptr<const Module>& module) {
  RecordingHost host;
  static std::vector<double> p(kPCount), q(kQCount);
  std::fill(p.begin(), p.begin() + 4, 0.0);  // the programs use no others
  Thread thread(p.data(), q.data());
  thread.begin({module, &module->programs[0]});
  Trace trace;
  for (int i = 0; i < 20; ++i) {
    const RunResult result = thread.run(host, 40, 7);
    if (i % 3 == 0) thread.reset_jump_backs();
    trace.facts.push_back(static_cast<std::uint64_t>(result.stop));
    trace.facts.push_back(result.instructions);
    trace.facts.push_back(static_cast<std::uint64_t>(thread.source().line));
  }
  for (int i = 0; i < 4; ++i) trace.add(p[static_cast<std::size_t>(i)]);
  for (int i = 0; i < 4; ++i) trace.add(thread.local(i));
  return trace;
}

}  // namespace

TEST_CASE("fusing: the longest sequence is taken, at every place, and nothing moves", "[fuse]") {
  Bench bench({imm(kLoadP, 4, 1), imm(kLoadInt, 5, 1), bc(kAdd, 4, 4, 5), imm(kStoreP, 4, 1), imm(kReturn)});
  const std::vector<Instruction> plain = bench.module.programs[0].code;
  fuse(bench.module);
  const std::vector<Instruction>& fused = bench.module.programs[0].code;
  using pmac::runtime::FusedOpcode;
  CHECK(fused[0].op == static_cast<Opcode>(FusedOpcode::kLoadPLoadIntAddStoreP));
  CHECK(fused[1].op == static_cast<Opcode>(FusedOpcode::kLoadIntAddStoreP));
  CHECK(fused[2].op == static_cast<Opcode>(FusedOpcode::kAddStoreP));
  CHECK(fused[3] == plain[3]);
  for (std::size_t pc = 0; pc < plain.size(); ++pc) {
    CHECK(fused[pc].a == plain[pc].a);
    CHECK(fused[pc].imm == plain[pc].imm);
  }
}

TEST_CASE("fusing: the module cannot come out of a file", "[fuse]") {
  Bench bench({imm(kLoadInt, 5, 1), bc(kAdd, 4, 4, 5), imm(kReturn)});
  CHECK(verify(bench.module).empty());
  fuse(bench.module);
  CHECK(verify(bench.module) != "");
}

TEST_CASE("fusing: fused programs do exactly what the plain ones do", "[fuse]") {
  std::mt19937 random(21);
  Bench bench = fusible_bench();
  for (int round = 0; round < 20000; ++round) {
    bench.module.programs[0].code = fusible_code(random);
    REQUIRE(verify(bench.module) == "");
    Module fused = bench.module;
    fuse(fused);
    const Trace plain_trace = trace_of(std::make_shared<const Module>(bench.module));
    const Trace fused_trace = trace_of(std::make_shared<const Module>(fused));
    if (plain_trace.facts != fused_trace.facts) FAIL("round " << round << "\n" << disassemble(bench.module));
  }
  SUCCEED();
}

TEST_CASE("fusing: every sequence of the table occurs in the random programs", "[fuse]") {
  std::mt19937 random(21);
  std::set<Opcode> seen;
  Bench bench = fusible_bench();
  for (int round = 0; round < 20000; ++round) {
    bench.module.programs[0].code = fusible_code(random);
    fuse(bench.module);
    for (const Instruction& in : bench.module.programs[0].code) {
      if (in.op >= kCount) seen.insert(in.op);
    }
  }
  CHECK(seen.size() == static_cast<std::size_t>(pmac::runtime::FusedOpcode::kEnd) - static_cast<std::size_t>(kCount));
}
