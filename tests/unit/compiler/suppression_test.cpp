#include "compiler/source/suppression.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <string>

#include "compiler/source/warning_control.h"

using namespace pmac::source;

namespace {

std::vector<SuppressionComment> read(const std::string& text) {
  SourceManager sources;
  return read_suppressions(sources, sources.add_file("a.pmc", text));
}

}  // namespace

TEST_CASE("suppressions: the names of a comment count for its line, or for the one behind comments that stand alone", "[source]") {
  const auto found = read("P1=1 // pmacc: ignore(one, two)\n  // pmacc: ignore(three)\n// more\nP2=2\n// pmacc: ignore-file(four)\n");
  REQUIRE(found.size() == 4);
  CHECK((found[0].group == "one" && found[0].line == 1 && found[0].span.begin == 22 && found[0].span.end == 25));
  CHECK((found[1].group == "two" && found[1].line == 1));
  CHECK((found[2].group == "three" && found[2].line == 4));
  CHECK((found[3].group == "four" && found[3].whole_file));
}

TEST_CASE("suppressions: a mark inside of a text is none, and one without a closing parenthesis has no group", "[source]") {
  CHECK(read("send \"// pmacc: ignore(one)\"\n").empty());
  CHECK(read("P1=1 // see pmacc: ignore(one)\n").empty());
  const auto open = read("P1=1 // pmacc: ignore(one // pmacc: ignore(two)\n");
  REQUIRE(open.size() == 2);
  CHECK(open[0].group.empty());
  CHECK(open[1].group == "two");
}

TEST_CASE("suppressions: all comments that say the same are used when one is, and those that are not are told in their order", "[source]") {
  SourceManager sources;
  const std::int32_t file = sources.add_file("a.pmc", "P1=1 // pmacc: ignore(unused-local)\n// pmacc: ignore-file(array-bounds, array-bounds)\n// pmacc: ignore-file(unused-local)\n");
  WarningOptions options;
  REQUIRE(options.apply("extra").empty());
  WarningControl control(sources, options);
  Diagnostics diagnostics;
  diagnostics.set_filter(&control);
  const auto row = std::find_if(message_table().begin(), message_table().end(), [](const MessageInfo& m) { return m.group == "array-bounds"; });
  REQUIRE(row->group == "array-bounds");
  diagnostics.warning(std::string(row->code), {file, 0, 4, -1}, "quiet");
  CHECK(diagnostics.all().empty());
  control.report_comments(0, true, diagnostics);
  REQUIRE(diagnostics.all().size() == 2);
  CHECK(diagnostics.all()[0].span.begin < diagnostics.all()[1].span.begin);
  for (const Diagnostic& unused : diagnostics.all()) CHECK(unused.message == "no warning 'unused-local' is given here");
}

TEST_CASE("suppressions: a hundred thousand marks on one line, or lines of nothing but comments, are read once", "[source]") {
  std::string one_line = "P1=1 ", many_lines;
  for (int i = 0; i < 100'000; ++i) one_line += "// pmacc: ignore(one ", many_lines += "// pmacc: ignore(one)\n";
  CHECK(read(one_line + ")\n").size() == 100'000);   // all but the last are not closed, and the last one is
  CHECK(read(many_lines + "P1=1\n").size() == 100'000);
}
