#include "compiler/tool/project_names.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>

#include "compiler/source/encoding.h"

namespace pmac::pmacc {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxFiles = 2000;               // of one project
constexpr std::size_t kMaxEntries = 50000;            // looked at in the folders of one project
constexpr std::uintmax_t kMaxBytes = 32u << 20;       // read from one project
constexpr std::uintmax_t kLargestHeader = 4u << 20;   // bytes; longer files are part programs, which declare nothing
constexpr int kMaxFoldersUp = 12;
constexpr std::size_t kMaxIncludes = 200;

bool is_script(const fs::path& path) {
  constexpr std::array<std::string_view, 6> kExtensions{".pmc", ".plc", ".pmh", ".kin", ".cfg", ".h"};
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return std::find(kExtensions.begin(), kExtensions.end(), extension) != kExtensions.end();
}

std::string text_of(const fs::path& file) {
  std::error_code error;
  if (fs::file_size(file, error) > kLargestHeader || error) return {};
  std::ifstream stream(file, std::ios::binary);
  return source::decode_text({std::istreambuf_iterator<char>(stream), {}});
}

bool is_project(const fs::path& folder) {
  std::error_code error;
  if (folder.filename() == "PMAC Script Language") return true;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    if (entry->path().extension() == ".ppproj" || entry->path().filename() == "pp_proj.ini") return true;
  return false;
}

/// The project's folder, or empty.
fs::path project_of(fs::path folder) {
  for (int up = 0; up < kMaxFoldersUp && !folder.empty(); ++up, folder = folder.parent_path()) {
    if (is_project(folder)) return folder;
    if (folder == folder.root_path()) break;
  }
  return {};
}

template <class Iterator>
std::vector<fs::path> scripts_of(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  std::size_t entries = 0;
  for (Iterator entry(folder, fs::directory_options::skip_permission_denied, error), end; !error && entry != end && files.size() < kMaxFiles && entries < kMaxEntries; entry.increment(error), ++entries)
    if (std::error_code ignored; entry->is_regular_file(ignored) && is_script(entry->path())) files.push_back(entry->path());
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

style::Names ProjectNames::of(const fs::path& file, const std::string& text) {
  std::error_code error;
  const fs::path folder = fs::absolute(file, error).lexically_normal().parent_path();
  const fs::path project = project_of(folder);
  style::Names names = of_folder(project.empty() ? folder : project, !project.empty());
  std::set<fs::path> seen;
  add_includes(file, text, names, seen);
  return names;
}

const style::Names& ProjectNames::of_folder(const fs::path& folder, bool with_subfolders) {
  const auto [found, is_new] = folders_.try_emplace(folder);
  if (!is_new) return found->second;
  const auto files = with_subfolders ? scripts_of<fs::recursive_directory_iterator>(folder) : scripts_of<fs::directory_iterator>(folder);
  std::uintmax_t bytes = 0;
  for (const fs::path& file : files) {
    const std::string text = text_of(file);
    bytes += text.size();
    if (bytes > kMaxBytes) break;
    style::collect_names(text, found->second);
  }
  return found->second;
}

void ProjectNames::add_includes(const fs::path& file, const std::string& text, style::Names& names, std::set<fs::path>& seen) {
  for (std::string name : style::included_files(text)) {
    std::replace(name.begin(), name.end(), '\\', '/');
    const fs::path path = (file.parent_path() / name).lexically_normal();
    if (seen.size() >= kMaxIncludes || !seen.insert(path).second) continue;
    std::error_code ignored;
    if (!fs::is_regular_file(path, ignored)) continue;
    const std::string included = text_of(path);
    style::collect_names(included, names);
    add_includes(path, included, names, seen);
  }
}

}  // namespace pmac::pmacc
