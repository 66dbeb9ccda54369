#include "compiler/source/source.h"

#include <catch2/catch.hpp>

#include "compiler/source/format.h"

using namespace pmac::source;

TEST_CASE("lines and columns count from 1", "[source]") {
  SourceManager sources;
  const auto file = sources.add_file("a.pmc", "X1\nY20\n");
  CHECK(sources.line_column(file, 0).line == 1);
  CHECK(sources.line_column(file, 4).line == 2);
  CHECK(sources.line_column(file, 4).column == 2);
  CHECK(sources.line_text(file, 2) == "Y20");
}

TEST_CASE("a message shows place, code, line, caret with range, repair and notes", "[source]") {
  SourceManager sources;
  const auto file = sources.add_file("a.pmc", "open prog 1\nX10 Yq5\nclose\n");
  Diagnostics diagnostics;
  auto& error = diagnostics.error("PM9999", {file, 16, 19, -1}, "what is this");
  error.fix = FixIt{{file, 16, 19, -1}, "Y5"};
  error.notes.push_back({{file, 0, 11, -1}, "opened here"});
  CHECK(format_text(sources, diagnostics.all().front(), false) ==
        "a.pmc:2:5: error: what is this [PM9999]\n"
        "    X10 Yq5\n"
        "        ^~~\n"
        "    fix: write `Y5`\n"
        "a.pmc:1:1: note: opened here\n"
        "    open prog 1\n"
        "    ^~~~~~~~~~~\n");
}

TEST_CASE("a message inside a macro shows the use and the definition", "[source]") {
  SourceManager sources;
  const auto file = sources.add_file("a.pmc", "#define BAD -5\nF BAD\n");
  const auto expansion = sources.add_expansion("BAD", {file, 12, 14, -1});
  Diagnostics diagnostics;
  diagnostics.error("PM9999", {file, 17, 20, expansion}, "negative");
  CHECK(format_text(sources, diagnostics.all().front(), false) ==
        "a.pmc:2:3: error: negative [PM9999]\n"
        "    F BAD\n"
        "      ^~~\n"
        "a.pmc:1:13: note: in the expansion of macro 'BAD'\n"
        "    #define BAD -5\n"
        "                ^~\n");
}

TEST_CASE("errors behind the limit are counted, not kept; repetitions are dropped", "[source]") {
  Diagnostics diagnostics;
  diagnostics.set_error_limit(2);
  for (std::uint32_t i = 0; i < 5; ++i) diagnostics.error("PM1", {0, i, i + 1, -1}, "x");
  diagnostics.error("PM1", {0, 0, 1, -1}, "x");
  CHECK(diagnostics.error_count() == 2);
  CHECK(diagnostics.dropped_count() == 3);
  CHECK(diagnostics.take().size() == 2);
  CHECK_FALSE(diagnostics.has_errors());
}

TEST_CASE("the nearest word allows a third of the letters to be wrong", "[source]") {
  CHECK(nearest_word("linaer", {"linear", "rapid"}) == "linear");
  CHECK(nearest_word("DWEL", {"dwell", "delay"}) == "dwell");
  CHECK(nearest_word("xyz", {"linear", "rapid"}).empty());
}

TEST_CASE("diagnostics as JSON hold places and repairs", "[source]") {
  SourceManager sources;
  const auto file = sources.add_file("a\"b.pmc", "X\xff\n");
  Diagnostics diagnostics;
  diagnostics.error("PM1", {file, 0, 1, -1}, "bad \xff byte");
  const std::string json = format_json(sources, diagnostics.take());
  CHECK(json.find("\"code\": \"PM1\"") != std::string::npos);
  CHECK(json.find("\"line\": 1") != std::string::npos);
}
