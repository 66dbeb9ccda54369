#include "compiler/frontend/power_pmac/preprocessor.h"

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>

using namespace pmac;
using compiler::power_pmac::Preprocessor;

namespace {

struct Expanded {
  explicit Expanded(const std::string& text) : preprocessor(sources, diagnostics, {}), out(preprocessor.run(sources.add_file("a.pmc", text))) {}
  /// The expanded text with runs of blanks as one.
  std::string squeezed() const {
    std::string result;
    for (const char c : out.text())
      if (c != ' ' || (!result.empty() && result.back() != ' ')) result += c;
    return result;
  }
  source::SourceManager sources;
  source::Diagnostics diagnostics;
  Preprocessor preprocessor;
  compiler::power_pmac::ExpandedText out;
};

}  // namespace

TEST_CASE("macros are replaced by whole, exact names only", "[preprocessor]") {
  CHECK(Expanded("#define A 5\nA a AB XA A1\n").squeezed() == "\n 5 a AB XA A1\n");
}

TEST_CASE("comments vanish, line ends stay, texts are left alone", "[preprocessor]") {
  CHECK(Expanded("X1 // c\nY2 /* a\nb */ Z3\ncmd \"// no\"\n").squeezed() == "X1 \nY2 \n Z3\ncmd \"// no\"\n");
}

TEST_CASE("a macro that names itself ends", "[preprocessor]") {
  CHECK(Expanded("#define A B\n#define B A + 1\nA\n").squeezed() == "\n\n A + 1 \n");
}

TEST_CASE("arguments of macros may hold commas in parentheses and go over lines", "[preprocessor]") {
  CHECK(Expanded("#define MAX(a, b) ((a) > (b))\nMAX(f(1,2),\n 3)\n").squeezed() == "\n ((f(1,2)) > ( 3)) \n");
}

TEST_CASE("explosive macros are an error, not a hang", "[preprocessor]") {
  std::string text = "#define A0 x x\n";
  for (int i = 1; i < 60; ++i) text += "#define A" + std::to_string(i) + " A" + std::to_string(i - 1) + " A" + std::to_string(i - 1) + "\n";
  CHECK(Expanded(text + "A59\n").diagnostics.has_errors());
}

TEST_CASE("#if knows defined, comparisons and arithmetic", "[preprocessor]") {
  CHECK(Expanded("#define N 3\n#if defined(N) && N * 2 == 6 && !defined M\nyes\n#else\nno\n#endif\n").squeezed().find("yes") != std::string::npos);
  CHECK(Expanded("#if 0\nno\n#elif $10 >= 16\nyes\n#else\nno\n#endif\n").squeezed().find("no") == std::string::npos);
  CHECK(Expanded("#if 1 +\n#endif\n").diagnostics.has_errors());
  CHECK(Expanded("#if 1 / 0\n#endif\n").diagnostics.has_errors());
  CHECK(Expanded("#endif\n").diagnostics.has_errors());
}

TEST_CASE("every byte of the output knows where it came from", "[preprocessor]") {
  const Expanded expanded("#define FEED 40\nX1 FEED Y2\n");
  const std::size_t y = expanded.out.text().find("Y2");
  const source::Span plain = expanded.out.span_of(y, y + 2);
  CHECK(expanded.sources.text(plain) == "Y2");
  const std::size_t forty = expanded.out.text().find("40");
  const source::Span made = expanded.out.span_of(forty, forty + 2);
  CHECK(expanded.sources.text(made) == "FEED");
  REQUIRE(made.expansion >= 0);
  CHECK(expanded.sources.text(expanded.sources.expansion(made.expansion).definition) == "40");
}

TEST_CASE("a file that includes itself is an error", "[preprocessor]") {
  const auto folder = std::filesystem::temp_directory_path() / "pmac_include_test";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "self.pmh") << "#include \"self.pmh\"\n";
  source::SourceManager sources;
  source::Diagnostics diagnostics;
  Preprocessor preprocessor(sources, diagnostics, {folder.string()});
  preprocessor.run(sources.add_file("a.pmc", "#include \"self.pmh\"\n"));
  REQUIRE(diagnostics.has_errors());
  CHECK(diagnostics.all().front().code == "PM1006");
  std::filesystem::remove_all(folder);
}

TEST_CASE("motor commands are no directives", "[preprocessor]") {
  CHECK(Expanded("#1->1000X\n#*k\n #3j+\n").out.text() == "#1->1000X\n#*k\n #3j+\n");
}
