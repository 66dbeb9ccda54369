// How deep a line stands: braces, and the statements that if, else, while, do and switch carry with or without braces.
#pragma once

#include <vector>

#include "compiler/style/statement.h"

namespace pmac::style {

class Structure {
 public:
  /// problems: collects what cannot be followed. A copy of the object goes on from the same state into the same list.
  Structure(const SourceText& source, const Options& options, std::vector<Problem>& problems)
      : source_(&source), problems_(&problems), indent_buffers_(options.indent_buffers) {}

  /// Levels of a line that begins with this word. Not for lines that continue a statement.
  int level_of_line(const Piece& first) const;
  /// Levels of a plain statement on the next line.
  int level_inside() const { return level_above(settled_size()); }

  /// statement: before it has taken the word. line_level: of the line that the word stands on.
  void take(const Piece& word, Role role, const Statement& statement, int line_level);
  /// A line ended that no next line continues.
  void end_line();
  void end_text();

 private:
  enum class Kind : std::uint8_t { kBrace, kIf, kElse, kWhile, kDo, kSwitch };
  enum class Stage : std::uint8_t { kHeader, kBody, kDone, kAwaitsWhile };
  struct Frame { Kind kind; Stage stage; bool is_switch; bool in_case; int level; Piece word; };

  bool is_done(const Frame& frame) const { return frame.kind != Kind::kBrace && (frame.stage == Stage::kDone || frame.stage == Stage::kAwaitsWhile); }
  std::size_t settled_size() const;
  int level_above(std::size_t size) const;
  bool is_label(const Piece& first) const;
  int level_of_keyword(std::string_view keyword) const;
  int level_of_closing_brace() const;
  const Frame* waiting_do() const;
  void take_keyword(const Piece& word, std::string_view keyword, int line_level);
  void take_control(const Piece& word, Kind kind, int line_level);
  void take_else(const Piece& word, int line_level);
  bool take_while_of_do();
  void take_case();
  void take_close(const Piece& word);
  void open_brace(const Piece& word, int line_level);
  void close_brace(const Piece& word);
  void take_plain();
  void end_header();
  void complete_statement();
  void settle();
  void push(Frame frame);
  void check_parentheses(const Piece& word, Role role);
  void report(const Piece& piece, std::string code, std::string message);
  Frame* top() { return frames_.empty() ? nullptr : &frames_.back(); }

  const SourceText* source_;
  std::vector<Problem>* problems_;
  bool indent_buffers_;
  bool in_open_ = false;         // between open and close
  bool in_statement_ = false;    // a plain statement has begun
  std::vector<Frame> frames_;
  std::vector<Piece> parentheses_;
};

}  // namespace pmac::style
