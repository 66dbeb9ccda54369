#include "compiler/source/warning_control.h"

#include <catch2/catch.hpp>

#include "compiler/compiler.h"

using namespace pmac::source;

namespace {

const MessageInfo& row(std::string_view code) { return *find_message(code); }

WarningOptions options(std::initializer_list<std::string_view> list) {
  WarningOptions result;
  for (const std::string_view option : list) CHECK(result.apply(option).empty());
  return result;
}

/// Codes of the messages of one file, as "W6003" or "E6003".
std::string codes(const std::string& text, WarningOptions warnings = {}) {
  pmac::compiler::Options settings;
  settings.warnings = std::move(warnings);
  pmac::compiler::Session session(settings);
  session.compile({{"a.pmc", text}});
  std::string list;
  for (const Diagnostic& diagnostic : session.diagnostics().take()) list += (diagnostic.severity == Severity::kError ? "E" : "W") + diagnostic.code.substr(2) + " ";
  return list;
}

const std::string kTable = "global Table(10)\n";

}  // namespace

TEST_CASE("warnings are on by default, with -Wall, or with -Wextra", "[warnings]") {
  CHECK(options({}).is_on(row("PM3047")));
  CHECK_FALSE(options({}).is_on(row("PM6010")));
  CHECK_FALSE(options({"all"}).is_on(row("PM6010")));
  CHECK(options({"extra"}).is_on(row("PM6010")));
  CHECK(options({"stored-element"}).is_on(row("PM6010")));
}

TEST_CASE("a named warning option wins over all and extra; the last of two wins", "[warnings]") {
  CHECK_FALSE(options({"no-array-bounds", "all"}).is_on(row("PM3047")));
  CHECK_FALSE(options({"extra", "no-stored-element"}).is_on(row("PM6010")));
  CHECK(options({"no-array-bounds", "array-bounds"}).is_on(row("PM3047")));
}

TEST_CASE("option -Werror=name switches a warning on and makes it an error; -Wno-error=name leaves it a warning", "[warnings]") {
  CHECK(options({"error=stored-element"}).is_on(row("PM6010")));
  CHECK(options({"error=stored-element"}).is_error(row("PM6010")));
  CHECK(options({"error"}).is_error(row("PM3047")));
  CHECK_FALSE(options({"error", "no-error=array-bounds"}).is_error(row("PM3047")));
  CHECK(options({"error", "no-error=array-bounds"}).is_on(row("PM3047")));
  CHECK_FALSE(options({"error=array-bounds", "no-error"}).is_error(row("PM3047")));
}

TEST_CASE("an unknown warning name is named with the nearest one", "[warnings]") {
  WarningOptions o;
  CHECK(o.apply("array-bound") == "unknown warning option -Warray-bound; did you mean -Warray-bounds?");
  CHECK(o.apply("no-array-bound") == "unknown warning option -Wno-array-bound; did you mean -Wno-array-bounds?");
  CHECK(o.apply("error=array-bound") == "unknown warning option -Werror=array-bound; did you mean -Werror=array-bounds?");
  CHECK(o.apply("qqqqqqqq") == "unknown warning option -Wqqqqqqqq");
}

TEST_CASE("a warning that is an error stops the compilation", "[warnings]") {
  pmac::compiler::Options settings;
  settings.warnings = options({"error=array-bounds"});
  pmac::compiler::Session session(settings);
  CHECK_FALSE(session.compile({{"a.pmc", kTable + "Table(10) = 1\n"}}).has_value());
  CHECK(codes(kTable + "Table(10) = 1\n", options({"error"})) == "E3047 ");
  WarningOptions silent;
  silent.silence();
  CHECK(codes(kTable + "Table(10) = 1\n", silent).empty());
}

TEST_CASE("a comment keeps a warning quiet on its line, the next line, or in its file", "[warnings]") {
  CHECK(codes(kTable + "Table(10) = 1\n") == "W3047 ");
  CHECK(codes(kTable + "Table(10) = 1  // pmacc: ignore(array-bounds)\n").empty());
  CHECK(codes(kTable + "// pmacc: ignore(array-bounds)\nTable(10) = 1\n").empty());
  CHECK(codes(kTable + "// pmacc: ignore(array-bounds)\n// the gap is meant\nTable(10) = 1\n").empty());
  CHECK(codes(kTable + "// pmacc: ignore(array-bounds)\nTable(10) = 1\nTable(11) = 1\n") == "W3047 ");
  CHECK(codes(kTable + "Table(10) = 1\nTable(11) = 1\n// pmacc: ignore-file(array-bounds)\n").empty());
  CHECK(codes(kTable + "Table(10) = 1  // pmacc: ignore(redeclared, array-bounds)\n").empty());
}

TEST_CASE("a suppression comment must be one, and keeps no error quiet", "[warnings]") {
  CHECK(codes(kTable + "Table(10) = 1  // see pmacc: ignore(array-bounds)\n") == "W3047 ");
  CHECK(codes("nothing = 1 // pmacc: ignore(undeclared)\n").find("E3054") == 0);
}

TEST_CASE("option -Wextra names suppressions of unknown names, and those without use", "[warnings]") {
  CHECK(codes("P1 = 1 // pmacc: ignore(array-bounds)\n", options({"extra"})) == "W7021 ");
  CHECK(codes("P1 = 1 // pmacc: ignore(array-bound)\n", options({"extra"})) == "W7020 ");
  CHECK(codes(kTable + "Table(10) = 1  // pmacc: ignore(array-bounds)\n", options({"extra"})).empty());
  CHECK(codes("P1 = \n// pmacc: ignore-file(array-bounds)\n", options({"extra"})).find("7021") == std::string::npos);
}
