// The short way through plain move lines reads the same words as the compiler's lexer.
#include <catch2/catch.hpp>
#include <random>
#include <string>

#include "compiler/style/plain_lines.h"
#include "compiler/style/source_text.h"

using namespace pmac::style;

namespace {

std::string listing(const SourceText& source) {
  std::string text;
  for (const Piece& piece : source.pieces)
    text += std::to_string(piece.begin) + "-" + std::to_string(piece.end) + " " + std::to_string(static_cast<int>(piece.kind)) + " " + std::to_string(piece.type) + "\n";
  return text;
}

void check_same(const std::string& text, const Names& names = {}) {
  INFO(text);
  CHECK(listing(read_source(text, names, PlainLines::kAlways)) == listing(read_source(text, names, PlainLines::kNever)));
}

}  // namespace

TEST_CASE("plain lines: random part programs read alike in both ways", "[fmt]") {
  std::mt19937 random(5);
  const std::vector<std::string> lines = {"X1Y2", "x 1.5 Y-3;", "X1 Y2 Z3 // a", "I1J-2 F100", "X.5", "X1.", "X1.Y2", "X1e5", "X1 E5", "X(P1)", "P1=5", "C6=1", "C90", "F(P1)",
                                          "linear X1", "X1;Y2", ";", "}", "if (P1) {", "while (P1)", "do", "call 100", "call", "local A", "local A,", "local X1;", "local F;", "global Y,",
                                          "close", "open prog 1", "open prog", "open subprog Foo(A, B)", "&1", "#1->X1", "#1->", "X1 /* a", "b */ Y1", "/* c */ X5", "", "P1=", "P1=P2+", "-5",
                                          "G1X5", "G1", "read(X,Y)", "R10", "X$1F", "1", "X1X2X3", "cx X1", "sub: Bar(X)", "N100: X1", "\tX1\tY2\t", "X1\r", "#define X1 Y", "#define F f"};
  for (int i = 0; i < 3000; ++i) {
    std::string text = i % 3 ? "open prog 1\nlinear;\n" : "";
    for (std::size_t n = 1 + random() % 12; n > 0; --n) text += lines[random() % (i % 2 ? lines.size() : 8)] + "\n";
    check_same(text);
  }
}

TEST_CASE("plain lines: a name that looks like a word of a line is a name", "[fmt]") {
  Names names;
  names.declared = {"X1"};
  check_same("open prog 1\nX1 Y2;\nX1 Y2\nX1Y2\nX1\nclose\n", names);
  CHECK(could_be_plain("X1"));
  CHECK(could_be_plain("Y"));
  CHECK(could_be_plain("x10Y2"));
  CHECK_FALSE(could_be_plain("Foo"));
  CHECK_FALSE(could_be_plain("X_1"));
  CHECK_FALSE(could_be_plain("P1"));
}

TEST_CASE("plain lines: most lines of a part program are read in the short way", "[fmt]") {
  std::string code = "open prog 1\nlinear F100\nX1Y2\nX3Y4\nX5Y6 Z7;\nclose\n";
  CHECK(take_plain_lines(code).size() == 4 + 7);  // the first move goes the long way
  CHECK(code == "open prog 1\nlinear F100\nX1Y2\n    \n        \nclose\n");
}
