// The Power PMAC front end: files in, IR out. Keeps macros and declared names from one file to the next.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/frontend/power_pmac/macro_definition.h"
#include "compiler/frontend/power_pmac/source_line.h"
#include "compiler/ir/ir.h"
#include "compiler/source/source.h"

namespace pmac::compiler::power_pmac {

/// Words that statements of buffers begin with, for suggestions.
const std::vector<std::string_view>& keyword_names();

class Frontend {
 public:
  Frontend(source::SourceManager& sources, source::Diagnostics& diagnostics, const std::vector<std::string>& include_dirs);
  ~Frontend();

  void define(const std::string& name, const std::string& text);
  /// A name that is one word from now on, from an object file.
  void know_name(const std::string& name);
  /// A program that can be begun by name.
  void know_program(const std::string& name);
  /// Names that declarations of all texts so far mention, right or wrong.
  std::vector<std::string> known_names() const;

  /// From now on every source line that counts is kept, for pmacc -E.
  void record_lines();
  const std::vector<SourceLine>& recorded_lines() const;
  /// Every #define so far, in order.
  const std::vector<MacroDefinition>& macro_definitions() const;

  /// Errors at #include nested deeper.
  void set_max_include_depth(int depth);
  /// Whether long runs of plain move lines are read in front of the grammar (plain_moves.h).
  void read_plain_moves(bool on);

  ir::Unit read(const std::string& name, std::string text);
  /// One token a line: line:column, kind, text.
  std::string tokens(const std::string& name, std::string text);
  /// The parse tree, one rule a line, indented.
  std::string tree(const std::string& name, std::string text);
  /// Places where the grammar can read the text in more than one way, by the parser generator's exact analysis: "line: rule: tokens".
  std::vector<std::string> ambiguities(const std::string& name, std::string text);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pmac::compiler::power_pmac
