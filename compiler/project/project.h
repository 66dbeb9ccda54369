// The way into projects of the vendor's IDE: which files are loaded, in which order, and where the numbering of variables begins.
// A project is a folder, its X.ppproj (MSBuild XML), or the pp_proj.ini that the IDE wrote for the controller.
//
//   Configuration/pp_disable.txt, where it exists
//   PMAC Script Language/Global Includes, Kinematic Routines, Libraries, Motion Programs, PLC Programs: the order of the controller
//   Configuration/pp_startup.txt, where it exists
//
// Saved set-ups (pp_save.cfg, systemsetup.cfg) belong to the controller and not to the project; name them on the command line
// where they are wanted. Sources: files that the IDE wrote in public projects, and the controllers' logs of loading them.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "compiler/compiler.h"
#include "compiler/source/source.h"

namespace pmac::compiler::project {

struct Project {
  std::vector<InputFile> files;   // in load order, with their texts
  VariableStarts starts;
};

/// The path itself cannot be read, or there is no project behind it.
struct Unreadable : std::runtime_error { using std::runtime_error::runtime_error; };

/// Whether a path names a project: a folder, *.ppproj, or a file called pp_proj.ini.
bool is_project(const std::string& path);

/// Reads a project. What is wrong inside of it is reported with its line in the project file; the files that can be read are
/// returned. Throws Unreadable.
Project read_project(const std::string& path, source::SourceManager& sources, source::Diagnostics& diagnostics);

}  // namespace pmac::compiler::project
