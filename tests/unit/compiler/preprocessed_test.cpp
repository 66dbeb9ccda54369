// pmacc -E: what it prints compiles to the same bytecode, instruction by instruction and line by line. Compared are disassemblies:
// without the symbols, which are macros in what -E prints, without the names of pointers, and without the sizes of frames, where
// locals that are declared and never used count.
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <sstream>

#include "compiler/compiler.h"
#include "compiler/project/project.h"
#include "compiler/source/format.h"

using namespace pmac;
using compiler::InputFile;

namespace {

std::string messages_of(compiler::Session& session) {
  std::string text;
  for (const source::Diagnostic& diagnostic : session.diagnostics().all()) text += source::format_text(session.sources(), diagnostic, false);
  return text;
}

/// Sections of a disassembly that begin with one of these words; the load scripts of all files as one list of instructions.
struct Code {
  std::vector<std::string> programs, definitions, load;
};

/// Each instruction with the place that holds for it: a place is printed only where a statement begins.
std::string with_places(const std::string& section) {
  std::istringstream lines(section);
  std::string text, place;
  for (std::string line; std::getline(lines, line);) {
    const std::size_t at = line.find(" ; ");
    if (at != std::string::npos) place = line.substr(at);
    text += line.substr(0, line.find_last_not_of(' ', at) + 1) + place + "\n";
  }
  return text;
}

/// The instructions of a load script, without their places in it and without those of table rows.
void append_load(const std::string& section, std::vector<std::string>& load) {
  std::istringstream lines(section);
  for (std::string line; std::getline(lines, line);) {
    const std::string text = std::regex_replace(line, std::regex("^ *[0-9]+  "), "");
    const bool frame = text.starts_with("online ") || text.starts_with("return");
    if (!frame && !text.empty()) load.push_back(std::regex_replace(text, std::regex("(axis|pointer) [0-9]+ *"), "$1 "));
  }
}

Code code_of(const bytecode::Module& module) {
  Code code;
  std::string text = bytecode::disassemble(module);
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find("\n\n", at), text.size());
    const std::string section = text.substr(at, end - at);
    at = end + 2;
    if (section.starts_with("symbols") || section.starts_with("files") || section.starts_with("load order")) continue;
    if (section.starts_with("online ")) append_load(with_places(section), code.load);
    else if (section.starts_with("pointer definitions") || section.starts_with("axis definitions")) code.definitions.push_back(std::regex_replace(section, std::regex(" +\\([A-Za-z_0-9]+\\)"), ""));
    else code.programs.push_back(std::regex_replace(with_places(section), std::regex(": [0-9]+ locals, [0-9]+ registers"), ""));
  }
  return code;
}

void check_round_trip(const std::vector<InputFile>& files) {
  compiler::Session printing;
  const std::string text = compiler::emit_preprocessed(printing, files);
  INFO(messages_of(printing));
  REQUIRE_FALSE(text.empty());
  compiler::Session direct;
  compiler::Session again;
  const auto expected = direct.compile(files);
  REQUIRE(expected);
  const auto result = again.compile({{"printed.pmc", text}});
  INFO(text);
  INFO(messages_of(again));
  REQUIRE(result);
  const Code before = code_of(*expected);
  const Code after = code_of(*result);
  CHECK(after.programs == before.programs);
  CHECK(after.definitions == before.definitions);
  CHECK(after.load == before.load);
}

std::string read(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace

TEST_CASE("the numbered course compiles to the same through -E", "[preprocessed]") {
  for (const auto& entry : std::filesystem::directory_iterator(std::string(PMAC_SOURCE_DIR) + "/programs")) {
    const std::string extension = entry.path().extension().string();
    if (extension != ".pmc" && extension != ".plc") continue;
    INFO(entry.path().string());
    check_round_trip({{entry.path().string(), read(entry.path())}});
  }
}

TEST_CASE("a project compiles to the same through -E", "[preprocessed]") {
  source::SourceManager sources;
  source::Diagnostics diagnostics;
  const auto project = compiler::project::read_project(std::string(PMAC_SOURCE_DIR) + "/tests/projects/small_machine", sources, diagnostics);
  REQUIRE(project.files.size() == 8);
  check_round_trip(project.files);
}

TEST_CASE("declarations of every form compile to the same through -E", "[preprocessed]") {
  const char* rows[] = {
      "global A = 2, B(10) = 5, C = A + 1; csglobal D = 3, E(4)\nP1 = B(3) + B(A) + E(1)\n",
      "ptr A->u.io:$A00000.8.1, B->*; ptr C(4)->*\nptr D->Motor[1].JogSpeed\nA = 1 B = 2\n",
      "&1\n#1->100X\n  #2->100Y+5\n&2#3->100X #4->100Y\n&1 #5->Z\n",
      "open prog 1\nlocal A = 1, B = A\nif (A) local C = 2\nelse local D, E = 3, F = 4\nX(A + B)\nclose\n",
      "open prog 1\nif (P1) local C\nX10\nclose\n",
      "global Speed = 5\nopen prog 1\nlocal Speed = 7\nF(Speed)\nclose\nopen prog 2\nF(Speed)\nclose\n",
      "open subprog One(A, &B)\nB = A\nclose\nopen prog 1\nlocal A\ncall One(3, A)\nclose\nglobal A\nopen prog 2\ncall One(3, A)\nclose\n",
      "open subprog Wait(Time)\nL1 = Time\nsub: ms(Time, Other)\nlocal L_a = Time + Other\nclose\nopen plc 1\ncall Wait.ms(1, 2)\nclose\n",
      "global Time\nTime = Sys.Time\nopen plc 1\nlocal JogSpeed = Motor[1].JogSpeed\nTime = Motor[1].JogSpeed + JogSpeed\nclose\n",
      "#define TWICE(x) ((x) * 2)\n#define N 3\nglobal A(N), B = TWICE(N), C = TWICE(\n 4)\nP1 = TWICE(A(1))\n",
      "#if 0\nglobal A\n#else\nglobal B\n#endif\nglobal C\nB = 1 C = 2\n",
      "global A, /* one */ B, // two\n  C\n  = 4\nP1 = C; global D; D = 5\n",
      "global Table(8)\nopen plc 1\nlocal i = 2\nTable(i + 1) = Table(i) + Table(7) + P(100 + i)\nclose\n",
      "open plc 1\nwhile (P1 < 3) { local a = P1\n P2 = a }\nclose open plc 2\nlocal a\nswitch (a) { case 1: P1 = a }\nclose",
  };
  for (const char* row : rows) {
    INFO(row);
    check_round_trip({{"a.pmc", row}});
  }
}

TEST_CASE("several files become one text", "[preprocessed]") {
  check_round_trip({{"a.pmh", "global A = 1\n#define TWO 2"}, {"b.pmc", "open prog 1\nlocal A = TWO\nX(A)\nclose"}, {"c.plc", "A = 5\nopen plc 3\nA = TWO\nclose\nenable plc 3"}});
}

TEST_CASE("a program with errors is not printed", "[preprocessed]") {
  compiler::Session session;
  CHECK(compiler::emit_preprocessed(session, {{"a.pmc", "open prog 1\nX(Nothing)\nclose\n"}}).empty());
  CHECK(session.diagnostics().has_errors());
}
