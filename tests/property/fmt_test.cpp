// Formatting leaves the program alone: the bytecode is the same, the comments are all there, and a formatted text is not changed
// again. Over the course, the golden programs, random programs, and texts whose blanks were disturbed at random.
#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <regex>
#include <sstream>

#include "compiler/compiler.h"
#include "compiler/style/source_text.h"
#include "compiler/style/style.h"
#include "tests/reference/random_program.h"

namespace {

namespace fs = std::filesystem;
namespace style = pmac::style;

std::string read_file(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::vector<fs::path> programs_below(const fs::path& folder) {
  std::vector<fs::path> found;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string extension = entry.path().extension().string();
    if (extension == ".pmc" || extension == ".plc") found.push_back(entry.path());
  }
  std::sort(found.begin(), found.end());
  return found;
}

/// The answer to a query repeats the query, letter case, blanks and all; that is no part of what a program does.
std::string with_plain_reports(const std::string& disassembly) {
  std::string result;
  std::istringstream lines(disassembly);
  for (std::string line; std::getline(lines, line);) {
    if (line.find(" report ") != std::string::npos) {
      std::transform(line.begin(), line.end(), line.begin(), [](unsigned char c) { return std::tolower(c); });
      line.erase(std::remove(line.begin(), line.end(), ' '), line.end());
    }
    result += line + "\n";
  }
  return result;
}

/// Disassembly without the lines that instructions came from.
std::string bytecode_of(const std::string& text, const fs::path& name) {
  pmac::compiler::Session session;
  const auto module = session.compile({{name.string(), text}});
  if (!module) return "errors";
  const std::regex place(" *; [^;\n]*:[0-9]+(?=\n)");
  return with_plain_reports(std::regex_replace(disassemble(*module), place, ""));
}

std::multiset<std::string> comments_of(const std::string& text) {
  std::multiset<std::string> comments;
  for (const style::Piece& piece : style::read_outline(text).pieces) {
    if (piece.kind != style::PieceKind::kComment) continue;
    const std::string comment = text.substr(piece.begin, piece.end - piece.begin);
    comments.insert(comment.substr(0, comment.find_last_not_of(" \t\r") + 1));
  }
  return comments;
}

std::string formatted(const std::string& text, const fs::path& name, const style::Options& options = {}) {
  const style::Formatted result = style::format(text, name.string(), {}, options);
  for (const style::Problem& problem : result.problems) UNSCOPED_INFO(name << " at " << problem.offset << ": " << problem.message);
  REQUIRE(result.problems.empty());
  return result.text;
}

void check_same_program(const std::string& before, const fs::path& name, const style::Options& options = {}) {
  const std::string after = formatted(before, name, options);
  INFO(name << "\n--- before\n" << before << "\n--- after\n" << after);
  CHECK(formatted(after, name, options) == after);
  CHECK(bytecode_of(after, name) == bytecode_of(before, name));
  CHECK(comments_of(after) == comments_of(before));
}

bool can_be_formatted(const std::string& text, const fs::path& name) { return style::format(text, name.string(), {}, {}).problems.empty(); }

/// Blanks at the begin and end of lines, and blank lines, put in and taken out.
std::string with_other_margins(const std::string& text, std::mt19937& random) {
  std::string result;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::size_t first = std::min(text.find_first_not_of(" \t", at), end);
    result += std::string(random() % 9, random() % 4 ? ' ' : '\t') + text.substr(first, end - first) + std::string(random() % 3, ' ') + "\n";
    at = end + 1;
  }
  return result;
}

/// Every run of blanks inside a line becomes another run.
std::string with_other_blanks(const std::string& text, std::mt19937& random) {
  std::string result;
  for (const char c : text)
    if (c == ' ') result += std::string(1 + random() % 3, random() % 5 ? ' ' : '\t');
    else result += c;
  return result;
}

/// Comments put behind lines and between them.
std::string with_comments(const std::string& text, std::mt19937& random) {
  std::string result;
  for (const char c : text) {
    if (c == '\n' && random() % 4 == 0) result += random() % 2 ? " // behind " + std::to_string(random() % 100) : "/* behind */";
    result += c;
    if (c == '\n' && random() % 6 == 0) result += "// between, " + std::to_string(random() % 100) + "\n";
    if (c == ' ' && random() % 40 == 0) result += "/* inside */ ";
  }
  return result;
}

/// Letters turned to capitals where no name is declared in small ones.
std::string in_capitals(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

}  // namespace

TEST_CASE("fmt: the programs of the course mean the same", "[property][fmt]") {
  for (const fs::path& path : programs_below(fs::path(PMAC_SOURCE_DIR) / "programs")) check_same_program(read_file(path), path);
}

TEST_CASE("fmt: golden programs mean the same, formatted in two styles", "[property][fmt]") {
  int checked = 0;
  for (const fs::path& path : programs_below(fs::path(PMAC_SOURCE_DIR) / "tests" / "golden")) {
    const std::string text = read_file(path);
    if (!can_be_formatted(text, path)) continue;
    check_same_program(text, path);
    check_same_program(text, path, {2, true});
    ++checked;
  }
  CHECK(checked > 60);
}

TEST_CASE("fmt: random programs mean the same, whatever their blanks and comments", "[property][fmt]") {
  std::mt19937 random(20261);
  for (std::uint32_t seed = 1; seed <= 150; ++seed) {
    INFO("seed " << seed);
    const std::string script = to_script(pmac::reference::random_program(seed));
    check_same_program(script, "random.pmc");
    check_same_program(with_comments(with_other_blanks(script, random), random), "random.pmc");
  }
}

TEST_CASE("fmt: margins and blank lines do not matter to the result", "[property][fmt]") {
  std::mt19937 random(7);
  for (std::uint32_t seed = 1; seed <= 100; ++seed) {
    const std::string script = to_script(pmac::reference::random_program(seed));
    const std::string wanted = formatted(script, "random.pmc");
    INFO("seed " << seed << "\n" << wanted);
    CHECK(formatted(with_other_margins(wanted, random), "random.pmc") == wanted);
    CHECK(formatted(with_other_margins(with_other_blanks(wanted, random), random), "random.pmc") == wanted);
  }
}

TEST_CASE("fmt: letter case of keywords and letters does not matter to the result", "[property][fmt]") {
  int compared = 0;
  for (const fs::path& path : programs_below(fs::path(PMAC_SOURCE_DIR) / "programs")) {
    const std::string text = read_file(path);
    const bool declares = text.find("ptr") != std::string::npos || text.find("local") != std::string::npos || text.find("global") != std::string::npos;
    if (declares || text.find("Kin") != std::string::npos) continue;
    const std::string wanted = formatted(text, path);
    const std::string found = formatted(in_capitals(text), path);
    std::string code;  // comments are capitals now
    for (std::size_t i = 0; i < wanted.size(); ++i) code += wanted[i] == found[i] ? wanted[i] : static_cast<char>(std::toupper(static_cast<unsigned char>(wanted[i])));
    CHECK(found == code);
    CHECK(bytecode_of(found, path) == bytecode_of(wanted, path));
    ++compared;
  }
  CHECK(compared >= 3);
}

TEST_CASE("fmt: random bytes are formatted or refused, and a result is stable", "[property][fmt]") {
  std::mt19937 random(99);
  const std::string alphabet = "XYP15. \n\n\t;,(){}[]=+-*/&#$\"\\:<>!|^%~aif else while open close prog 1 \xe4\xc3\xa4\r\n";
  for (int i = 0; i < 3000; ++i) {
    std::string text;
    for (std::size_t n = random() % 60; n > 0; --n) text += i % 3 ? alphabet[random() % alphabet.size()] : static_cast<char>(random() % 256);
    const style::Formatted once = style::format(text, "random.pmc", {}, {});
    if (!once.problems.empty()) continue;
    const style::Formatted twice = style::format(once.text, "random.pmc", {}, {});
    INFO("case " << i << "\n" << text);
    REQUIRE(twice.problems.empty());
    CHECK(twice.text == once.text);
  }
}
