// Names that the neighbours of a file declare, for the formatter: a word that is a name anywhere keeps its letter case.
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>

#include "compiler/style/style.h"

namespace pmac::pmacc {

class ProjectNames {
 public:
  /// Names of the script files of the file's project, and of what the text includes. The project is the nearest folder above the
  /// file that holds a .ppproj or pp_proj.ini or is called "PMAC Script Language"; without one, the file's own folder.
  style::Names of(const std::filesystem::path& file, const std::string& text);

 private:
  const style::Names& of_folder(const std::filesystem::path& folder, bool with_subfolders);
  void add_includes(const std::filesystem::path& file, const std::string& text, style::Names& names, std::set<std::filesystem::path>& seen);

  std::map<std::filesystem::path, style::Names> folders_;
};

}  // namespace pmac::pmacc
