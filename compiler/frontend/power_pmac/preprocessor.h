// The preprocessor of Power PMAC projects: comments, #define and #undef (also function-like), #if #ifdef #ifndef #elif #else
// #endif, #include. It works like that of C, by whole identifiers and case-sensitively, and keeps for every byte of its output
// the place it came from. Only '#' followed by the name of a directive begins a directive: #1j+ and #*k are motor commands.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "compiler/frontend/power_pmac/macro_definition.h"
#include "compiler/frontend/power_pmac/macros.h"
#include "compiler/frontend/power_pmac/source_line.h"
#include "compiler/ir/ir.h"
#include "compiler/source/closing_marks.h"
#include "compiler/source/source.h"

namespace pmac::compiler::power_pmac {

/// Text without comments and macros. Line ends are kept, so that statements still end with their line.
class ExpandedText {
 public:
  /// Appends text. exact: its bytes are the bytes from span.begin on; otherwise every byte belongs to the whole span.
  void append(std::string_view text, const source::Span& span, bool exact);
  /// Appends the mark of plain move lines, and a line end; span is that of the lines.
  void append_plain_moves(ir::MoveRows moves, const source::Span& span);
  /// The same for other lines that were read in front of the grammar (plain_lines.h).
  void append_plain_lines(ir::Body statements, const source::Span& span);
  const std::string& text() const { return text_; }
  bool has_plain_moves() const { return !moves_.empty(); }
  bool has_plain_lines() const { return !lines_.empty(); }
  /// The moves whose mark stands at the offset, or null.
  const ir::MoveRows* plain_moves_at(std::size_t offset) const;
  /// The statements whose mark stands at the offset, to be taken out, or null.
  ir::Body* plain_lines_at(std::size_t offset) const;
  /// The same text with the lines in place of the marks, as without the fast path.
  ExpandedText with_moves_written_out(const source::SourceManager& sources) const;
  /// The text alone, for a look ahead.
  ExpandedText text_only() const;
  /// Place of bytes [begin, end) of the text.
  source::Span span_of(std::size_t begin, std::size_t end) const;

 private:
  struct Segment { std::size_t begin; source::Span span; bool exact; };
  source::Span span_at(std::size_t offset) const;
  std::string text_;
  std::vector<Segment> segments_;
  std::map<std::size_t, ir::MoveRows> moves_;  // by the offset of their mark
  std::map<std::size_t, std::unique_ptr<ir::Body>> lines_;
};

class Preprocessor {
 public:
  Preprocessor(source::SourceManager& sources, source::Diagnostics& diagnostics, std::vector<std::string> include_dirs);

  /// Expands a file that the source manager knows. Macros stay known for the next file.
  ExpandedText run(std::int32_t file);
  void set_max_include_depth(int depth) { max_include_depth_ = depth; }
  /// From now on long runs of plain move lines are read here (plain_moves.h), and of other plain lines (plain_lines.h), unless lines are recorded.
  void read_plain_text(bool moves, bool lines) { moves_wanted_ = moves, lines_wanted_ = lines; }
  /// As -D name=text.
  void define(const std::string& name, const std::string& text);
  /// Every #define of the files so far.
  const std::vector<MacroDefinition>& definitions() const { return definitions_; }
  /// From now on every line that counts is kept, for pmacc -E.
  void record_lines() { recording_ = true; }
  const std::vector<SourceLine>& recorded() const { return recorded_; }

 private:
  using Tokens = PreprocessorTokens;
  struct Conditional { bool active; bool taken; bool parent_active; bool seen_else; source::Span span; };

  void run_file(std::int32_t file);
  void follow_program(const Tokens& line);
  void take_plain_text(std::int32_t file, std::size_t& cursor);
  bool take_plain_moves(std::int32_t file, std::size_t& cursor);
  bool take_plain_lines(std::int32_t file, std::size_t& cursor);
  Tokens next_line(std::int32_t file, std::size_t& cursor);
  bool begins_turbo_comment(std::string_view text, std::size_t at) const;
  void report_turbo_comment(std::int32_t file, std::size_t at);
  void check_swallowed_program(std::string_view comment, const source::Span& span);
  bool take_directive(const Tokens& line);
  void run_directive(std::string_view name, const Tokens& line, std::size_t first);
  void define_directive(const Tokens& line, std::size_t at, const source::Span& directive);
  void undef_directive(const Tokens& line, std::size_t at, const source::Span& directive);
  void line_directive(const Tokens& line, std::size_t at, const source::Span& directive);
  std::optional<Macro> read_definition(const Tokens& line, std::size_t at, const source::Span& directive);
  bool parse_parameters(const Tokens& line, std::size_t& at, Macro& macro);
  void list_definition(const Macro& macro, bool active);
  void include_directive(const Tokens& line, std::size_t at, const source::Span& directive);
  void include_file(const std::string& name, const source::Span& place);
  void conditional_directive(std::string_view name, const Tokens& line, std::size_t at, const source::Span& directive);
  bool evaluate_condition(const Tokens& line, std::size_t at, const source::Span& directive);
  void emit_line(Tokens line, std::int32_t file, std::size_t& cursor);
  void record(SourceLine::Kind kind, const Tokens& tokens, std::int32_t file);
  bool is_active() const { return conditionals_.empty() || conditionals_.back().active; }
  std::optional<std::int32_t> open_include(const std::string& name, const source::Span& from);

  source::SourceManager& sources_;
  source::Diagnostics& diagnostics_;
  std::vector<std::string> include_dirs_;
  MacroTable macros_;
  std::vector<MacroDefinition> definitions_;
  std::vector<Conditional> conditionals_;
  std::vector<SourceLine> recorded_;
  bool recording_ = false;
  bool moves_wanted_ = false;      // the fast paths are on
  bool lines_wanted_ = false;
  bool in_program_ = false;        // inside open prog or open subprog ... close, by what begins the lines
  std::size_t plain_tried_ = 0;    // plain lines up to here are too few
  ExpandedText* out_ = nullptr;
  source::ClosingMarks marks_{{}};  // of the file at hand
  bool turbo_file_ = false;   // the file at hand has the comments of Turbo PMAC
  int include_depth_ = 0;
  int max_include_depth_ = 64;
  std::size_t include_count_ = 0;
  bool includes_stopped_ = false;  // a limit was reached and reported
};

}  // namespace pmac::compiler::power_pmac
