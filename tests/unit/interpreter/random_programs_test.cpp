// Whatever verify() accepts must run without crashing; the sanitizers look on.
#include <catch2/catch.hpp>

#include "tests/reference/random_module.h"
#include "tests/unit/interpreter/recording_host.h"

using namespace pmac::test;

namespace {

struct Machine {
  RecordingHost host;
  std::vector<double> p = std::vector<double>(kPCount);
  std::vector<double> q = std::vector<double>(kQCount);

  /// Runs every program of the module; returns the instructions executed.
  std::uint64_t run_all(const Module& module) {
    auto shared = std::make_shared<const Module>(module);
    std::uint64_t instructions = 0;
    for (const auto element : {ElementId::kCoordGprog, ElementId::kCoordMprog, ElementId::kCoordTprog, ElementId::kCoordFprog}) host.elements[{element, 0}] = 1;
    for (const Program& program : shared->programs) host.subprograms[program.number] = {shared, &program};
    for (const Program& program : shared->programs) instructions += run({shared, &program});
    return instructions;
  }

 private:
  std::uint64_t run(ProgramHandle program) {
    Thread thread(p.data(), q.data());
    thread.begin(std::move(program));
    std::uint64_t instructions = 0;
    for (int i = 0; i < 8; ++i) {
      const RunResult result = thread.run(host, 500, 20);
      thread.reset_jump_backs();
      instructions += result.instructions;
      host.log.clear();
    }
    return instructions;
  }
};

}  // namespace

TEST_CASE("random sound modules run", "[random]") {
  Machine machine;
  std::uint64_t instructions = 0;
  for (std::uint32_t seed = 0; seed < 1000; ++seed) instructions += machine.run_all(pmac::reference::random_module(seed));
  CHECK(instructions > 100000);
}

TEST_CASE("damaged modules are refused or run", "[random]") {
  Machine machine;
  std::mt19937 random(17);
  int refused = 0;
  for (std::uint32_t seed = 0; seed < 4000; ++seed) {
    Module module = pmac::reference::random_module(seed);
    for (auto i = 1 + random() % 3; i > 0; --i) pmac::reference::damage(module, random);
    if (verify(module).empty()) {
      machine.run_all(module);
    } else {
      ++refused;
    }
  }
  CHECK(refused > 500);
  CHECK(refused < 3900);
}
