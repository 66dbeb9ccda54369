// What a project file says, before any script file is opened; private to this folder.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/project/project.h"

namespace pmac::compiler::project {

inline constexpr std::size_t kMaxProjectBytes = 16u << 20;   // of a project file
inline constexpr std::size_t kMaxSourceBytes = 256u << 20;   // of one script file
inline constexpr std::size_t kMaxFiles = 10000;

/// A script file that a project names. path: relative to the folder of the project, with slashes.
struct Entry { std::string path; source::Span span; };

struct Listing {
  std::filesystem::path root;     // folder of the project
  std::vector<Entry> entries;     // in load order
  VariableStarts starts;
};

/// Reads a whole file; nullopt when it cannot be read or is longer than the limit.
std::optional<std::string> read_bytes(const std::filesystem::path& path, std::size_t limit);

/// Finds root/relative; names that differ in case only are found too, as on the IDE's file system. nullopt: no such file.
std::optional<std::filesystem::path> find_file(const std::filesystem::path& root, std::string_view relative);

/// Place of a script folder in the load order, or nullopt for any other folder. path: relative to the project.
std::optional<int> folder_rank(std::string_view path);
/// .pmh .pmc .plc .kin, in either case.
bool is_script(std::string_view path);

Listing read_ppproj(const std::filesystem::path& file, source::SourceManager& sources, source::Diagnostics& diagnostics);
Listing read_project_ini(const std::filesystem::path& file, source::SourceManager& sources, source::Diagnostics& diagnostics);
/// A folder without project file: its script folders, or else the script files in it, by kind and name.
Listing list_folder(const std::filesystem::path& folder);

}  // namespace pmac::compiler::project
