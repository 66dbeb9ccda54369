// random_programs COUNT FOLDER: writes COUNT random motion programs (motion_1.pmc, ...) and as many of computed expressions and control
// flow (script_1.pmc, ...), program 1 of each. The same texts on every machine.
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <string>

#include "tests/reference/random_motion_spec.h"
#include "tests/reference/random_program.h"

namespace {

using namespace pmac::reference;

bool write(const std::string& path, const std::string& text) {
  std::ofstream out(path, std::ios::binary);
  out << text;
  return static_cast<bool>(out.flush());
}

}  // namespace

int main(int argc, char** argv) {
  const int count = argc == 3 ? std::atoi(argv[1]) : 0;
  if (count <= 0) {
    std::cerr << "usage: random_programs COUNT FOLDER\n";
    return 2;
  }
  for (int seed = 1; seed <= count; ++seed) {
    const std::string folder = argv[2], name = std::to_string(seed) + ".pmc";
    const auto number = static_cast<std::uint32_t>(seed);
    const bool written = write(folder + "/motion_" + name, random_motion(random_motion_spec(number)).text) &&
                         write(folder + "/script_" + name, to_script(random_program(number)));
    if (!written) {
      std::cerr << "random_programs: cannot write into " << folder << "\n";
      return 2;
    }
  }
  return 0;
}
