#include "tests/tools/run_shell.h"

#include <cstdlib>
#include <fstream>
#include <sstream>

#include <sys/wait.h>

namespace pmac::test {
namespace {

std::string slurp(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

}  // namespace

Workspace::Workspace() {
  std::string name = (std::filesystem::temp_directory_path() / "pmac-test-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
  folder_ = name;
}

Workspace::~Workspace() {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

void Workspace::write(const std::string& name, const std::string& bytes) const {
  std::ofstream(path(name), std::ios::binary) << bytes;
}

std::string Workspace::read(const std::string& name) const { return slurp(path(name)); }

ToolResult Workspace::run(const std::string& tool, const std::string& arguments) const {
  const std::string command = "cd '" + folder_.string() + "' && timeout 60 '" + PMAC_BINARY_DIR + "/bin/" + tool + "' </dev/null " + arguments +
                              " >.out 2>.err";  // input of the arguments' own comes later and wins
  const int status = std::system(command.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, slurp(path(".out")), slurp(path(".err"))};
}

ToolResult Workspace::shell(const std::string& command) const {
  write(".command", "PATH='" PMAC_BINARY_DIR "/bin':$PATH\n" + command + "\n");
  const int status = std::system(("cd '" + folder_.string() + "' && timeout 60 bash .command </dev/null >.out 2>.err").c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, slurp(path(".out")), slurp(path(".err"))};
}

std::string program(const std::string& name) { return std::string("'") + PMAC_SOURCE_DIR + "/programs/" + name + "'"; }

}  // namespace pmac::test
