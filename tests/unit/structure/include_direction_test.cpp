// Who may include whom. The table is the one of docs/design.md; the test reads the #include lines of every source.
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

struct Rule {
  std::string folder;                       // sources below it; the first rule that fits counts
  std::vector<std::string> own;             // own headers it may include, by prefix
  std::vector<std::string> third_party;     // other headers, by prefix; std headers have no slash and no dot
};

const std::vector<Rule>& rules() {
  static const std::vector<Rule> table = {
      {"compiler/source/", {"compiler/source/"}, {"fmt/", "nlohmann/"}},
      {"compiler/bytecode/", {"compiler/bytecode/", "compiler/source/"}, {"flatbuffers/", "object_file_generated.h", "fmt/"}},
      {"compiler/frontend/", {"compiler/"}, {"fmt/", "antlr4-runtime", "atn/", "PowerPmac", "Acr1000"}},
      {"compiler/project/", {"compiler/project/", "compiler/source/", "compiler/compiler.h"}, {"fmt/", "pugixml.hpp"}},
      {"compiler/tool/", {"compiler/"}, {"fmt/", "nlohmann/", "CLI/", "unistd.h"}},
      {"compiler/", {"compiler/"}, {"fmt/"}},
      {"kinematics/", {"kinematics/"}, {"Eigen/"}},
      {"runtime/tool/", {"runtime/", "compiler/", "kinematics/"}, {"fmt/", "nlohmann/", "CLI/", "Eigen/", "unistd.h", "poll.h"}},
      {"runtime/pmac_run.cpp", {"runtime/", "compiler/", "kinematics/"}, {"fmt/", "CLI/", "unistd.h"}},
      {"runtime/pmac_silverlode.cpp", {"runtime/"}, {}},
      {"runtime/gather/", {"runtime/"}, {"fmt/", "nlohmann/", "unistd.h", "sys/", "fcntl.h", "immintrin.h"}},
      {"runtime/", {"runtime/", "kinematics/", "compiler/bytecode/"}, {"fmt/", "Eigen/"}},
  };
  return table;
}

bool starts_with_any(const std::string& text, const std::vector<std::string>& prefixes) {
  for (const std::string& prefix : prefixes)
    if (text.rfind(prefix, 0) == 0) return true;
  return false;
}

bool is_standard(const std::string& header) {
  return header.find('/') == std::string::npos && header.find('.') == std::string::npos;
}

const Rule* rule_for(const std::string& file) {
  for (const Rule& rule : rules())
    if (file.rfind(rule.folder, 0) == 0) return &rule;
  return nullptr;
}

/// Header names of the #include lines.
std::vector<std::string> includes_of(const fs::path& path) {
  std::vector<std::string> headers;
  std::ifstream in(path);
  for (std::string line; std::getline(in, line);) {
    const std::size_t hash = line.find_first_not_of(" \t");
    if (hash == std::string::npos || line.compare(hash, 8, "#include") != 0) continue;
    const std::size_t open = line.find_first_of("<\"");
    const std::size_t close = line.find_first_of(">\"", open + 1);
    if (open != std::string::npos && close != std::string::npos) headers.push_back(line.substr(open + 1, close - open - 1));
  }
  return headers;
}

std::string violations_of(const fs::path& path, const std::string& name) {
  const Rule* rule = rule_for(name);
  if (rule == nullptr) return name + ": no rule for this folder\n";
  std::string bad;
  for (const std::string& header : includes_of(path)) {
    if (is_standard(header) || starts_with_any(header, rule->own) || starts_with_any(header, rule->third_party)) continue;
    bad += name + " includes " + header + "\n";
  }
  return bad;
}

}  // namespace

TEST_CASE("includes go only in the directions of the design", "[structure]") {
  const fs::path root = PMAC_SOURCE_DIR;
  std::string bad;
  int files = 0;
  for (const char* folder : {"compiler", "kinematics", "runtime"})
    for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
      const std::string extension = entry.path().extension().string();
      if (extension != ".cpp" && extension != ".h") continue;
      ++files;
      bad += violations_of(entry.path(), fs::relative(entry.path(), root).generic_string());
    }
  CHECK(files > 30);
  INFO(bad);
  CHECK(bad.empty());
}
