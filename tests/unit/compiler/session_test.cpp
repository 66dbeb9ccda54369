#include <catch2/catch.hpp>

#include "compiler/bytecode/opcode.h"
#include "compiler/compiler.h"

using namespace pmac;
using compiler::Session;

namespace {

std::string first_message(Session& session) {
  const auto all = session.diagnostics().take();
  return all.empty() ? std::string() : all.front().message;
}

}  // namespace

TEST_CASE("names stay known from one call to the next", "[session]") {
  Session session;
  REQUIRE(session.compile({{"a.pmh", "global Depth, Table(4);\n#define SPEED 5\n"}}));
  REQUIRE(session.compile({{"b.pmc", "open prog 1\nF(SPEED) X(Depth)\nTable(2) = 1\nclose\n"}}));
  const auto online = session.compile_online("Depth = 3 Depth", "-e");
  REQUIRE(online);
  CHECK(online->load_order.size() == 1);
}

TEST_CASE("the names of an object file are known after adopt", "[session]") {
  Session first;
  const auto module = first.compile({{"a.pmc", "global Depth;\nptr Pump->u.io:$A00000.8.1;\nopen prog Cut\nclose\n"}});
  REQUIRE(module);
  Session second;
  second.adopt(*module);
  CHECK(second.compile_online("Depth=4 Pump=1 &1 start Cut", "-e"));
  // numbers go on behind those of the object file
  const auto more = second.compile({{"b.pmh", "global Width;\n"}});
  REQUIRE(more);
  CHECK(more->symbols.back().number == 8193);
}

TEST_CASE("refused on-line text is answered as the controller does", "[session]") {
  const std::pair<const char*, const char*> cases[] = {
      {"frobnicate", "error #20: ILLEGAL CMD"}, {"Nix = 5", "error #20: ILLEGAL CMD"},       {"#1j?", "error #20: ILLEGAL CMD"},
      {"&99", "error #23: OUT OF RANGE NUMBER"}, {"Motor[99].JogSpeed=1", "error #23: OUT OF RANGE NUMBER"}, {"open prog 1\ngoto 5\nclose", "error #35: INVALID LABEL"},
      {"P1 = 3 +", "error #20: ILLEGAL CMD"}};
  for (const auto& [text, answer] : cases) {
    Session session;
    INFO(text);
    CHECK_FALSE(session.compile_online(text, "-e"));
    CHECK(first_message(session).rfind(answer, 0) == 0);
  }
}

TEST_CASE("a refused on-line text does not spoil the next one", "[session]") {
  Session session;
  CHECK_FALSE(session.compile_online("frobnicate", "-e"));
  CHECK(session.compile_online("P1=5", "-e"));
}

TEST_CASE("all errors are reported in one run", "[session]") {
  Session session;
  CHECK_FALSE(session.compile({{"a.pmc", "open prog 1\nX10 +\nP1 =\nfoo\nF-3\nbar = 5\nclose\n"}}));
  CHECK(session.diagnostics().error_count() == 5);
}

TEST_CASE("a module of good text passes verify and names its files", "[session]") {
  Session session;
  const auto module = session.compile({{"set.cfg", "&1 #1->1000X\n"}, {"a.pmc", "open prog 5\nX10\nclose\n"}});
  REQUIRE(module);
  CHECK(bytecode::verify(*module).empty());
  CHECK(module->files == std::vector<std::string>{"set.cfg", "a.pmc"});
  CHECK(module->load_order.size() == 2);
}

TEST_CASE("a coordinate-system variable set by a load stream addresses &1 first", "[session]") {
  Session session;
  const auto module = session.compile({{"a.pmc", "csglobal Depth = 4;\n"}});
  REQUIRE(module);
  CHECK(session.diagnostics().warning_count() == 1);
  const bytecode::Program& load = module->programs[module->load_order[0]];
  CHECK(load.code[1].op == bytecode::Opcode::kAddressCoord);
}

TEST_CASE("empty, blank and comment-only texts are modules that do nothing", "[session]") {
  for (const char* text : {"", "\n", "// nothing", "/* nothing */", "\xef\xbb\xbf", ";;;"}) {
    Session session;
    INFO(text);
    CHECK(session.compile({{"a.pmc", text}}));
  }
}

TEST_CASE("line ends of all systems and no final line end are the same program", "[session]") {
  const auto code = [](const char* text) {
    Session session;
    return session.compile({{"a.pmc", text}})->programs[0].code;
  };
  CHECK(code("open prog 1\nX1\nY2\nclose\n") == code("open prog 1\r\nX1\r\nY2\r\nclose"));
}
