#include "compiler/project/project.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "compiler/project/listing.h"

namespace pmac::compiler::project {
namespace {

namespace fs = std::filesystem;

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

bool is_ppproj(const fs::path& path) { return lower(path.extension().string()) == ".ppproj"; }
bool is_project_ini(const fs::path& path) { return lower(path.filename().string()) == "pp_proj.ini"; }

std::vector<fs::path> ppprojs_in(const fs::path& folder) {
  std::vector<fs::path> found;
  std::error_code error;
  for (auto entry = fs::directory_iterator(folder, error); !error && entry != fs::directory_iterator(); entry.increment(error))
    if (is_ppproj(entry->path())) found.push_back(entry->path());
  if (error) throw Unreadable(fmt::format("cannot read the folder {}: {}", folder.string(), error.message()));
  return found;
}

/// The project file of a folder where there is one, else the folder itself.
fs::path project_file_of(const fs::path& folder) {
  const std::vector<fs::path> found = ppprojs_in(folder);
  if (found.size() > 1) throw Unreadable(fmt::format("{} holds {} .ppproj files; name one of them", folder.string(), found.size()));
  if (found.size() == 1) return found.front();
  for (const char* place : {"Configuration/pp_proj.ini", "pp_proj.ini"})
    if (auto ini = find_file(folder, place)) return *ini;
  return folder;
}

Listing list(const fs::path& path, source::SourceManager& sources, source::Diagnostics& diagnostics) {
  std::error_code error;
  const fs::path file = fs::is_directory(path, error) ? project_file_of(path) : path;
  if (fs::is_directory(file, error)) return list_folder(file);
  return is_ppproj(file) ? read_ppproj(file, sources, diagnostics) : read_project_ini(file, sources, diagnostics);
}

/// The texts that the controller loads around the project's own files.
void add_where_it_exists(const fs::path& root, const char* name, std::vector<InputFile>& files) {
  const auto path = find_file(root, name);
  if (!path) return;
  if (auto text = read_bytes(*path, kMaxSourceBytes)) files.push_back({path->lexically_normal().string(), std::move(*text)});
}

void add_entry(const Listing& listing, const Entry& entry, std::vector<InputFile>& files, source::Diagnostics& diagnostics) {
  const auto path = find_file(listing.root, entry.path);
  auto text = path ? read_bytes(*path, kMaxSourceBytes) : std::nullopt;
  if (text) return files.push_back({path->lexically_normal().string(), std::move(*text)});
  const std::string reason = path ? fmt::format("cannot be read, or is larger than {} bytes", kMaxSourceBytes) : "does not exist";
  diagnostics.error("PM6102", entry.span, fmt::format("the project's file \"{}\" {}", entry.path, reason));
}

}  // namespace

bool is_project(const std::string& path) {
  std::error_code error;
  return fs::is_directory(path, error) || is_ppproj(path) || is_project_ini(path);
}

Project read_project(const std::string& path, source::SourceManager& sources, source::Diagnostics& diagnostics) {
  const Listing listing = list(path, sources, diagnostics);
  if (listing.entries.empty() && !diagnostics.has_errors()) throw Unreadable(fmt::format("{} names no script file (.pmh .kin .pmc .plc)", path));
  Project project;
  project.starts = listing.starts;
  add_where_it_exists(listing.root, "Configuration/pp_disable.txt", project.files);
  for (const Entry& entry : listing.entries) add_entry(listing, entry, project.files, diagnostics);
  add_where_it_exists(listing.root, "Configuration/pp_startup.txt", project.files);
  return project;
}

}  // namespace pmac::compiler::project
