// A project in a scratch folder, and what reading it gave.
#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "compiler/project/project.h"
#include "compiler/source/format.h"
#include "tests/unit/gather/scratch_folder.h"

namespace pmac::test {

class ProjectFolder {
 public:
  void write(const std::string& name, const std::string& text) const {
    const std::filesystem::path path = scratch_.file(name);
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary) << text;
  }
  std::string path(const std::string& name = "") const { return scratch_.file(name); }

 private:
  ScratchFolder scratch_;
};

struct ReadProject {
  explicit ReadProject(const std::string& path) : project(compiler::project::read_project(path, sources, diagnostics)) {}

  /// Names of the files without their folders.
  std::vector<std::string> names() const {
    std::vector<std::string> result;
    for (const compiler::InputFile& file : project.files) result.push_back(std::filesystem::path(file.name).filename().string());
    return result;
  }
  /// All messages as text.
  std::string messages() const {
    std::string text;
    for (const source::Diagnostic& diagnostic : diagnostics.all()) text += source::format_text(sources, diagnostic, false);
    return text;
  }

  source::SourceManager sources;
  source::Diagnostics diagnostics;
  compiler::project::Project project;
};

inline std::string ppproj(const std::string& items) {
  return "<?xml version=\"1.0\" encoding=\"utf-8\"?>\r\n<Project xmlns=\"http://schemas.microsoft.com/developer/msbuild/2003\">\r\n<ItemGroup>\r\n" + items +
         "</ItemGroup>\r\n</Project>";
}

inline std::string item(const std::string& include, const std::string& order = "") {
  return "<Content Include=\"" + include + "\">" + (order.empty() ? "" : "<DisplayOrder>" + order + "</DisplayOrder>") + "</Content>\r\n";
}

}  // namespace pmac::test
