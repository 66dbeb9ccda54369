// Runs every program below this folder as its first line says, `// run: pmacc --emit=ir`, and compares:
// (ACR1000 files are .acr, and their first line begins with `; run:`.)
//   <name>.pmc      standard output with <name>.expect
//   <name>.mcx      a register script; its first line is `; run: pmac-run --stats`
//   bad_<name>.pmc  exit code 1, and the errors with the comments `// error: text` of their lines, no more and no fewer
// In both, `// warning: text` comments are compared with the warnings. Arguments behind the tool are options; the program itself
// comes last, and <other> files may be named (they are looked up beside the program).
// PMAC_GOLDEN_REBASE=1 in the environment writes the .expect files anew; read the difference before believing it.
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

struct Ran { int exit_code; std::string out, err; };

std::string read_file(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Runs a command in the folder of the program.
Ran run(const std::string& command, const fs::path& folder) {
  const fs::path errors = fs::temp_directory_path() / ("golden_" + std::to_string(::getpid()) + ".err");
  const std::string line = "cd '" + folder.string() + "' && " + command + " 2> '" + errors.string() + "'";
  std::FILE* pipe = ::popen(line.c_str(), "r");
  Ran ran{-1, {}, {}};
  std::array<char, 4096> buffer{};
  for (std::size_t n = 0; (n = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) ran.out.append(buffer.data(), n);
  const int status = ::pclose(pipe);
  ran.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128;
  ran.err = read_file(errors);
  fs::remove(errors);
  return ran;
}

/// Line -> texts of the comments `// severity: text`; several may stand on one line.
std::multimap<int, std::string> expected_messages(const std::string& source, const std::string& severity) {
  std::multimap<int, std::string> expected;
  std::istringstream lines(source);
  std::string line;
  const std::string mark = "// " + severity + ": ";
  for (int number = 1; std::getline(lines, line); ++number) {
    for (std::size_t at = line.find(mark); at != std::string::npos; at = line.find(mark, at)) {
      at += mark.size();
      const std::size_t end = line.find(" //", at);
      expected.emplace(number, line.substr(at, end == std::string::npos ? end : end - at));
    }
  }
  return expected;
}

std::multimap<int, std::string> reported_messages(const std::string& err, const std::string& severity) {
  std::multimap<int, std::string> reported;
  const std::regex pattern("^[^ ][^:]*:([0-9]+):[0-9]+: " + severity + ": (.*)$");
  std::istringstream lines(err);
  std::string line;
  for (std::smatch match; std::getline(lines, line);)
    if (std::regex_match(line, match, pattern)) reported.emplace(std::stoi(match[1]), match[2]);
  return reported;
}

void compare_messages(const std::string& source, const Ran& ran, const std::string& severity) {
  auto reported = reported_messages(ran.err, severity);
  for (const auto& [line, text] : expected_messages(source, severity)) {
    INFO(severity << " expected in line " << line << ": " << text << "\n" << ran.err);
    const auto [first, last] = reported.equal_range(line);
    const auto found = std::find_if(first, last, [&](const auto& message) { return message.second.find(text) != std::string::npos; });
    CHECK(found != last);
    if (found != last) reported.erase(found);
  }
  for (const auto& [line, text] : reported) FAIL_CHECK("not expected in line " << line << ": " << severity << ": " << text);
}

std::string command_of(const std::string& source, const fs::path& program) {
  const std::string first = source.substr(0, source.find('\n'));
  const std::string lead = first.starts_with(';') ? "; run: " : "// run: ";  // of ACR1000 files and register scripts
  REQUIRE(first.substr(0, lead.size()) == lead);
  return std::string(PMAC_BIN_DIR) + "/" + first.substr(lead.size()) + " '" + program.filename().string() + "'";
}

void check_program(const fs::path& program) {
  const std::string source = read_file(program);
  const Ran ran = run(command_of(source, program), program.parent_path());
  compare_messages(source, ran, "error");
  compare_messages(source, ran, "warning");
  const bool bad = program.filename().string().substr(0, 4) == "bad_";
  CHECK(ran.exit_code == (bad ? 1 : 0));
  if (bad) return;
  const fs::path expect = fs::path(program).replace_extension(".expect");
  if (std::getenv("PMAC_GOLDEN_REBASE")) std::ofstream(expect, std::ios::binary) << ran.out;
  CHECK(ran.out == read_file(expect));
}

std::vector<fs::path> programs() {
  std::vector<fs::path> found;
  for (const auto& entry : fs::recursive_directory_iterator(PMAC_GOLDEN_DIR))
    if (entry.path().extension() == ".pmc" || entry.path().extension() == ".acr" || entry.path().extension() == ".mcx") found.push_back(entry.path());
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace

TEST_CASE("golden programs give what stands beside them", "[golden]") {
  for (const fs::path& program : programs())
    DYNAMIC_SECTION(program.parent_path().filename().string() << "/" << program.filename().string()) { check_program(program); }
}
