#include "compiler/bytecode/opcode.h"
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

/// Random programs of nothing but instructions that can be fused, with few registers and variables so that they meet. Half
/// of the code is expressions and conditions as a compiler writes them, some with one register changed.
class FusibleCode {
 public:
  explicit FusibleCode(std::mt19937& random) : random_(random) {}

  std::vector<Instruction> make() {
    code_.clear();
    size_ = 8 + below(40);
    while (code_.size() + 1 < size_) below(2) == 0 ? add(any()) : add_expression();
    code_.push_back(imm(kReturn));
    return code_;
  }

 private:
  static constexpr Opcode kLoads[] = {kLoadInt, kLoadConst, kLoadP};
  static constexpr Opcode kOperations[] = {kAdd, kSub, kMul, kDiv, kEqual, kNotEqual, kLess, kLessEqual};
  static constexpr Opcode kUsers[] = {kStoreP, kJumpIfTrue, kJumpIfFalse, kLoopIfTrue};

  unsigned below(unsigned limit) { return static_cast<unsigned>(random_() % limit); }
  Instruction load(unsigned reg, Opcode op) { return imm(op, reg, static_cast<int>(below(4))); }
  Instruction user(unsigned reg) {
    const Opcode op = kUsers[below(4)];
    const auto pc = static_cast<unsigned>(code_.size());
    if (op == kLoopIfTrue) return imm(op, reg, static_cast<int>(below(pc + 1)));
    if (op == kStoreP || pc + 2 > size_) return imm(kStoreP, reg, static_cast<int>(below(4)));
    return imm(op, reg, static_cast<int>(pc + 1 + below(size_ - pc - 1)));
  }
  Instruction operation() { return bc(kOperations[below(8)], below(5), below(5), below(5)); }
  Instruction any() {
    const unsigned kind = below(3);
    return kind == 0 ? load(below(5), kLoads[below(3)]) : kind == 1 ? operation() : user(below(5));
  }
  void add(Instruction in) {
    if (code_.size() + 1 < size_) code_.push_back(in);
  }
  void add_expression() {
    const unsigned first = below(5), second = below(5), result = below(5), loads = below(3);
    if (loads == 2) add(load(first, kLoadP));
    if (loads >= 1) add(load(second, kLoads[below(3)]));
    const Instruction plain = operation();
    add(bc(plain.op, result, below(8) == 0 ? below(5) : first, below(8) == 0 ? below(5) : second));
    add(below(3) == 0 ? operation() : user(below(8) == 0 ? below(5) : result));
  }

  std::mt19937& random_;
  std::vector<Instruction> code_;
  unsigned size_ = 0;
};

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
    bench.module.programs[0].code = FusibleCode(random).make();
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
    bench.module.programs[0].code = FusibleCode(random).make();
    fuse(bench.module);
    for (const Instruction& in : bench.module.programs[0].code) {
      if (in.op >= kCount) seen.insert(in.op);
    }
  }
  CHECK(seen.size() == static_cast<std::size_t>(pmac::runtime::FusedOpcode::kEnd) - static_cast<std::size_t>(kCount));
}

TEST_CASE("unfusing gives back the plain instructions", "[fuse]") {
  std::mt19937 random(23);
  for (int i = 0; i < 200; ++i) {
    Module module;
    module.programs.emplace_back().code = FusibleCode(random).make();
    const std::vector<Instruction> plain = module.programs[0].code;
    fuse(module);
    pmac::runtime::unfuse(module.programs[0]);
    REQUIRE(module.programs[0].code == plain);
  }
}
