// Finding files: paths as Windows wrote them on a file system that minds case, and the order of the script folders.
#include "compiler/project/listing.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>

namespace pmac::compiler::project {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kScriptFolder = "pmac script language";
constexpr std::array<std::string_view, 5> kFolders{"global includes", "kinematic routines", "libraries", "motion programs", "plc programs"};
constexpr std::array<std::string_view, 4> kExtensions{".pmh", ".kin", ".pmc", ".plc"};  // in the order of their folders

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return result;
}

std::vector<std::string> components_of(std::string_view path) {
  std::vector<std::string> parts;
  for (std::size_t at = 0; at <= path.size();) {
    const std::size_t end = std::min(path.find('/', at), path.size());
    if (end > at && path.substr(at, end - at) != ".") parts.emplace_back(path.substr(at, end - at));
    at = end + 1;
  }
  return parts;
}

/// The entry of a folder with this name, in whatever case.
std::optional<fs::path> find_in_folder(const fs::path& folder, const std::string& name) {
  std::error_code error;
  if (fs::exists(folder / name, error)) return folder / name;
  const std::string wanted = lower(name);
  std::vector<fs::path> found;
  for (auto entry = fs::directory_iterator(folder, error); !error && entry != fs::directory_iterator(); entry.increment(error))
    if (lower(entry->path().filename().string()) == wanted) found.push_back(entry->path());
  if (found.empty()) return std::nullopt;
  return *std::min_element(found.begin(), found.end());
}

std::size_t extension_rank(const fs::path& path) {
  const std::string extension = lower(path.extension().string());
  return static_cast<std::size_t>(std::find(kExtensions.begin(), kExtensions.end(), extension) - kExtensions.begin());
}

std::vector<fs::path> scripts_in(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (auto entry = fs::directory_iterator(folder, error); !error && entry != fs::directory_iterator(); entry.increment(error))
    if (entry->is_regular_file(error) && is_script(entry->path().string())) files.push_back(entry->path());
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    const auto ranks = std::pair(extension_rank(a), extension_rank(b));
    return ranks.first != ranks.second ? ranks.first < ranks.second : a.filename() < b.filename();
  });
  return files;
}

/// The scripts of Global Includes and the other script folders of `scripts`, which lies at `relative` below the project's folder.
void add_script_folders(const fs::path& scripts, const fs::path& relative, Listing& listing) {
  for (const std::string_view name : kFolders) {
    const auto sub = find_file(scripts, name);
    if (!sub) continue;
    for (const fs::path& file : scripts_in(*sub)) listing.entries.push_back({(relative / sub->filename() / file.filename()).generic_string(), {}});
  }
}

}  // namespace

std::optional<std::string> read_bytes(const fs::path& path, std::size_t limit) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return std::nullopt;
  std::ifstream stream(path, std::ios::binary);
  if (!stream) return std::nullopt;
  std::string text;
  std::array<char, 65536> buffer{};
  while (stream.read(buffer.data(), buffer.size()) || stream.gcount() > 0) {
    text.append(buffer.data(), static_cast<std::size_t>(stream.gcount()));
    if (text.size() > limit) return std::nullopt;
  }
  return stream.bad() ? std::nullopt : std::optional(std::move(text));
}

std::optional<fs::path> find_file(const fs::path& root, std::string_view relative) {
  fs::path path = root;
  for (const std::string& part : components_of(relative)) {
    if (part == "..") {
      path /= part;
      continue;
    }
    auto next = find_in_folder(path, part);
    if (!next) return std::nullopt;
    path = std::move(*next);
  }
  return path;
}

std::optional<int> folder_rank(std::string_view path) {
  const std::vector<std::string> parts = components_of(path);
  if (parts.size() < 3 || lower(parts[0]) != kScriptFolder) return std::nullopt;
  const auto folder = std::find(kFolders.begin(), kFolders.end(), lower(parts[1]));
  if (folder == kFolders.end()) return std::nullopt;
  return static_cast<int>(folder - kFolders.begin());
}

bool is_script(std::string_view path) { return extension_rank(fs::path(path)) < kExtensions.size(); }

Listing list_folder(const fs::path& folder) {
  Listing listing;
  listing.root = folder;
  const auto scripts = find_file(folder, kScriptFolder);
  std::error_code error;
  if (scripts && fs::is_directory(*scripts, error)) add_script_folders(*scripts, scripts->filename(), listing);
  else add_script_folders(folder, {}, listing);
  if (listing.entries.empty())
    for (const fs::path& file : scripts_in(folder)) listing.entries.push_back({file.filename().string(), {}});
  return listing;
}

}  // namespace pmac::compiler::project
