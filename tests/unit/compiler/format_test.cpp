// The formats of diagnostics for tools, and the marks of the text form.
#include "compiler/source/format.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "compiler/source/characters.h"
#include "compiler/source/snippet.h"

using namespace pmac::source;
using nlohmann::json;

namespace {

/// The snippet of bytes [begin, end) of a text.
std::string marked(const std::string& text, std::uint32_t begin, std::uint32_t end) {
  SourceManager sources;
  const auto file = sources.add_file("a.pmc", text);
  return snippet(sources, {file, begin, end, -1}, [](std::string_view mark) { return std::string(mark); });
}

/// An error in an included file, from a macro, with a note and a repair.
struct Example {
  SourceManager sources;
  std::vector<Diagnostic> list;

  Example() {
    const auto main = sources.add_file("dir/main file.pmc", "#include \"b.pmh\"\n");
    const auto part = sources.add_file("dir/b.pmh", "#define BAD (=)\n// \xc3\xbc\xf0\x9f\x98\x80\nP1 BAD 5 \xe4\n", {main, 9, 16, -1});
    const auto expansion = sources.add_expansion("BAD", {part, 12, 15, -1});
    Diagnostic d{Severity::kError, "PM2011", {part, 29, 32, expansion}, "a: b, 100%\nnext", {{{main, 0, 8, -1}, "see here"}}, {}};
    d.fix = FixIt{{part, 33, 34, -1}, "6", FixSafety::kSafe, {{{main, 0, 0, -1}, "x"}}};
    list.push_back(d);
    Diagnostic w{Severity::kWarning, "PM6003", {part, 35, 36, -1}, "umlaut", {}, {}};
    w.group = "unserved-axis";
    list.push_back(w);
  }
};

}  // namespace

TEST_CASE("a mark stands below its characters", "[format]") {
  CHECK(marked("X10 Yq5\n", 4, 7) == "    X10 Yq5\n        ^~~\n");
  CHECK(marked("\tX1\tY2\n", 4, 6) == "        X1  Y2\n            ^~\n");                      // tab stops of 4
  CHECK(marked("// \xc3\xbc\xc3\xbc Y\n", 8, 9) == "    // \xc3\xbc\xc3\xbc Y\n          ^\n");      // UTF-8
  CHECK(marked("// \xfc\xfc Y\n", 6, 7) == "    // \xc3\xbc\xc3\xbc Y\n          ^\n");              // Latin-1
  CHECK(marked("// \xe4\xb8\xad Y\n", 7, 8) == "    // \xe4\xb8\xad Y\n          ^\n");              // two columns wide
  CHECK(marked("X1\r\n", 2, 3) == "    X1\n      ^\n");                                              // at the line end
  CHECK(marked("", 0, 0) == "    \n    ^\n");
}

TEST_CASE("a span over several lines marks each, or the first and the last ones", "[format]") {
  CHECK(marked("while (P1\n  < 5) {\n}\n", 6, 16) == "    while (P1\n          ^~~\n      < 5) {\n      ~~~~\n");
  const std::string long_span = marked("a\nb\nc\nd\ne\nf\n", 0, 11);
  CHECK(long_span == "    a\n    ^\n    b\n    ~\n    ...\n    f\n    ~\n");
}

TEST_CASE("a long line is cut around its mark", "[format]") {
  const std::string text = marked(std::string(500, 'a') + "X" + std::string(500, 'b'), 500, 501);
  CHECK(text.size() < 350);
  CHECK(text.find("...aaaa") != std::string::npos);
  CHECK(text.find("bbb...") != std::string::npos);
  const std::size_t second = text.find('\n') + 1;
  CHECK(text.find('^') - second == text.find('X'));
}

TEST_CASE("bytes that are no UTF-8 count as Latin-1", "[format]") {
  CHECK(to_utf8("\xe4\xff") == "\xc3\xa4\xc3\xbf");
  CHECK(to_utf8("\xc3\xa4") == "\xc3\xa4");
  CHECK(to_utf8("\xe2\x82") == "\xc3\xa2\xc2\x82");
  CHECK(utf16_length("a\xc3\xa4\xf0\x9f\x98\x80\xff") == 5);
}

TEST_CASE("text names the group of a warning, and of one that is an error", "[format]") {
  Example example;
  CHECK(format_text(example.sources, example.list[1], false).find("dir/b.pmh:3:10: warning: umlaut [PM6003] [-Wunserved-axis]\n") != std::string::npos);
  example.list[1].severity = Severity::kError;
  CHECK(format_text(example.sources, example.list[1], false).find("umlaut [PM6003] [-Werror=unserved-axis]\n") != std::string::npos);
}

TEST_CASE("text shows the include stack before and the macro behind the message", "[format]") {
  Example example;
  const std::string text = format_text(example.sources, example.list[0], false);
  CHECK(text.find("In file included from dir/main file.pmc:1:\n") == 0);
  CHECK(text.find("dir/b.pmh:1:13: note: in the expansion of macro 'BAD'\n") != std::string::npos);
  CHECK(text.find("dir/main file.pmc:1:1: note: see here\n") != std::string::npos);
  CHECK(text.find("fix: write `6`, insert `x` in line 1\n") != std::string::npos);
}

TEST_CASE("colours are escape sequences only where they are wanted", "[format]") {
  Example example;
  CHECK(format_text(example.sources, example.list[0], false).find('\x1b') == std::string::npos);
  CHECK(format_text(example.sources, example.list[0], true).find("\x1b[1;31merror: \x1b[0m") != std::string::npos);
}

TEST_CASE("JSON has places, groups, repairs, macros and the include stack", "[format]") {
  Example example;
  const json parsed = json::parse(format_json(example.sources, example.list));
  const json& error = parsed["diagnostics"][0];
  CHECK(error["file"] == "dir/b.pmh");
  CHECK(error["fix"]["safe"] == true);
  CHECK(error["fix"]["also"][0]["file"] == "dir/main file.pmc");
  CHECK(error["expansion"][0]["macro"] == "BAD");
  CHECK(error["included_from"][0]["line"] == 1);
  CHECK(parsed["diagnostics"][1]["group"] == "unserved-axis");
}

TEST_CASE("GitHub commands are one line each, with escapes", "[format]") {
  Example example;
  CHECK(format_github(example.sources, example.list) ==
        "::error file=dir/b.pmh,line=3,col=4,endColumn=7,title=PM2011::a: b, 100%25%0Anext%0Anote: dir/main file.pmc:1:1: see here\n"
        "::warning file=dir/b.pmh,line=3,col=10,endColumn=11,title=PM6003 -Wunserved-axis::umlaut\n");
}

TEST_CASE("SARIF has what its schema requires", "[format]") {
  Example example;
  const json log = json::parse(format_sarif(example.sources, example.list));
  CHECK(log["version"] == "2.1.0");  // sarifLog: version, runs
  REQUIRE(log["runs"].size() == 1);
  const json& run = log["runs"][0];
  CHECK(run["columnKind"] == "utf16CodeUnits");
  const json& driver = run["tool"]["driver"];  // toolComponent: name
  CHECK(driver["name"] == "pmacc");
  REQUIRE(run["results"].size() == 2);
  for (const json& result : run["results"]) {
    CHECK(result["message"]["text"].is_string());  // result: message
    const auto index = result["ruleIndex"].get<std::size_t>();
    CHECK(driver["rules"][index]["id"] == result["ruleId"]);
    const json& place = result["locations"][0]["physicalLocation"];
    CHECK(place["artifactLocation"]["uri"] == "dir/b.pmh");
    CHECK(place["region"]["startLine"] == 3);
  }
  CHECK(run["results"][0]["level"] == "error");
  CHECK(run["results"][1]["level"] == "warning");
}

TEST_CASE("SARIF columns count UTF-16 units, paths are URIs, repairs are by file", "[format]") {
  Example example;
  const auto umlaut = example.sources.add_file("/abs/c.pmc", "\xc3\xbc\xf0\x9f\x98\x80 X\n");
  example.list.push_back({Severity::kError, "PM2001", {umlaut, 7, 8, -1}, "x", {}, {}});
  const json run = json::parse(format_sarif(example.sources, example.list))["runs"][0];
  const json& last = run["results"][2]["locations"][0]["physicalLocation"];
  CHECK(last["artifactLocation"]["uri"] == "file:///abs/c.pmc");
  CHECK(last["region"]["startColumn"] == 5);  // one unit, a surrogate pair, a blank
  const json& changes = run["results"][0]["fixes"][0]["artifactChanges"];
  REQUIRE(changes.size() == 2);  // artifactChange: artifactLocation, replacements
  CHECK(changes[0]["artifactLocation"]["uri"] == "dir/main%20file.pmc");
  CHECK(changes[1]["replacements"][0]["deletedRegion"]["startColumn"] == 8);
  CHECK(changes[1]["replacements"][0]["insertedContent"]["text"] == "6");
  const json& related = run["results"][0]["relatedLocations"];
  REQUIRE(related.size() == 3);
  CHECK(related[1]["message"]["text"] == "in the expansion of macro 'BAD'");
  CHECK(related[2]["message"]["text"] == "included from here");
}
