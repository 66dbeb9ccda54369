// What set-up files say that the simulation cannot do, and what a reset leaves alone.
#include <algorithm>

#include "tests/unit/programs/lines.h"

using namespace pmac::test;

TEST_CASE("a gantry follower of ServoCtrl 8 is said not to be simulated", "[programs][set_up]") {
  const Lines follower("X1", "Motor[2].ServoCtrl=8 Motor[2].CmdMotor=1"), plain("X1", "Motor[2].ServoCtrl=1");
  CHECK(std::count_if(follower.warnings.begin(), follower.warnings.end(), [](const std::string& text) {
          return text.find("Motor[2].ServoCtrl = 8 makes a gantry follower of Motor[2].CmdMotor, which is not simulated") != std::string::npos;
        }) == 1);
  CHECK(plain.warnings.empty());
}

TEST_CASE("a reset leaves the machine around the controller as it is", "[programs][set_up]") {
  Lines bench("X1", "Sim.Motor[1].TriggerPos=5000 Sim.Motor[2].Plant=1 Motor[1].JogSpeed=77");
  for (const char* reset : {"$$$", "$$$***"}) {
    bench.machine->command(reset);
    CHECK(value_of(bench, "Sim.Motor[1].TriggerPos") == 5000);
    CHECK(value_of(bench, "Sim.Motor[2].Plant") == 1);
    CHECK(value_of(bench, "Motor[1].JogSpeed") == 32);   // the factory's
  }
}
