// Runs the tools as a user does, in a folder of its own.
#pragma once

#include <filesystem>
#include <string>

namespace pmac::test {

struct ToolResult { int code = -1; std::string out, err; };

/// A new, empty folder that goes away with the object.
class Workspace {
 public:
  Workspace();
  ~Workspace();
  Workspace(const Workspace&) = delete;
  std::filesystem::path path(const std::string& name) const { return folder_ / name; }
  void write(const std::string& name, const std::string& bytes) const;
  std::string read(const std::string& name) const;
  bool has(const std::string& name) const { return std::filesystem::exists(path(name)); }
  /// arguments as a shell reads them; the working folder is this one. `tool`: pmacc or pmac-run.
  ToolResult run(const std::string& tool, const std::string& arguments) const;
  /// A command line of bash; the tools are on its path.
  ToolResult shell(const std::string& command) const;

 private:
  std::filesystem::path folder_;
};

/// Path of a program of the course, quoted for a shell.
std::string program(const std::string& name);

}  // namespace pmac::test
