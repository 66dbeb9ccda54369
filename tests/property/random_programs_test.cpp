// Compiler and interpreter together mean what a slow walk over the program means: random structured programs, printed as
// script, compiled, executed plain and fused, and compared with tests/reference/random_program_walk.cpp.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "compiler/bytecode/object_file.h"
#include "compiler/compiler.h"
#include "runtime/interpreter/fuse.h"
#include "tests/reference/random_program.h"
#include "tests/unit/interpreter/recording_host.h"

using namespace pmac::test;
using pmac::reference::Outcome;
using pmac::reference::RandomProgram;

namespace {

constexpr std::size_t kFirstGlobal = 8192;   // P variable of the first name that is declared global

bool same(double left, double right) {
  return (std::isnan(left) && std::isnan(right)) || std::memcmp(&left, &right, sizeof left) == 0;
}

std::shared_ptr<const Module> compiled(const std::string& script) {
  pmac::compiler::Session session;
  auto module = session.compile({{"random.pmc", script}});
  if (!module) FAIL("does not compile:\n" << script);
  return std::make_shared<const Module>(std::move(*module));
}

Outcome outcome_of(const std::shared_ptr<const Module>& module) {
  RecordingHost host;
  std::vector<double> p(kPCount), q(kQCount);
  Thread thread(p.data(), q.data());
  for (const Program& program : module->programs) {
    if (program.kind == ProgramKind::kSubprog) host.subprograms[program.number] = {module, &program};
  }
  for (const Program& program : module->programs) {
    if (program.kind == ProgramKind::kProg) thread.begin({module, &program});
  }
  const RunResult result = thread.run(host, 5000000, 0);
  Outcome outcome;
  outcome.finished = result.stop == RunStop::kEnded;
  for (std::size_t i = 0; i < outcome.p.size(); ++i) outcome.p[i] = p[pmac::reference::kFirstP + i];
  for (std::size_t i = 0; i < outcome.q.size(); ++i) outcome.q[i] = q[pmac::reference::kFirstQ + i];
  for (std::size_t i = 0; i < outcome.m.size(); ++i) outcome.m[i] = host.m[static_cast<int>(pmac::reference::kFirstM + i)];
  for (std::size_t i = 0; i < outcome.row.size(); ++i) outcome.row[i] = p[kFirstGlobal + i];
  return outcome;
}

std::vector<double> variables_of(const Outcome& outcome) {
  std::vector<double> all(outcome.p.begin(), outcome.p.end());
  all.insert(all.end(), outcome.q.begin(), outcome.q.end());
  all.insert(all.end(), outcome.m.begin(), outcome.m.end());
  all.insert(all.end(), outcome.row.begin(), outcome.row.end());
  return all;
}

bool same(const Outcome& left, const Outcome& right) {
  const std::vector<double> a = variables_of(left), b = variables_of(right);
  return left.finished == right.finished && std::equal(a.begin(), a.end(), b.begin(), [](double x, double y) { return same(x, y); });
}

std::string text_of(const Outcome& outcome) {
  std::string text = outcome.finished ? "" : "not finished ";
  for (const double value : variables_of(outcome)) text += number_text(value) + " ";
  return text;
}

/// How many programs: PMAC_FUZZ_PROGRAMS, and the seed of the first one: PMAC_FUZZ_SEED.
std::uint32_t number_from(const char* variable, std::uint32_t otherwise) {
  const char* text = std::getenv(variable);
  return text == nullptr ? otherwise : static_cast<std::uint32_t>(std::strtoul(text, nullptr, 10));
}

}  // namespace

TEST_CASE("random programs: compiled and interpreted as the plain walk does it", "[property]") {
  const std::uint32_t first = number_from("PMAC_FUZZ_SEED", 1), count = number_from("PMAC_FUZZ_PROGRAMS", 2000);
  std::uint32_t compared = 0;
  for (std::uint32_t seed = first; seed < first + count; ++seed) {
    const RandomProgram program = pmac::reference::random_program(seed);
    const Outcome expected = pmac::reference::execute(program);
    if (!expected.finished) continue;
    const std::string script = to_script(program);
    const auto module = compiled(script);
    REQUIRE(verify(*module) == "");
    const Outcome plain = outcome_of(module);
    if (!same(plain, expected)) {
      FAIL("seed " << seed << "\nexpected " << text_of(expected) << "\nfound    " << text_of(plain) << "\n" << script);
    }
    Module fused = *module;
    pmac::runtime::fuse(fused);
    if (!same(outcome_of(std::make_shared<const Module>(fused)), expected)) FAIL("fused, seed " << seed << "\n" << script);
    ++compared;
  }
  CHECK(compared > count / 10 * 8);
}

TEST_CASE("random programs: the object file gives the same module", "[property]") {
  for (std::uint32_t seed = 1; seed <= 100; ++seed) {
    const auto module = compiled(to_script(pmac::reference::random_program(seed)));
    const auto bytes = save(*module);
    const auto loaded = load(bytes);
    REQUIRE(std::holds_alternative<Module>(loaded));
    CHECK(save(std::get<Module>(loaded)) == bytes);
  }
}
