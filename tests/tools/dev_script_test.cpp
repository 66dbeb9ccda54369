// What ./dev says to words that it does not know, before it builds anything.
#include <catch2/catch.hpp>

#include "tests/tools/run_shell.h"

using pmac::test::ToolResult;
using pmac::test::Workspace;

TEST_CASE("dev fuzz: targets and numbers that there are not are named, with what there is", "[tools]") {
  const Workspace w;
  const auto fuzz = [&](const std::string& arguments) { return w.shell(std::string(PMAC_SOURCE_DIR "/dev fuzz ") + arguments); };
  const ToolResult unknown = fuzz("--only nosuch");
  CHECK(unknown.code == 2);
  CHECK(unknown.err.find("there is no target 'nosuch'; there are compiler program_run ") != std::string::npos);
  CHECK(fuzz("--only 'comp.*'").code == 2);
  CHECK(fuzz("--only").err == "dev fuzz: a value is missing behind --only\n");
  CHECK(fuzz("--seconds soon").err == "dev fuzz: 'soon' is no number of seconds\n");
  CHECK(fuzz("--often").code == 2);
}
