// How fast programs calculate: a loop of four assignments and a test, on local and on P variables, compiled from script,
// against the same loops in Lua 5.4 (an interpreter known to be fast). Goals: 1.5 times Lua on locals, 4 times on P variables.
// And the inverse kinematic routine of a SCARA, per call; goal: 1.3 times Lua.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <map>
#include <string>

#include "compiler/compiler.h"
#include "runtime/interpreter/fuse.h"
#include "tests/unit/interpreter/recording_host.h"

namespace {

using namespace pmac::test;

constexpr double kPasses = 1e6;
constexpr int kRuns = 20;

struct Loop { const char* name; const char* script; };

constexpr Loop kLoops[] = {
    {"locals",
     "open prog 1\nlocal a, b, c, d, n;\nn = 1000000;\n"
     "while (a < n) { a = a + 1; b = b + a; c = b * 2; d = c - b; }\nclose\n"},
    {"globals",
     "open prog 1\nP1 = 0; P5 = 1000000;\n"
     "while (P1 < P5) { P1 = P1 + 1; P2 = P2 + P1; P3 = P2 * 2; P4 = P3 - P2; }\nclose\n"},
};

constexpr const char* kScara =
    "global UpperArm = 400; global Forearm = 300; global Vertical = 250;\nopen inverse (1)\nlocal Distance2, CosElbow, CosShoulder;\n"
    "Distance2 = KinPosAxisX * KinPosAxisX + KinPosAxisY * KinPosAxisY;\n"
    "CosElbow = (Distance2 - UpperArm * UpperArm - Forearm * Forearm) / (2 * UpperArm * Forearm);\n"
    "if (abs(CosElbow) > 1) Coord[1].ErrorStatus = 255;\nKinPosMotor2 = acosd(CosElbow);\n"
    "CosShoulder = (Distance2 + UpperArm * UpperArm - Forearm * Forearm) / (2 * UpperArm * sqrt(Distance2));\n"
    "KinPosMotor1 = atan2d(KinPosAxisY, KinPosAxisX) - acosd(CosShoulder);\n"
    "KinPosMotor3 = KinPosAxisC - KinPosMotor1 - KinPosMotor2;\nKinPosMotor4 = KinPosAxisZ - Vertical;\nclose\n";

ProgramHandle compiled(const char* script) {
  pmac::compiler::Session session;
  std::optional<Module> module = session.compile({{"loop.pmc", script}});
  if (!module) throw std::runtime_error("the loop does not compile");
  pmac::runtime::fuse(*module);
  auto shared = std::make_shared<const Module>(std::move(*module));
  for (const Program& program : shared->programs) {
    if (program.kind == ProgramKind::kProg || program.kind == ProgramKind::kInverse) return {shared, &program};
  }
  throw std::runtime_error("the loop is no program");
}

/// Nanoseconds a pass and instructions a second, best of kRuns.
std::pair<double, double> measured(const ProgramHandle& program) {
  std::vector<double> p(kPCount), q(kQCount);
  RecordingHost host;
  double best_s = 1e9;
  double instructions = 0;
  for (int run = 0; run < kRuns; ++run) {
    Thread thread(p.data(), q.data());
    thread.begin(program);
    const auto start = std::chrono::steady_clock::now();
    instructions = static_cast<double>(thread.run(host, ~std::uint64_t{0}, 0).instructions);
    best_s = std::min(best_s, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  return {best_s / kPasses * 1e9, instructions / best_s};
}

/// Nanoseconds a pass of each loop in Lua; empty without Lua.
std::map<std::string, double> lua_times() {
  std::map<std::string, double> times;
  std::FILE* lua = ::popen("lua5.4 " PMAC_BENCH_DIR "/interpreter_loops.lua 2>/dev/null", "r");
  if (lua == nullptr) return times;
  char name[32];
  double time_ns = 0;
  while (std::fscanf(lua, "%31s %lf", name, &time_ns) == 2) times[name] = time_ns;
  ::pclose(lua);
  return times;
}

/// Nanoseconds of a call of the inverse routine, over positions that change.
double measured_calls(const ProgramHandle& inverse) {
  constexpr int kCalls = 200'000;
  std::vector<double> p(kPCount), q(kQCount);
  p[8192] = 400, p[8193] = 300, p[8194] = 250;
  RecordingHost host;
  Thread thread(p.data(), q.data());
  double best_s = 1e9, sum = 0;
  for (int run = 0; run < kRuns; ++run) {
    const auto start = std::chrono::steady_clock::now();
    for (int call = 0; call < kCalls; ++call) {
      thread.begin(inverse);
      thread.c[6] = 450 + 1e-4 * call;   // X
      thread.c[7] = -100 + 2e-4 * call;  // Y
      thread.c[8] = 200;                 // Z
      thread.c[2] = 10;                  // C
      thread.run(host, 1'000'000, 11);
      sum += thread.local(1);
    }
    best_s = std::min(best_s, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  if (!(sum < 0)) std::printf("  scara: wrong angles\n");
  return best_s / kCalls * 1e9;
}

}  // namespace

int main() {
  const std::map<std::string, double> lua = lua_times();
  std::printf("interpreter: loop of four assignments and a test, best of %d\n", kRuns);
  for (const Loop& loop : kLoops) {
    const auto [time_ns, rate] = measured(compiled(loop.script));
    std::printf("  %-8s %6.2f ns a pass, %5.0f M instructions/s", loop.name, time_ns, rate / 1e6);
    const auto peer = lua.find(loop.name);
    if (peer == lua.end()) std::printf(", lua5.4 not found\n");
    else std::printf(", lua5.4 %6.2f ns: %.1f times as fast\n", peer->second, peer->second / time_ns);
  }
  const double call_ns = measured_calls(compiled(kScara));
  const auto peer = lua.find("scara");
  std::printf("  %-8s %6.1f ns a call", "scara", call_ns);
  if (peer == lua.end()) std::printf(", lua5.4 not found\n");
  else std::printf(", lua5.4 %6.1f ns: %.1f times as fast\n", peer->second, peer->second / call_ns);
}
