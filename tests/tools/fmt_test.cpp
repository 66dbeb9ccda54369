// pmacc fmt as a user runs it.
#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "tests/tools/run_shell.h"

using namespace pmac::test;
namespace fs = std::filesystem;

namespace {

const std::string kUgly = "open prog 1\nx10y5\nclose\n";
const std::string kPretty = "open prog 1\nX10 Y5\nclose\n";

}  // namespace

TEST_CASE("fmt rewrites files in place, and leaves formatted ones alone", "[fmt]") {
  const Workspace work;
  work.write("a.pmc", kUgly);
  work.write("b.pmc", kPretty);
  const auto untouched = fs::last_write_time(work.path("b.pmc"));
  const ToolResult ran = work.run("pmacc", "fmt a.pmc b.pmc");
  CHECK(ran.code == 0);
  CHECK(ran.out.empty());
  CHECK(ran.err.empty());
  CHECK(work.read("a.pmc") == kPretty);
  CHECK(fs::last_write_time(work.path("b.pmc")) == untouched);
}

TEST_CASE("fmt: the check option lists the files that would change and changes none", "[fmt]") {
  const Workspace work;
  work.write("a.pmc", kUgly);
  work.write("b.pmc", kPretty);
  const ToolResult ran = work.run("pmacc", "fmt --check a.pmc b.pmc");
  CHECK(ran.code == 1);
  CHECK(ran.out == "a.pmc\n");
  CHECK(work.read("a.pmc") == kUgly);
  CHECK(work.run("pmacc", "fmt --check b.pmc").code == 0);
}

TEST_CASE("fmt: the diff is one that patch understands", "[fmt]") {
  const Workspace work;
  std::string text = "\n\nopen prog 1\n\n\n\nx1\n";
  for (int i = 0; i < 30; ++i) text += i % 11 == 5 ? "Y" + std::to_string(i) + "X1\n\n\n" : "X" + std::to_string(i) + "\n";
  text += "close";  // no line end
  work.write("a.pmc", text);
  const ToolResult diff = work.run("pmacc", "fmt --diff a.pmc");
  CHECK(diff.code == 0);
  CHECK(work.read("a.pmc") == text);
  work.write("a.diff", diff.out);
  if (std::system("command -v patch >/dev/null") != 0) return;
  const std::string patch = "cd '" + work.path("").string() + "' && patch -s a.pmc < a.diff";
  REQUIRE(std::system(patch.c_str()) == 0);
  CHECK(work.run("pmacc", "fmt --check a.pmc").code == 0);
}

TEST_CASE("fmt: check and diff together print the diff and exit with 1", "[fmt]") {
  const Workspace work;
  work.write("a.pmc", kUgly);
  const ToolResult ran = work.run("pmacc", "fmt --check --diff a.pmc");
  CHECK(ran.code == 1);
  CHECK(ran.out == "--- a.pmc\n+++ a.pmc\n@@ -1,3 +1,3 @@\n open prog 1\n-x10y5\n+X10 Y5\n close\n");
}

TEST_CASE("fmt: standard input goes to standard output", "[fmt]") {
  const Workspace work;
  work.write("a.pmc", kUgly);
  const std::string command = "cd '" + work.path("").string() + "' && '" + PMAC_BINARY_DIR + "/bin/pmacc' fmt --indent 2 - < a.pmc > out.pmc";
  CHECK(std::system(command.c_str()) == 0);
  CHECK(work.read("out.pmc") == kPretty);
  CHECK(work.run("pmacc", "fmt --stdout a.pmc").out == kPretty);
  CHECK(work.read("a.pmc") == kUgly);
}

TEST_CASE("fmt: a file that cannot be followed is refused and left as it is, the others are formatted", "[fmt]") {
  const Workspace work;
  const std::string broken = "open prog 1\nif (P1) {\nx1\nclose\n";
  work.write("a.pmc", broken);
  work.write("b.pmc", kUgly);
  const ToolResult ran = work.run("pmacc", "fmt a.pmc b.pmc");
  CHECK(ran.code == 1);
  CHECK(ran.err.find("a.pmc:4:1: error: missing } before 'close' [PM2007]") != std::string::npos);
  CHECK(work.read("a.pmc") == broken);
  CHECK(work.read("b.pmc") == kPretty);
}

TEST_CASE("fmt: usage errors and unreadable files end with 2", "[fmt]") {
  const Workspace work;
  fs::create_directory(work.path("folder"));
  CHECK(work.run("pmacc", "fmt").code == 2);
  CHECK(work.run("pmacc", "fmt --no-such-option a.pmc").code == 2);
  CHECK(work.run("pmacc", "fmt --indent 0 a.pmc").code == 2);
  CHECK(work.run("pmacc", "fmt nowhere.pmc").code == 2);
  const ToolResult folder = work.run("pmacc", "fmt folder");
  CHECK(folder.code == 2);
  CHECK(folder.err.find("there are no script files (.pmh .kin .pmc .plc) in folder") != std::string::npos);
  CHECK(work.run("pmacc", "fmt --help").code == 0);
}

TEST_CASE("fmt: a folder stands for the script files in and below it", "[fmt]") {
  const Workspace work;
  fs::create_directories(work.path("machine/PLC Programs"));
  fs::create_directory(work.path("machine/.git"));
  for (const char* name : {"machine/a.pmc", "machine/PLC Programs/b.plc", "machine/notes.txt", "machine/.git/c.pmc"}) work.write(name, kUgly);
  const ToolResult check = work.run("pmacc", "fmt --check machine");
  CHECK(check.code == 1);
  CHECK(check.out == "machine/PLC Programs/b.plc\nmachine/a.pmc\n");
  CHECK(work.run("pmacc", "fmt machine").code == 0);
  CHECK(work.read("machine/PLC Programs/b.plc") == kPretty);
  CHECK(work.read("machine/notes.txt") == kUgly);
  CHECK(work.read("machine/.git/c.pmc") == kUgly);
  CHECK(work.run("pmacc", "fmt --check machine").code == 0);
}

TEST_CASE("fmt: an unreadable file does not keep the others from being formatted", "[fmt]") {
  const Workspace work;
  work.write("b.pmc", kUgly);
  CHECK(work.run("pmacc", "fmt nowhere.pmc b.pmc").code == 2);
  CHECK(work.read("b.pmc") == kPretty);
}

TEST_CASE("fmt: line ends follow the majority, a missing last one is added", "[fmt]") {
  const Workspace work;
  work.write("crlf.pmc", "open prog 1\r\nx1 // a\r\n/* b\n c */\r\nclose");
  work.write("lf.pmc", "open prog 1\nx1\r\nclose\n");
  CHECK(work.run("pmacc", "fmt crlf.pmc lf.pmc").code == 0);
  CHECK(work.read("crlf.pmc") == "open prog 1\r\nX1  // a\r\n/* b\r\n c */\r\nclose\r\n");
  CHECK(work.read("lf.pmc") == "open prog 1\nX1\nclose\n");
}

TEST_CASE("fmt: bytes beyond ASCII stay, whatever their encoding", "[fmt]") {
  const Workspace work;
  work.write("latin1.pmc", "open prog 1 // gr\xf6\xdf""er\nx1 // \xb5m\nclose\n");
  work.write("bom.pmc", "\xef\xbb\xbfopen prog 1\ncmd\"\xc3\xa4\"   // \xc3\xb6\nclose\n");
  CHECK(work.run("pmacc", "fmt latin1.pmc bom.pmc").code == 0);
  CHECK(work.read("latin1.pmc") == "open prog 1  // gr\xf6\xdf""er\nX1           // \xb5m\nclose\n");
  CHECK(work.read("bom.pmc") == "\xef\xbb\xbfopen prog 1\ncmd \"\xc3\xa4\"  // \xc3\xb6\nclose\n");
}

TEST_CASE("fmt: UTF-16 is refused with its remedy", "[fmt]") {
  const Workspace work;
  const std::string text("\xff\xfeo\0p\0e\0n\0", 10);
  work.write("a.pmc", text);
  const ToolResult ran = work.run("pmacc", "fmt a.pmc");
  CHECK(ran.code == 1);
  CHECK(ran.err.find("save it as UTF-8") != std::string::npos);
  CHECK(work.read("a.pmc") == text);
}

TEST_CASE("fmt: empty files and files of blanks", "[fmt]") {
  const Workspace work;
  work.write("empty.pmc", "");
  work.write("blank.pmc", " \n\t\n\n");
  CHECK(work.run("pmacc", "fmt empty.pmc blank.pmc").code == 0);
  CHECK(work.read("empty.pmc").empty());
  CHECK(work.read("blank.pmc").empty());
}

TEST_CASE("fmt: permissions and links stay", "[fmt]") {
  const Workspace work;
  work.write("real.pmc", kUgly);
  fs::permissions(work.path("real.pmc"), fs::perms::owner_read | fs::perms::owner_write | fs::perms::group_read);
  fs::create_symlink("real.pmc", work.path("link.pmc"));
  CHECK(work.run("pmacc", "fmt link.pmc").code == 0);
  CHECK(fs::is_symlink(work.path("link.pmc")));
  CHECK(work.read("real.pmc") == kPretty);
  CHECK((fs::status(work.path("real.pmc")).permissions() & fs::perms::all) == (fs::perms::owner_read | fs::perms::owner_write | fs::perms::group_read));
}

TEST_CASE("fmt: names of the whole project keep their case", "[fmt]") {
  const Workspace work;
  fs::create_directories(work.path("Includes"));
  fs::create_directories(work.path("Programs"));
  work.write("machine.ppproj", "<Project/>");
  work.write("Includes/names.pmh", "global x, DWELL;\n#define Home P1\n");
  work.write("Programs/a.pmc", "open prog 1\nx=5 DWELL=3\nHome=2\ny7\nclose\n");
  CHECK(work.run("pmacc", "fmt Programs/a.pmc").code == 0);
  CHECK(work.read("Programs/a.pmc") == "open prog 1\nx = 5 DWELL = 3\nHome = 2\nY7\nclose\n");
}

TEST_CASE("fmt: included names keep their case", "[fmt]") {
  const Workspace work;
  fs::create_directories(work.path("other"));
  work.write("other/names.pmh", "#include \"more.pmh\"\n");
  work.write("other/more.pmh", "#define Y 5\n#include \"names.pmh\"\n");
  work.write("a.pmc", "#include \"other/names.pmh\"\nopen prog 1\nX(Y)\nP1=y\nclose\n");
  CHECK(work.run("pmacc", "fmt a.pmc").code == 0);
  CHECK(work.read("a.pmc") == "#include \"other/names.pmh\"\nopen prog 1\nX(Y)\nP1 = y\nclose\n");
}

TEST_CASE("fmt: the programs of the course are formatted", "[fmt]") {
  const Workspace work;
  const ToolResult ran = work.run("pmacc", std::string("fmt --check '") + PMAC_SOURCE_DIR + "/programs/'*.p[ml]c '" + PMAC_SOURCE_DIR + "/programs/kinematics/'*.pmc '" + PMAC_SOURCE_DIR + "/programs/gcode'");
  INFO(ran.out << ran.err);
  CHECK(ran.code == 0);
}
