// The ACR1000 front end: files in, one unit of IR a card out. The lines of a card's own language stand in the files beside lines for
// the host: SYSTEM, AXIS, HEX and ; comments; docs/acr1000_language.md has them.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/frontend/acr1000/settings.h"
#include "compiler/ir/ir.h"
#include "compiler/source/source.h"

namespace pmac::compiler::acr1000 {

inline constexpr std::size_t kMaxCards = 16;

/// A file as the command line names it.
struct File { std::string name, text; };

/// All cards of a command line.
struct System {
  std::vector<ir::Unit> units;       // one a card, in the order of their first lines
  std::vector<bytecode::Symbol> symbols;
};

class Frontend {
 public:
  Frontend(source::SourceManager& sources, source::Diagnostics& diagnostics) : sources_(sources), diagnostics_(diagnostics) {}

  /// Takes KEY=VALUE of the command line, which no file changes. Returns what is wrong, or empty.
  std::string set(std::string_view setting) { return settings_.set(setting, true); }

  System read(const std::vector<File>& files);
  /// What is typed at a card that keeps its program itself.
  ir::Unit read_line(const File& line);
  /// The numbered lines of a text with the numbers 10, 20, ...; nothing where that is not possible.
  std::vector<std::string> renumbered(const File& program);

  std::string tokens(const File& file);
  std::string tree(const File& file);

 private:
  source::SourceManager& sources_;
  source::Diagnostics& diagnostics_;
  Settings settings_;
};

}  // namespace pmac::compiler::acr1000
