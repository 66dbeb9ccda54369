// What a session keeps between calls; private to this folder.
#pragma once

#include "compiler/compiler.h"
#include "compiler/frontend/acr1000/frontend.h"
#include "compiler/frontend/power_pmac/frontend.h"
#include "compiler/ir/ir.h"
#include "compiler/sema/sema.h"

namespace pmac::compiler {

struct Session::State {
  explicit State(Options o) : options(std::move(o)), warning_control(sources, options.warnings), frontend(sources, diagnostics, options.include_dirs), cards(sources, diagnostics) {
    diagnostics.set_filter(&warning_control);
    frontend.set_max_include_depth(options.max_include_depth);
    frontend.read_plain_moves(options.plain_move_fast_path);
    for (const auto& [name, text] : options.defines) frontend.define(name, text);
    for (const std::string& setting : options.card_settings)
      if (std::string why = cards.set(setting); !why.empty()) diagnostics.error("ACR-H01", {}, "--card " + setting + ": " + why);
  }

  /// Front end and sema: checked IR; what is wrong is in diagnostics.
  std::vector<ir::Unit> analyse(std::vector<InputFile> files, bool online);
  /// The same of ACR1000 files, which have nothing to bind.
  std::vector<ir::Unit> analyse_cards(const std::vector<InputFile>& files, bool online);
  /// nullopt when there are errors.
  std::optional<bytecode::Module> generate(const std::vector<ir::Unit>& units);

  Options options;
  source::SourceManager sources;
  source::WarningControl warning_control;
  source::Diagnostics diagnostics;
  power_pmac::Frontend frontend;
  acr1000::Frontend cards;
  std::vector<bytecode::Symbol> card_symbols;
  sema::Project project;
  bool has_programs = false;   // some buffer was compiled or loaded
};

/// --emit=symbols of cards: settings, and of each card its lines, parameters and relays.
std::string card_symbols_text(const std::vector<ir::Unit>& units, const std::vector<bytecode::Symbol>& settings);

}  // namespace pmac::compiler
