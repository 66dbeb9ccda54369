// Projects of the vendor's IDE: which files are loaded and in which order. The orders were seen in the pp_proj.ini files that the
// IDE wrote beside the .ppproj files of public projects.
#include <catch2/catch.hpp>

#include "tests/unit/project/project_files.h"

using namespace pmac::test;
using pmac::compiler::project::Unreadable;
using Names = std::vector<std::string>;

namespace {

const std::string kScripts = "PMAC Script Language/";

/// Global a and b, kinematics k, library l, program m, PLC p.
void write_scripts(const ProjectFolder& folder) {
  for (const char* name : {"Global Includes/a.pmh", "Global Includes/b.pmh", "Kinematic Routines/k.kin", "Libraries/l.pmc", "Motion Programs/m.pmc", "PLC Programs/p.plc"})
    folder.write(kScripts + name, "P1=1\n");
}

}  // namespace

TEST_CASE("a .ppproj loads its folders in the controller's order and its files by DisplayOrder", "[project]") {
  const ProjectFolder folder;
  write_scripts(folder);
  const std::string base = "PMAC Script Language\\";
  folder.write("x.ppproj", ppproj(item(base + "PLC Programs\\p.plc", "0") + item(base + "Motion Programs\\m.pmc", "0") + item(base + "Libraries\\l.pmc", "0") +
                                  item(base + "Kinematic Routines\\k.kin", "0") + item(base + "Global Includes\\a.pmh", "1") + item(base + "Global Includes\\b.pmh", "0") +
                                  item("C Language\\Include\\pp_proj.h") + "<Folder Include=\"PMAC Script Language\\Libraries\" />\r\n"));
  const ReadProject read(folder.path("x.ppproj"));
  CHECK(read.names() == Names{"b.pmh", "a.pmh", "k.kin", "l.pmc", "m.pmc", "p.plc"});
  CHECK(read.messages().empty());
}

TEST_CASE("without DisplayOrder the names count, capitals first", "[project]") {
  const ProjectFolder folder;
  std::string items;
  for (const char* name : {"b", "a", "C"}) {
    folder.write(kScripts + "Libraries/" + name + ".pmc", "");
    items += item(std::string("PMAC Script Language\\Libraries\\") + name + ".pmc");
  }
  folder.write("x.ppproj", ppproj(items));
  CHECK(ReadProject(folder.path("x.ppproj")).names() == Names{"C.pmc", "a.pmc", "b.pmc"});
}

TEST_CASE("pp_disable.txt is loaded first and pp_startup.txt last", "[project]") {
  const ProjectFolder folder;
  write_scripts(folder);
  folder.write("Configuration/pp_disable.txt", "disable plc 0..31\n");
  folder.write("Configuration/pp_startup.txt", "enable plc 1\n");
  const Names names = ReadProject(folder.path()).names();
  CHECK(names.front() == "pp_disable.txt");
  CHECK(names.back() == "pp_startup.txt");
  CHECK(names.size() == 8);
}

TEST_CASE("pp_proj.ini gives files and first numbers; the controller's paths are found below the project", "[project]") {
  const ProjectFolder folder;
  write_scripts(folder);
  folder.write("Configuration/pp_proj.ini",
               "[ETHERCAT]\r\nfile1=nothing\r\n[PMAC_PROGRAMS]\r\nPVARSTART=9000\r\nQVARSTART=1100\r\nMVARSTART=8300\r\n"
               "file2=/var/ftp/usrflash/Project/PMAC Script Language/PLC Programs/p.plc\r\nfile1=/var/ftp/usrflash/Project/PMAC Script Language/Libraries/l.pmc\r\n"
               "file10=/var/ftp/usrflash/Project/PMAC Script Language/Motion Programs/m.pmc\r\nlast_file_number=10\r\n[LINUX_PROGRAMS]\r\nprogram1=x");
  const ReadProject read(folder.path("Configuration/pp_proj.ini"));
  CHECK(read.names() == Names{"l.pmc", "p.plc", "m.pmc"});
  CHECK(read.project.starts.p == 9000);
  CHECK(read.project.starts.q == 1100);
  CHECK(read.project.starts.m == 8300);
  CHECK(read.messages().empty());
}

TEST_CASE("a folder is its .ppproj, else its pp_proj.ini, else its script folders, else its scripts by kind", "[project]") {
  const ProjectFolder folder;
  write_scripts(folder);
  CHECK(ReadProject(folder.path()).names() == Names{"a.pmh", "b.pmh", "k.kin", "l.pmc", "m.pmc", "p.plc"});
  folder.write("Configuration/pp_proj.ini", "[PMAC_PROGRAMS]\nfile1=/Project/PMAC Script Language/Libraries/l.pmc\n");
  CHECK(ReadProject(folder.path()).names() == Names{"l.pmc"});
  folder.write("x.ppproj", ppproj(item("PMAC Script Language\\PLC Programs\\p.plc")));
  CHECK(ReadProject(folder.path()).names() == Names{"p.plc"});

  const ProjectFolder loose;
  for (const char* name : {"z.plc", "b.pmc", "a.PMC", "k.kin", "d.pmh", "readme.txt"}) loose.write(name, "");
  CHECK(ReadProject(loose.path()).names() == Names{"d.pmh", "k.kin", "a.PMC", "b.pmc", "z.plc"});
}

TEST_CASE("paths of Windows are found: other case, escapes, blanks", "[project]") {
  const ProjectFolder folder;
  folder.write("PMAC Script Language/Global Includes/Motor 1.pmh", "");
  folder.write("x.ppproj", ppproj(item("pmac script language\\global%20includes\\MOTOR%201.PMH")));
  const ReadProject read(folder.path("x.ppproj"));
  CHECK(read.names() == Names{"Motor 1.pmh"});
  CHECK(read.messages().empty());
}

TEST_CASE("first numbers of variables stand in the project file too", "[project]") {
  const ProjectFolder folder;
  write_scripts(folder);
  folder.write("x.ppproj", "<Project><PropertyGroup><PVarStart>10000</PVarStart><QVarStart>x</QVarStart></PropertyGroup><ItemGroup>" +
                               item("PMAC Script Language\\Libraries\\l.pmc") + "</ItemGroup></Project>");
  const ReadProject read(folder.path("x.ppproj"));
  CHECK(read.project.starts.p == 10000);
  CHECK(read.project.starts.q == 1024);
  CHECK_THAT(read.messages(), Catch::Contains("QVarStart is no number"));
}

TEST_CASE("what is wrong inside of a project is reported with its line", "[project]") {
  const ProjectFolder folder;
  write_scripts(folder);
  struct Row { std::string items, place, message; };
  const std::string base = "PMAC Script Language\\Libraries\\";
  const Row rows[] = {
      {item(base + "missing.pmc"), "x.ppproj:4:19: error:", "missing.pmc\" does not exist"},
      {item(base + "l.pmc") + item(base + "l.pmc"), "x.ppproj:5:19: warning:", "listed twice"},
      {item(base + "readme.doc") + item(base + "l.pmc"), "x.ppproj:4:19: warning:", "is no script file"},
      {item(base + "*.pmc") + item(base + "l.pmc"), "x.ppproj:4:19: error:", "wildcards"},
      {item(base + "l.pmc") + "<Content Include=\"oops></Content>\r\n", "x.ppproj:", "not a well-formed project file"},
  };
  for (const Row& row : rows) {
    folder.write("x.ppproj", ppproj(row.items));
    const std::string messages = ReadProject(folder.path("x.ppproj")).messages();
    INFO(messages);
    CHECK(messages.find(row.place) != std::string::npos);
    CHECK(messages.find(row.message) != std::string::npos);
  }
}

TEST_CASE("misspelt sections and elements of a project are said", "[project]") {
  const ProjectFolder folder;
  folder.write("a.pmc", "P1 = 1\n");
  folder.write("pp_proj.ini", "[CPU_AFFINITY]\nrtitask=2\n[PMAC_PROGRAM]\nfile1=b.pmc\n[PMAC_PROGRAMS]\nPVARSTRAT=5\nfile1=a.pmc\nlast_file_number=1\n[Whatever]\n[open\n");
  const ReadProject ini(folder.path("pp_proj.ini"));
  CHECK(ini.messages().find("pp_proj.ini:3:1: warning: [PMAC_PROGRAM] is no section that the IDE writes, and is not read; did you mean [PMAC_PROGRAMS]?") != std::string::npos);
  CHECK(ini.messages().find("pp_proj.ini:6:1: warning: 'PVARSTRAT' is no setting of [PMAC_PROGRAMS]") != std::string::npos);
  CHECK(ini.messages().find("pp_proj.ini:9:1: warning: [Whatever] is no section that the IDE writes, and is not read") != std::string::npos);
  CHECK(ini.messages().find("pp_proj.ini:10:1: warning: a section is a name in square brackets") != std::string::npos);
  CHECK(ini.messages().find("CPU_AFFINITY") == std::string::npos);

  folder.write("PMAC Script Language/Libraries/b.pmc", "P1 = 1\n");
  folder.write("x.ppproj",
               "<Project>\n<PropertyGroup><PVARSTART>9000</PVARSTART>\n<QVarStrat>5</QVarStrat>\n<FTPPort>21</FTPPort></PropertyGroup>\n<ItemGroup>\n"
               "<Content Include=\"PMAC Script Language\\Libraries\\b.pmc\"/>\n<Content Include=\"elsewhere\\c.pmc\"/></ItemGroup>\n<ItemGrop/></Project>\n");
  const ReadProject project(folder.path("x.ppproj"));
  CHECK(project.project.starts.p == 9000);
  CHECK(project.messages().find("x.ppproj:3:2: warning: <QVarStrat> is not read; did you mean <QVarStart>?") != std::string::npos);
  CHECK(project.messages().find("warning: \"elsewhere/c.pmc\" lies in none of the script folders of a project and is not loaded") != std::string::npos);
  CHECK(project.messages().find("warning: <ItemGrop> is not read; did you mean <ItemGroup>?") != std::string::npos);
  CHECK(project.diagnostics.warning_count() == 3);
}

TEST_CASE("what is no project is refused", "[project]") {
  const ProjectFolder folder;
  folder.write("notes.txt", "");
  CHECK_THROWS_WITH(ReadProject(folder.path()), Catch::Contains("names no script file"));
  CHECK_THROWS_AS(ReadProject(folder.path("none.ppproj")), Unreadable);
  folder.write("a.ppproj", ppproj(""));
  folder.write("b.ppproj", ppproj(""));
  CHECK_THROWS_WITH(ReadProject(folder.path()), Catch::Contains("2 .ppproj files"));
  folder.write("c.ppproj", "<html></html>");
  CHECK_THAT(ReadProject(folder.path("c.ppproj")).messages(), Catch::Contains("not a project file of the IDE"));
}

TEST_CASE("entities of the document are not expanded, and depth is no danger", "[project]") {
  const ProjectFolder folder;
  write_scripts(folder);
  folder.write("bomb.ppproj", "<!DOCTYPE p [<!ENTITY a \"aaaaaaaaaa\"><!ENTITY b \"&a;&a;&a;&a;&a;&a;&a;&a;\"><!ENTITY f SYSTEM \"file:///etc/passwd\">]><Project><ItemGroup>" +
                                  item("PMAC Script Language\\Libraries\\&b;&f;.pmc") + item("PMAC Script Language\\Libraries\\l.pmc") + "</ItemGroup></Project>");
  const ReadProject bomb(folder.path("bomb.ppproj"));
  CHECK(bomb.names() == Names{"l.pmc"});
  CHECK_THAT(bomb.messages(), Catch::Contains("Libraries/&b\" is no script file"));

  std::string deep = "<Project>";
  for (int i = 0; i < 300000; ++i) deep += "<ItemGroup>";
  folder.write("deep.ppproj", deep);
  CHECK_THAT(ReadProject(folder.path("deep.ppproj")).messages(), Catch::Contains("not a well-formed project file"));
  for (int i = 0; i < 300000; ++i) deep += "</ItemGroup>";
  folder.write("deep.ppproj", deep + "</Project>");
  CHECK_THROWS_WITH(ReadProject(folder.path("deep.ppproj")), Catch::Contains("names no script file"));
}

TEST_CASE("a project file of more than 16 MiB and a list of more than 10000 files are refused", "[project]") {
  const ProjectFolder folder;
  folder.write("big.ppproj", std::string((16u << 20) + 1, ' '));
  CHECK_THROWS_WITH(ReadProject(folder.path("big.ppproj")), Catch::Contains("larger than"));
  std::string ini = "[PMAC_PROGRAMS]\n";
  for (int i = 1; i <= 10001; ++i) ini += "file" + std::to_string(i) + "=/Project/x" + std::to_string(i) + ".pmc\n";
  folder.write("pp_proj.ini", ini);
  CHECK_THAT(ReadProject(folder.path("pp_proj.ini")).messages(), Catch::Contains("at most 10000 files"));
}
