// The grammar reads every text in one way only. ANTLR's exact analysis says so for texts that people write: the programs of the
// course, and the small ones that show each construct. A list of further files can be given in PMAC_GRAMMAR_FILES (colons between).
#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

#include "compiler/frontend/power_pmac/frontend.h"
#include "compiler/source/source.h"

namespace {

namespace fs = std::filesystem;

bool is_script(const fs::path& path) {
  const std::string kind = path.extension().string();
  return kind == ".pmc" || kind == ".plc" || kind == ".pmh" || kind == ".kin";
}

std::vector<fs::path> scripts_below(const fs::path& folder) {
  std::vector<fs::path> found;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file() && is_script(entry.path())) found.push_back(entry.path());
  std::sort(found.begin(), found.end());
  return found;
}

void check_one_way(const std::vector<fs::path>& files) {
  REQUIRE_FALSE(files.empty());
  for (const fs::path& file : files) {
    pmac::source::SourceManager sources;
    pmac::source::Diagnostics diagnostics;
    const std::vector<std::string> folders = {file.parent_path().string()};
    pmac::compiler::power_pmac::Frontend frontend(sources, diagnostics, folders);
    std::ifstream stream(file, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    for (const std::string& ambiguity : frontend.ambiguities(file.string(), text)) FAIL_CHECK(file.string() << ":" << ambiguity);
  }
}

}  // namespace

TEST_CASE("the grammar is not ambiguous on the programs of the course", "[grammar]") { check_one_way(scripts_below(PMAC_SOURCE_DIR "/programs")); }

TEST_CASE("the grammar is not ambiguous on the programs that show each construct, right and wrong ones", "[grammar]") { check_one_way(scripts_below(PMAC_SOURCE_DIR "/tests/golden")); }

TEST_CASE("the grammar is not ambiguous on further files", "[grammar]") {
  const char* list = std::getenv("PMAC_GRAMMAR_FILES");
  if (!list) return;
  std::istringstream names(list);
  std::vector<fs::path> files;
  for (std::string name; std::getline(names, name, ':');) files.emplace_back(name);
  check_one_way(files);
}
