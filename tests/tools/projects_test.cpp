// A project of the vendor's IDE through the tools. Its Database folder holds the symbol files that the IDE's rules give, written by
// hand: numbers from P8192, Q1024 and M8192 on, arrays advancing by their size; programs from 100000; PLC programs from 1, numbers
// in use skipped; SUB: routines from 10000; arguments before locals, both from L0, and again from L0 behind a SUB:.
#include <catch2/catch.hpp>

#include "tests/tools/run_shell.h"

using pmac::test::ToolResult;
using pmac::test::Workspace;

namespace {

const std::string kProject = std::string("'") + PMAC_SOURCE_DIR + "/tests/projects/small_machine'";

std::string last_part(const std::string& line) { return line.substr(line.find_last_of('/') + 1); }

}  // namespace

TEST_CASE("symbols of a project are the vendor's, row by row", "[tools][project]") {
  const Workspace w;
  const ToolResult symbols = w.run("pmacc", "--emit=symbols " + kProject);
  INFO(symbols.err);
  REQUIRE(symbols.code == 0);
  w.write("symbols.txt", symbols.out);
  const ToolResult compared = w.run("compare_symbols", "symbols.txt " + kProject + "/Database");
  INFO(compared.out);
  CHECK(compared.code == 0);
  w.write("symbols.txt", symbols.out + "prog Other 100001\n");
  CHECK(w.run("compare_symbols", "symbols.txt " + kProject + "/Database").code == 1);
}

TEST_CASE("a folder, a .ppproj and a pp_proj.ini are taken by both tools", "[tools][project]") {
  const Workspace w;
  const ToolResult files = w.run("pmacc", "--emit=files " + kProject);
  REQUIRE(files.code == 0);
  std::string names;
  for (std::size_t at = 0, end; at < files.out.size(); at = end + 1) {
    end = files.out.find('\n', at);
    names += last_part(files.out.substr(at, end - at)) + " ";
  }
  CHECK(names == "pp_disable.txt variables.pmh tilt.kin wait.pmc move.pmc a.plc b.plc pp_startup.txt ");

  const std::string project = kProject + "/small_machine.ppproj";
  CHECK(w.run("pmacc", "--check " + project).code == 0);
  const ToolResult run = w.run("pmac-run", project + " --until 0.05 -e '&1 Lamp Height'");
  INFO(run.err);
  CHECK(run.code == 0);

  w.write("one.pmc", "P1=1\n");
  w.write("pp_proj.ini", "[PMAC_PROGRAMS]\nPVARSTART=9000\nfile1=/var/ftp/usrflash/Project/one.pmc\nfile2=/var/ftp/usrflash/Project/two.pmc\n");
  const ToolResult missing = w.run("pmacc", "--check pp_proj.ini");
  CHECK(missing.code == 1);
  CHECK(missing.err.find("pp_proj.ini:4:7: error: the project's file \"two.pmc\" does not exist") != std::string::npos);
  w.write("two.pmc", "global Speed = 3\n");
  CHECK(w.run("pmacc", "--emit=symbols pp_proj.ini").out == "global Speed P9000\n");
  CHECK(w.run("pmacc", "--emit=symbols .").out == "global Speed P9000\n");
  CHECK(w.run("pmac-run", "pp_proj.ini").code == 0);
}

TEST_CASE("what is no project ends with exit code 2", "[tools][project]") {
  const Workspace w;
  for (const char* name : {".", "none.ppproj", "pp_proj.ini"}) {
    CHECK(w.run("pmacc", std::string("--check ") + name).code == 2);
    CHECK(w.run("pmac-run", name).code == 2);
  }
}

TEST_CASE("script folders may stand in the project's folder itself", "[tools][project]") {
  const Workspace w;
  for (const char* folder : {"s/PLC Programs", "s/Global Includes", "s/Motion Programs"}) std::filesystem::create_directories(w.path(folder));
  w.write("s/Global Includes/names.pmh", "global A;\n");
  w.write("s/Motion Programs/one.pmc", "open prog 1\nA = 1\nclose\n");
  w.write("s/PLC Programs/two.plc", "open plc 2\nA = 2\nclose\n");
  const ToolResult files = w.run("pmacc", "--emit=files s");
  CHECK(files.code == 0);
  CHECK(files.out.find("names.pmh") < files.out.find("one.pmc"));
  CHECK(files.out.find("one.pmc") < files.out.find("two.plc"));
  CHECK(w.run("pmacc", "--check s").code == 0);
}
