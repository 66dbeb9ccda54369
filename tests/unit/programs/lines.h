// Lines of a motion program on four motors without limits, run in process.
#pragma once

#include "tests/unit/programs/bench.h"

namespace pmac::test {

inline std::string with_motors(const std::string& lines, const std::string& set_up) {
  std::string text = "&1\n#1->1000X\n#2->1000Y\n#3->1000Z\n#4->1000C\n";
  for (int m = 1; m <= 4; ++m) {
    const std::string motor = "Motor[" + std::to_string(m) + "].";
    text += motor + "MaxSpeed=1000 " + motor + "InvAmax=0 " + motor + "InvDmax=0\n";
  }
  return text + set_up + "\nopen prog 1\nlinear abs ta100 ts0 F10\n" + lines + "\nclose\n";
}

/// Four motors of 1000 mu/uu without limits; `lines` is program 1, which is run.
struct Lines : ProgramBench {
  explicit Lines(const std::string& lines, const std::string& set_up = "") : ProgramBench("lines.pmc", with_motors(lines, set_up)) { run("&1 b1r"); }
};

inline double last(const ProgramBench& bench, int motor) { return bench.motor_mu.back()[static_cast<std::size_t>(motor)] / 1000; }

/// A variable after the run.
inline double value_of(ProgramBench& bench, const std::string& name) {
  bench.machine->command(name);
  REQUIRE(!bench.answers.empty());
  return std::stod(bench.answers.back().substr(name.size() + 1));
}

}  // namespace pmac::test
