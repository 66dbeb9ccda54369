// What a session keeps between calls; private to this folder.
#pragma once

#include "compiler/compiler.h"
#include "compiler/frontend/power_pmac/frontend.h"
#include "compiler/ir/ir.h"
#include "compiler/sema/sema.h"

namespace pmac::compiler {

struct Session::State {
  explicit State(Options o) : options(std::move(o)), warning_control(sources, options.warnings), frontend(sources, diagnostics, options.include_dirs) {
    diagnostics.set_filter(&warning_control);
    frontend.set_max_include_depth(options.max_include_depth);
    frontend.read_plain_moves(options.plain_move_fast_path);
    for (const auto& [name, text] : options.defines) frontend.define(name, text);
  }

  /// Front end and sema: checked IR; what is wrong is in diagnostics.
  std::vector<ir::Unit> analyse(std::vector<InputFile> files, bool online);
  /// nullopt when there are errors.
  std::optional<bytecode::Module> generate(const std::vector<ir::Unit>& units);

  Options options;
  source::SourceManager sources;
  source::WarningControl warning_control;
  source::Diagnostics diagnostics;
  power_pmac::Frontend frontend;
  sema::Project project;
  bool has_programs = false;   // some buffer was compiled or loaded
};

}  // namespace pmac::compiler
