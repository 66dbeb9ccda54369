// pmacc --fix and the message options, through the tool.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "tests/tools/run_shell.h"

using pmac::test::ToolResult;
using pmac::test::Workspace;

namespace {

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("repairs are made in place, said, and are the same the second time", "[fix]") {
  const Workspace w;
  w.write("a.pmc", "#define lookahead 3000\r\nglobal Speed\nopen prog 1\nlinaer\nif (P1 = 5 && P2 == 6) XP1\nF(speed)\nclose\n");
  const ToolResult first = w.run("pmacc", "--fix a.pmc");
  INFO(first.err);
  CHECK(first.code == 0);
  const std::string mended = "&1 define lookahead 3000\r\nglobal Speed\nopen prog 1\nlinear\nif (P1 == 5 && P2 == 6) X(P1)\nF(Speed)\nclose\n";
  CHECK(w.read("a.pmc") == mended);
  CHECK(contains(first.err, "a.pmc:4:1: fixed: "));
  const ToolResult second = w.run("pmacc", "--fix a.pmc");
  CHECK_FALSE(contains(second.err, "fixed"));
  CHECK(w.read("a.pmc") == mended);
}

TEST_CASE("a guess that is not certain is shown and not made", "[fix]") {
  const Workspace w;
  const std::string text = "global Speed, Speep\nP1 = Speet\n";
  w.write("a.pmc", text);
  const ToolResult r = w.run("pmacc", "--fix a.pmc");
  CHECK(r.code == 1);
  CHECK(contains(r.err, "suggestion: write `Speed`"));
  CHECK(w.read("a.pmc") == text);
}

TEST_CASE("text that comes out of a macro is not repaired", "[fix]") {
  const Workspace w;
  const std::string text = "#define TEST if (P1 = 5)\nopen prog 1\nTEST X1\nclose\n";
  w.write("a.pmc", text);
  CHECK(w.run("pmacc", "--fix a.pmc").code == 1);
  CHECK(w.read("a.pmc") == text);
}

TEST_CASE("an included file of the project is repaired, one from a -I folder is not", "[fix]") {
  const Workspace w;
  w.write("a.pmc", "#include \"own.pmh\"\n#include \"library.pmh\"\n");
  w.write("own.pmh", "open prog 1\nXP1\nclose\n");
  const std::string library = "open prog 2\nXP1\nclose\n";
  std::filesystem::create_directory(w.path("lib"));
  w.write("lib/library.pmh", library);
  CHECK(w.run("pmacc", "-I lib --fix a.pmc").code == 1);
  CHECK(w.read("own.pmh") == "open prog 1\nX(P1)\nclose\n");
  CHECK(w.read("lib/library.pmh") == library);
}

TEST_CASE("a dry run prints the difference and changes nothing", "[fix]") {
  const Workspace w;
  const std::string text = "open prog 1\nXP1\nclose\n";
  w.write("a.pmc", text);
  const ToolResult r = w.run("pmacc", "--fix-dry-run a.pmc");
  CHECK(r.code == 0);
  CHECK(r.out == "--- a.pmc\n+++ a.pmc\n@@ -1,3 +1,3 @@\n open prog 1\n-XP1\n+X(P1)\n close\n");
  CHECK(w.read("a.pmc") == text);
}

TEST_CASE("a dry run says which errors no repair would mend", "[fix]") {
  const Workspace w;
  w.write("a.pmc", "open prog 1\nXP1\nP2 = Nothing\nclose\n");
  const ToolResult r = w.run("pmacc", "--fix-dry-run a.pmc");
  CHECK(r.code == 1);
  CHECK(contains(r.out, "+X(P1)"));
  CHECK(contains(r.err, "1 error(s) would be left; pmacc --check shows them"));
  w.write("b.pmc", "open prog 1\nP2 = Nothing\nclose\n");
  CHECK(w.run("pmacc", "--fix-dry-run b.pmc").code == 1);
  w.write("c.pmc", "open prog 1\nlinear X1\nclose\n");
  CHECK(w.run("pmacc", "--fix-dry-run c.pmc").code == 0);
}

TEST_CASE("formats of tools stand alone on standard error", "[messages]") {
  const Workspace w;
  w.write("a.pmc", "open prog 1\nXP1\nclose\n");
  const ToolResult json = w.run("pmacc", "--diagnostics-format=json a.pmc");
  CHECK(nlohmann::json::parse(json.err)["diagnostics"].size() == 1);
  const ToolResult sarif = w.run("pmacc", "--diagnostics-format=sarif a.pmc");
  CHECK(nlohmann::json::parse(sarif.err)["runs"][0]["results"][0]["ruleId"] == "PM2012");
  const ToolResult github = w.run("pmacc", "--diagnostics-format=github a.pmc");
  CHECK(github.err == "::error file=a.pmc,line=2,col=2,endColumn=4,title=PM2012::a value that is no constant stands in parentheses: (P1)\n");
  for (const ToolResult& r : {json, sarif, github}) CHECK(r.code == 1);
  w.write("good.pmc", "P1 = 1\n");
  const ToolResult clean = w.run("pmacc", "--diagnostics-format=sarif good.pmc");
  CHECK(clean.code == 0);
  CHECK(nlohmann::json::parse(clean.err)["runs"][0]["results"].empty());
}

TEST_CASE("warnings are switched by name; a misspelt name is said", "[messages]") {
  const Workspace w;
  w.write("a.pmc", "global Table(10)\nTable(10) = 1\n");
  CHECK(contains(w.run("pmacc", "a.pmc").err, "[PM3047] [-Warray-bounds]"));
  CHECK(w.run("pmacc", "-Wno-array-bounds a.pmc").err.empty());
  CHECK(w.run("pmacc", "-w a.pmc").err.empty());
  const ToolResult error = w.run("pmacc", "-Werror=array-bounds -o a.pmx a.pmc");
  CHECK(error.code == 1);
  CHECK(contains(error.err, "error: "));
  CHECK(contains(error.err, "[-Werror=array-bounds]"));
  CHECK(w.run("pmacc", "-Werror -Wno-error=array-bounds a.pmc").code == 0);
  const ToolResult unknown = w.run("pmacc", "-Warray-bound a.pmc");
  CHECK(unknown.code == 0);
  CHECK(contains(unknown.err, "pmacc: warning: unknown warning option -Warray-bound; did you mean -Warray-bounds?"));
}

TEST_CASE("a message is explained by its code; an unknown code is met with the nearest", "[messages]") {
  const Workspace w;
  const ToolResult r = w.run("pmacc", "--explain PM2011");
  CHECK(r.code == 0);
  CHECK(contains(r.out, "if (P1 == 5)"));
  const ToolResult unknown = w.run("pmacc", "--explain PM20111");
  CHECK(unknown.code == 2);
  CHECK(contains(unknown.err, "did you mean PM2011?"));
  CHECK(contains(w.run("pmacc", "--help-warnings").out, "array-bounds"));
}

TEST_CASE("errors behind the limit are counted; 0 is no limit", "[messages]") {
  const Workspace w;
  std::string text = "open prog 1\n";
  for (int i = 0; i < 150; ++i) text += "XP1\n";
  w.write("a.pmc", text + "close\n");
  CHECK(contains(w.run("pmacc", "--error-limit 10 a.pmc").err, "140 more error(s) are not shown\n150 error(s)"));
  CHECK_FALSE(contains(w.run("pmacc", "--error-limit 0 a.pmc").err, "more error"));
}

TEST_CASE("a program of Turbo PMAC is rewritten in the braces, operators and comments of Power PMAC", "[fix]") {
  const Workspace w;
  w.write("old.pmc",
          "; the homing of one stage\n"
          "; by hand\n"
          "OPEN PLC 5 CLEAR\n"
          "IF (P1=5)\n"
          "AND (P2=6 OR P3=7)\n"
          "  P2=1 ; one\n"
          "ELSE\n"
          "  WHILE (P1<3)\n"
          "    P1=P1+1\n"
          "  ENDW\n"
          "ENDIF\n"
          "DISPLC5\n"
          "CLOSE\n");
  const ToolResult r = w.run("pmacc", "--fix old.pmc");
  INFO(r.err);
  CHECK(r.code == 0);
  const std::string mended =
      "// the homing of one stage\n"
      "// by hand\n"
      "OPEN PLC 5 \n"
      "IF ((P1==5)\n"
      "&& (P2==6 || P3==7)) {\n"
      "  P2=1 // one\n"
      "} else {\n"
      "  WHILE (P1<3) {\n"
      "    P1=P1+1\n"
      "  }\n"
      "}\n"
      "disable plc 5\n"
      "CLOSE\n";
  CHECK(w.read("old.pmc") == mended);
  CHECK(w.run("pmacc", "--fix old.pmc").err.empty());
  CHECK(w.read("old.pmc") == mended);
}

TEST_CASE("long lists of one Turbo PMAC spelling are cut short for people, and whole for tools", "[messages]") {
  const Workspace w;
  std::string text = "open plc 1\n";
  for (int i = 0; i < 20; ++i) text += "if (P1 == 1)\nP2=1\nendif\n";
  w.write("old.pmc", text + "close\n");
  const ToolResult r = w.run("pmacc", "--check old.pmc");
  CHECK(contains(r.err, "old.pmc: note: 18 more [PM2021] (Turbo PMAC block) in line 10, 13, "));
  CHECK(contains(r.err, "20 error(s)"));
  CHECK_FALSE(contains(w.run("pmacc", "--check --repeat-limit=0 old.pmc").err, "more [PM2021]"));
  CHECK(nlohmann::json::parse(w.run("pmacc", "--diagnostics-format=json old.pmc").err)["diagnostics"].size() == 20);
}
