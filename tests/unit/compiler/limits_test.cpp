// Text that is nested or long beyond reason is an error with a place; it never overflows a stack and never takes long.
#include <catch2/catch.hpp>

#include "compiler/compiler.h"

using namespace pmac;

namespace {

std::string repeat(std::string_view text, int count) {
  std::string result;
  for (int i = 0; i < count; ++i) result += text;
  return result;
}

bool compiles(const std::string& body) {
  compiler::Session session;
  return session.compile({{"a.pmc", "open prog 1\n" + body + "\nclose\n"}}).has_value();
}

std::string code_of(const std::string& body) {
  compiler::Session session;
  session.compile({{"a.pmc", "open prog 1\n" + body + "\nclose\n"}});
  const auto all = session.diagnostics().take();
  return all.empty() ? std::string() : all.front().code;
}

}  // namespace

TEST_CASE("nesting that people write compiles", "[limits]") {
  CHECK(compiles("P1=" + repeat("(", 50) + "1" + repeat(")", 50)));
  CHECK(compiles(repeat("if (P1) {", 50) + "X1" + repeat("}", 50)));
  CHECK(compiles("if (P1) X1 " + repeat("else if (P2) X2\n", 200) + "else X3"));
  CHECK(compiles("P1 = 1" + repeat(" + P2", 500)));
  CHECK(compiles(repeat("if (P1) X1\n", 2000)));
  CHECK(compiles(repeat("while (P1) { X1 }\n", 2000)));
  CHECK(compiles(repeat("X1Y2", 100)));
}

TEST_CASE("nesting beyond the limits is refused by name", "[limits]") {
  CHECK(code_of("P1=" + repeat("(", 100000) + "1" + repeat(")", 100000)) == "PM2010");
  CHECK(code_of("P1=" + repeat("P(", 100000) + "1" + repeat(")", 100000)) == "PM2010");
  CHECK(code_of("P1=" + repeat("-", 100000) + "1") != "");
  CHECK(code_of("P1=" + repeat("~", 100000) + "1") == "PM2010");
  CHECK(code_of("P1=1" + repeat("+1", 100000)) == "PM2010");
  CHECK(code_of(repeat("if (P1) {", 100000) + "X1" + repeat("}", 100000)) == "PM2010");
  CHECK(code_of(repeat("{", 100000)) == "PM2010");
  CHECK(code_of(repeat("if (P1) ", 100000) + "X1") == "PM2010");
  CHECK(code_of(repeat("do ", 100000) + "X1") == "PM2010");
  CHECK(code_of("if (P1) X1 " + repeat("else if (P2) X2\n", 100000)) == "PM2010");
  CHECK(code_of("Motor" + repeat("[P1", 100000)) == "PM2010");
  CHECK(code_of(repeat("X1Y2", 100000)) == "PM2010");
  CHECK(code_of("P1 = Motor[1]." + repeat("a", 100000)) == "PM2010");
}

TEST_CASE("many errors do not take long and stop at the limit", "[limits]") {
  compiler::Session session;
  CHECK_FALSE(session.compile({{"a.pmc", "open prog 1\n" + repeat("foo bar\n", 20000) + "close\n"}}));
  CHECK(session.diagnostics().error_count() == 100);
  CHECK(session.diagnostics().dropped_count() >= 19000);
}
