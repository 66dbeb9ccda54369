// Macros by the rules of C: the standard's own example, and random macros against GNU cpp, which expands the controller's programs.
#include <sys/wait.h>

#include <catch2/catch.hpp>
#include <cstdio>
#include <random>

#include "compiler/frontend/power_pmac/preprocessor.h"
#include "tests/unit/gather/scratch_folder.h"

using namespace pmac;
using compiler::power_pmac::Preprocessor;

namespace {

struct Expanded {
  explicit Expanded(const std::string& text) : preprocessor(sources, diagnostics, {}), out(preprocessor.run(sources.add_file("a.pmc", text))) {}
  source::SourceManager sources;
  source::Diagnostics diagnostics;
  Preprocessor preprocessor;
  compiler::power_pmac::ExpandedText out;
};

/// The tokens of a text, one blank between them: cpp and we put blanks in other places.
std::string tokens_of(const std::string& text) {
  std::string result;
  for (const auto& token : compiler::power_pmac::split_tokens(text, {}))
    if (token.kind != compiler::power_pmac::PreprocessorToken::Kind::kBlank && token.kind != compiler::power_pmac::PreprocessorToken::Kind::kNewline)
      result += std::string(token.text) + " ";
  return result;
}

std::string expand(const std::string& text) { return tokens_of(Expanded(text).out.text()); }

bool has_error(const std::string& text, const std::string& code) {
  const Expanded expanded(text);
  for (const source::Diagnostic& diagnostic : expanded.diagnostics.all())
    if (diagnostic.code == code) return true;
  return false;
}

}  // namespace

TEST_CASE("the example of the C standard expands as it says there", "[preprocessor]") {  // ISO C99 6.10.3.5, example 3
  const std::string macros =
      "#define x 3\n#define f(a) f(x * (a))\n#undef x\n#define x 2\n#define g f\n#define z z[0]\n#define h g(~\n#define m(a) a(w)\n#define w 0,1\n#define t(a) a\n"
      "#define p() int\n#define q(x) x\n#define r(x,y) x ## y\n#define str(x) # x\n";
  CHECK(expand(macros + "f(y+1) + f(f(z)) % t(t(g)(0) + t)(1)\n") == tokens_of("f(2 * (y+1)) + f(2 * (f(2 * (z[0])))) % f(2 * (0)) + t(1)"));
  CHECK(expand(macros + "g(x+(3,4)-w) | h 5) & m\n(f)^m(m)\n") == tokens_of("f(2 * (2+(3,4)-0,1)) | f(2 * (~ 5)) & m (f)^m(0,1)"));  // no call goes over a line end here
  CHECK(expand(macros + "m(f)^m(m)\n") == tokens_of("f(2 * (0,1))^m(0,1)"));
  CHECK(expand(macros + "p() i[q()] = { q(1), r(2,3), r(4,), r(,5), r(,) }\n") == tokens_of("int i[] = { 1, 23, 4, 5, }"));
  CHECK(expand(macros + "{ str(hello), str() }\n") == tokens_of("{ \"hello\", \"\" }"));
}

TEST_CASE("# makes a text and ## joins tokens", "[preprocessor]") {
  CHECK(expand("#define TEXT(a) cmd #a\nTEXT(say \"hi\\\\\"  + 1)\n") == tokens_of("cmd \"say \\\"hi\\\\\\\\\\\" + 1\""));
  CHECK(expand("#define VAR(n) P ## n = 1\nVAR(100)\n") == tokens_of("P100 = 1"));
  CHECK(expand("#define MOTOR(n) Motor[n].JogSpeed\n#define ONE 1\nMOTOR(ONE)\n") == tokens_of("Motor[1].JogSpeed"));
  CHECK(expand("#define KILL #1k\nKILL\n") == tokens_of("#1k"));
  CHECK(expand("#define ALL(a, ...) a: __VA_ARGS__;\nALL(1, 2, 3)\nALL(1)\n") == tokens_of("1: 2, 3; 1: ;"));
}

TEST_CASE("__LINE__ and __FILE__ follow #line", "[preprocessor]") {
  CHECK(expand("__LINE__ __FILE__\n#line 70 \"b.pmc\"\n__LINE__ __FILE__\n__LINE__\n") == tokens_of("1 \"a.pmc\" 70 \"b.pmc\" 71"));
  const Expanded expanded("#line 10 \"shown.pmc\"\nX1\n#line 20\nY2\n");
  const std::size_t x = expanded.out.text().find("X1");
  const std::size_t y = expanded.out.text().find("Y2");
  CHECK(expanded.sources.place(expanded.out.span_of(x, x + 2)).file == "shown.pmc");
  CHECK(expanded.sources.place(expanded.out.span_of(x, x + 2)).line == 10);
  CHECK(expanded.sources.place(expanded.out.span_of(y, y + 2)).line == 20);
  CHECK(has_error("#line x\n", "PM1015"));
  CHECK(has_error("#line 3 x\n", "PM1015"));
}

TEST_CASE("#if computes as C does", "[preprocessor]") {
  const auto holds = [](const std::string& condition) {
    const Expanded expanded("#if " + condition + "\nyes\n#endif\n");
    CHECK(expanded.diagnostics.all().empty());
    return expanded.out.text().find("yes") != std::string::npos;
  };
  for (const char* yes : {"0x10 == 16", "$ff == 255", "10UL == 10", "1 ? 2 : 0", "0 ? 0 : 3", "-7 / 2 == -3", "-7 % 3 == -1", "1 << 4 == 16", "~0 == -1", "!defined(X)", "0 && 1 / 0 || 1",
                          "(1 + 2) * 3 == 9", "1 || 1 / 0", "undefined_name == 0", "2 - 1 - 1 == 0", "3 > 2 > 0", "1 ? 0 ? 1 : 2 : 3", "__LINE__ == 1", "defined __FILE__"})
    CHECK(holds(yes));
  for (const char* wrong : {"", "1 +", "1 / 0", "(1", "1)", "10abc", "1.5", "99999999999999999999", "1 ? 2", "defined", "\"a\"", "1 2"}) {
    INFO(wrong);
    CHECK(has_error(std::string("#if ") + wrong + "\n#endif\n", "PM1007"));
  }
  CHECK_FALSE(has_error("#if 1\n#elif 1 / 0\n#endif\n", "PM1007"));  // not reached
  CHECK(has_error("#if " + std::string(500, '(') + "1" + std::string(500, ')') + "\n#endif\n", "PM1007"));
  CHECK(has_error("#ifdef\n#endif\n", "PM1007"));
}

TEST_CASE("directives may stand between the lines of a call and of a statement", "[preprocessor]") {
  CHECK(expand("#define ADD(a, b) a + b\nP1 = ADD(1,\n#define TWO 2\nTWO)\n") == tokens_of("P1 = 1 + 2"));
  CHECK(expand("P1 =\n#ifdef NEVER\n1\n#else\n2\n#endif\n+ 3\n") == tokens_of("P1 = 2 + 3"));
}

TEST_CASE("wrong definitions and calls are errors", "[preprocessor]") {
  for (const char* text : {"#define\n", "#define 5 6\n", "#define F(a\n", "#define F(a,) a\n", "#define F(a b) a\n", "#define F(..., a) a\n", "#undef\n"}) {
    INFO(text);
    CHECK(has_error(text, "PM1004"));
  }
  CHECK(has_error("#define F(a, b) a\nF(1)\n", "PM1013"));
  CHECK(has_error("#define F(a, b) a\nF(1, 2, 3)\n", "PM1013"));
  CHECK(has_error("#define F(a) a\nF(1\n", "PM1013"));
  CHECK(has_error("#pragma once\n", "PM1014"));
}

TEST_CASE("the macros that a text came through are kept, from the inside out", "[preprocessor]") {
  const Expanded expanded("#define INNER 40\n#define OUTER (INNER)\nX OUTER\n");
  const std::size_t forty = expanded.out.text().find("40");
  const source::Span span = expanded.out.span_of(forty, forty + 2);
  REQUIRE(span.expansion >= 0);
  const source::Expansion& inner = expanded.sources.expansion(span.expansion);
  CHECK(inner.macro == "INNER");
  REQUIRE(inner.parent >= 0);
  CHECK(expanded.sources.expansion(inner.parent).macro == "OUTER");
  CHECK(expanded.sources.line_column(span.file, span.begin).line == 3);
}

TEST_CASE("files that include themselves twice end at once", "[preprocessor]") {
  const test::ScratchFolder folder;
  std::ofstream(folder.file("twice.pmh")) << "#include \"twice.pmh\"\n#include \"twice.pmh\"\n";
  source::SourceManager sources;
  source::Diagnostics diagnostics;
  Preprocessor preprocessor(sources, diagnostics, {});
  preprocessor.run(sources.add_file(folder.file("a.pmc"), "#include \"twice.pmh\"\nX1\n"));
  CHECK(diagnostics.error_count() == 1);
  CHECK(sources.file_count() < 100);
}

TEST_CASE("many open calls in a line take no quadratic time", "[preprocessor]") {
  std::string line;
  for (int i = 0; i < 20000; ++i) line += "F(";
  CHECK(has_error("#define F(a) a\n" + line + "\n", "PM1013"));
}

namespace {

/// Random macros and lines of names, numbers, operators and parentheses: what PMAC text and C read alike.
class RandomMacros {
 public:
  explicit RandomMacros(unsigned seed) : random_(seed) {}

  std::string text() {
    std::string result;
    for (int i = 0; i < 8; ++i) result += definition(i);
    for (int i = 0; i < 6; ++i) result += words(3 + below(8), 0) + "\n";
    return result;
  }

 private:
  std::size_t below(std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random_); }

  std::string definition(int index) {
    const std::size_t parameters = arity_[static_cast<std::size_t>(index)] = below(3);
    std::string result = "#define " + name(static_cast<std::size_t>(index));
    if (parameters == 1) result += "(a)";
    if (parameters == 2) result += "(a, b)";
    return result + " " + words(1 + below(5), parameters) + "\n";
  }

  static std::string name(std::size_t index) { return std::string("M") + static_cast<char>('A' + index); }

  std::string words(std::size_t count, std::size_t parameters) {
    std::string result;
    for (std::size_t i = 0; i < count; ++i) result += word(parameters) + " ";
    return result;
  }

  std::string word(std::size_t parameters) {
    switch (below(8)) {
      case 0: return std::to_string(below(100));
      case 1: return "+";
      case 2: return "x" + std::string(1, static_cast<char>('a' + below(4)));
      case 3: if (parameters > 0) return below(2) && parameters == 2 ? "b" : "a"; [[fallthrough]];
      case 4: return parameters == 2 && below(2) ? "a ## b" : name(below(8));
      default: return call(parameters);
    }
  }

  std::string call(std::size_t parameters) {
    const std::size_t index = below(8);
    if (++depth_ > 3) return --depth_, "y";
    std::string result = name(index);
    if (below(6) && arity_[index] >= 1) result += "(" + words(below(3), parameters);
    else return --depth_, result;
    if (arity_[index] == 2) result += ", " + words(below(3), parameters);
    --depth_;
    return result + ")";
  }

  std::mt19937 random_;
  std::size_t arity_[8] = {};
  int depth_ = 0;
};

/// What cpp makes of a text; nullopt where it reports an error or is not there.
std::optional<std::string> cpp(const std::string& text, const test::ScratchFolder& folder) {
  std::ofstream(folder.file("in.c")) << text;
  std::FILE* pipe = ::popen(("cpp -P -undef -nostdinc -w '" + folder.file("in.c") + "' 2>/dev/null").c_str(), "r");
  if (!pipe) return std::nullopt;
  std::string out;
  char buffer[4096];
  for (std::size_t n; (n = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;) out.append(buffer, n);
  const int status = ::pclose(pipe);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) return std::nullopt;
  return out;
}

}  // namespace

TEST_CASE("random macros expand as GNU cpp expands them", "[preprocessor][random]") {
  const test::ScratchFolder folder;
  int compared = 0;
  for (unsigned seed = 1; seed <= 120; ++seed) {
    const std::string text = RandomMacros(seed).text();
    const auto expected = cpp(text, folder);
    const Expanded ours(text);
    if (!expected || ours.diagnostics.has_errors()) continue;
    INFO("seed " << seed << "\n" << text);
    CHECK(tokens_of(ours.out.text()) == tokens_of(*expected));
    ++compared;
  }
  CHECK((compared == 0 || compared > 80));  // 0: there is no cpp
}
