// Fuzz target: the files that name the files of a project, as .ppproj (XML) and as pp_proj.ini.
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "compiler/project/project.h"
#include "tests/fuzz/target.h"

using namespace pmac;

namespace {

namespace fs = std::filesystem;

/// A folder with one script file in it; gone at exit.
struct Folder {
  fs::path path = fs::temp_directory_path() / ("fuzz_project_" + std::to_string(getpid()));
  Folder() {
    fs::create_directories(path / "PMAC Script Language/Libraries");
    std::ofstream(path / "PMAC Script Language/Libraries/l.pmc") << "P1=1\n";
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
};

void read(const fs::path& file, std::string_view text) {
  std::ofstream(file, std::ios::binary) << text;
  source::SourceManager sources;
  source::Diagnostics diagnostics;
  try {
    compiler::project::read_project(file.string(), sources, diagnostics);
  } catch (const compiler::project::Unreadable& refused) {
    fuzz::check(*refused.what() != '\0', "a refusal has a message");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Folder folder;
  read(folder.path / "x.ppproj", fuzz::text_of(data, size));
  read(folder.path / "pp_proj.ini", fuzz::text_of(data, size));
  return 0;
}
