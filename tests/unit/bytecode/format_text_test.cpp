#include <catch2/catch.hpp>

#include "compiler/bytecode/format_text.h"

using namespace pmac::bytecode;

TEST_CASE("formats: conversions by kind, with their place", "[format]") {
  const FormatText format = parse_format("a%5.2lf|%-3d%%%s");
  REQUIRE(format.problem.empty());
  REQUIRE(format.conversions.size() == 4);
  CHECK(format.value_count() == 3);
  CHECK(format.conversions[0].kind == ConversionKind::kNumber);
  CHECK(format.conversions[0].begin == 1);
  CHECK(format.conversions[0].end == 7);
  CHECK(format.conversions[0].flags_and_width == "5.2");   // the length l means nothing here
  CHECK(format.conversions[1].kind == ConversionKind::kInteger);
  CHECK(format.conversions[1].flags_and_width == "-3");
  CHECK(format.conversions[2].kind == ConversionKind::kPercent);
  CHECK(format.conversions[3].kind == ConversionKind::kText);
}

TEST_CASE("formats: what is none is named with its place", "[format]") {
  CHECK(parse_format("ab%").problem_at == 2);
  CHECK_FALSE(parse_format("%q").problem.empty());
  CHECK_FALSE(parse_format("%*d").problem.empty());
  CHECK_FALSE(parse_format("%.1001f").problem.empty());
  CHECK(parse_format("%1000d").problem.empty());
  CHECK(parse_format("no conversions").problem.empty());
}
