// Damaged project files: whatever stands in them, reading ends with messages.
#include <catch2/catch.hpp>
#include <random>

#include "tests/unit/project/project_files.h"

using namespace pmac::test;
using pmac::compiler::project::Unreadable;

namespace {

std::string damaged(std::string text, std::mt19937& random) {
  const auto below = [&](std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random); };
  for (std::size_t changes = 1 + below(6); changes > 0 && !text.empty(); --changes) {
    const std::size_t at = below(text.size());
    const std::size_t length = below(std::min<std::size_t>(40, text.size() - at) + 1);
    switch (below(4)) {
      case 0: text[at] = static_cast<char>(below(256)); break;
      case 1: text.erase(at, length); break;
      case 2: text.insert(at, text.substr(below(text.size()), length)); break;
      default: text.resize(at); break;
    }
  }
  return text;
}

void read_damaged(const std::string& name, const std::string& text) {
  const ProjectFolder folder;
  folder.write("PMAC Script Language/Libraries/l.pmc", "P1=1\n");
  std::mt19937 random(20240611);
  for (int round = 0; round < 400; ++round) {
    folder.write(name, damaged(text, random));
    try {
      const ReadProject read(folder.path(name));
      CHECK(read.project.files.size() <= 1);
    } catch (const Unreadable& refused) {
      CHECK(std::string(refused.what()).size() > 10);
    }
  }
}

}  // namespace

TEST_CASE("damaged .ppproj files end with a message", "[project][random]") {
  read_damaged("x.ppproj", ppproj(item("PMAC Script Language\\Libraries\\l.pmc", "0") + item("PMAC Script Language\\Libraries\\%6c.pmc", "99999999999999")));
}

TEST_CASE("damaged pp_proj.ini files end with a message", "[project][random]") {
  read_damaged("pp_proj.ini", "[PMAC_PROGRAMS]\nPVARSTART=8192\nfile1=/var/ftp/usrflash/Project/PMAC Script Language/Libraries/l.pmc\nlast_file_number=1\n");
}
