#include "compiler/source/fix.h"

#include <catch2/catch.hpp>

using namespace pmac::source;

namespace {

struct Bench {
  SourceManager sources;
  std::int32_t file;
  std::vector<Diagnostic> list;

  explicit Bench(std::string text) : file(sources.add_file("a.pmc", std::move(text))) {}

  Diagnostic& add(std::uint32_t begin, std::uint32_t end, const char* replacement, FixSafety safety = FixSafety::kSafe) {
    Diagnostic d{Severity::kError, "PM2011", {file, begin, end, -1}, "x", {}, {}};
    d.fix = FixIt{{file, begin, end, -1}, replacement, safety, {}};
    list.push_back(d);
    return list.back();
  }
  FixPlan plan() const {
    return plan_fixes(sources, list, [](const std::string&) { return true; });
  }
  std::string fixed() const {
    const FixPlan p = plan();
    return p.files.empty() ? sources.file(file).text : apply_edits(p.files.begin()->second);
  }
};

}  // namespace

TEST_CASE("repairs are done in order of place, whatever their order of report", "[fix]") {
  Bench bench("if (a = b) X c");
  bench.add(13, 14, "(c)");
  bench.add(6, 7, "==");
  CHECK(bench.fixed() == "if (a == b) X (c)");
}

TEST_CASE("of two repairs that overlap the first is done, the other left for the next round", "[fix]") {
  Bench bench("abcdef");
  bench.add(1, 4, "X");
  bench.add(3, 5, "Y");
  CHECK(bench.fixed() == "aXef");
  CHECK(bench.plan().conflicting.size() == 1);
  CHECK(bench.plan().applied.size() == 1);
}

TEST_CASE("the same edit of two repairs is done once; an insertion beside a replacement is no overlap", "[fix]") {
  Bench bench("abc");
  bench.add(1, 2, "X");
  bench.add(1, 2, "X");
  bench.add(2, 2, "+");
  CHECK(bench.fixed() == "aX+c");
}

TEST_CASE("a repair of several edits is done whole or not at all", "[fix]") {
  Bench bench("abcdef");
  bench.add(4, 5, "!");
  bench.add(0, 1, "A").fix->also.push_back({{bench.file, 4, 6, -1}, "?"});
  CHECK(bench.fixed() == "abcd!f");
}

TEST_CASE("suggestions, macro expansions and foreign files are left alone", "[fix]") {
  Bench bench("abc");
  bench.add(0, 1, "X", FixSafety::kSuggestion);
  bench.add(1, 2, "Y").fix->span.expansion = 0;
  CHECK(bench.fixed() == "abc");
  bench.add(2, 3, "Z");
  CHECK(plan_fixes(bench.sources, bench.list, [](const std::string&) { return false; }).files.empty());
}

TEST_CASE("a unified diff has hunks with three lines of context", "[fix]") {
  Bench bench("1\n2\n3\n4\n5\n6\n7\n8\n9\n10\n11\n12\n13\n14\n15");
  bench.add(8, 9, "five\n5b");   // line 5
  bench.add(33, 35, "fifteen");  // line 15, without a line end
  const FixPlan plan = bench.plan();
  CHECK(unified_diff("a.pmc", plan.files.at("a.pmc")) ==
        "--- a.pmc\n+++ a.pmc\n"
        "@@ -2,7 +2,8 @@\n 2\n 3\n 4\n-5\n+five\n+5b\n 6\n 7\n 8\n"
        "@@ -12,4 +13,4 @@\n 12\n 13\n 14\n-15\n\\ No newline at end of file\n+fifteen\n\\ No newline at end of file\n");
}
