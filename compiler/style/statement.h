// Follows a program word by word, as far as blanks and line ends depend on it: buffer or load stream, parentheses, assignment or
// other statement, and whether a sign stands between two operands.
#pragma once

#include <string_view>

#include "compiler/style/source_text.h"

namespace pmac::style {

/// What a word is to its neighbours.
enum class Role : std::uint8_t {
  kNone,         // no word yet
  kOperand,      // a name, a number, a text: an expression may be complete behind it
  kKeyword,
  kLetter,       // waits for its number
  kOpen, kOpenBracket, kClose, kOpenBrace, kCloseBrace, kComma, kSemicolon,
  kLabelColon,   // behind a label, case, default, sub
  kArrow,
  kAssign,
  kStep,         // ++ and --
  kBinary, kUnary,
  kLetterSign,   // of X-10
  kAsWritten     // a sign whose blanks stay as they are
};

class Statement {
 public:
  explicit Statement(const SourceText& source) : source_(&source), in_buffer_(source.in_buffer) {}

  /// Role of the next word. blank_before, glued_behind: how it stands in the text.
  Role role_of(const Piece& word, bool blank_before, bool glued_behind) const;
  void take(const Piece& word, Role role);
  void end_line();

  bool in_buffer() const { return in_buffer_; }
  int depth() const { return depth_; }
  /// The line end at hand is white space: an operand or a parenthesis is still missing.
  bool continues() const { return depth_ > 0 || wants_operand(); }
  Role last_role() const { return last_role_; }
  /// The last word, where there is one on this line or the statement continues.
  const Piece* last() const { return last_role_ == Role::kNone ? nullptr : &last_; }
  /// The last keyword in lower case, where it is the last word.
  std::string_view last_keyword() const { return last_keyword_; }
  bool is_expression() const { return depth_ > 0 || form_ == Form::kExpression || form_ == Form::kCase; }

 private:
  enum class Form : std::uint8_t { kOther, kExpression, kCase, kJog, kDeclaration };

  bool last_is_operand() const { return last_role_ == Role::kOperand || last_role_ == Role::kClose || last_role_ == Role::kStep; }
  bool wants_operand() const { return last_role_ == Role::kBinary || last_role_ == Role::kUnary || last_role_ == Role::kAssign || last_role_ == Role::kComma; }
  bool colon_ends_label() const;
  Role role_of_sign(std::string_view text, bool blank_before, bool glued_behind) const;
  Role role_of_operator(std::string_view text, bool blank_before, bool glued_behind) const;
  void take_keyword(std::string_view word);
  void reset();

  const SourceText* source_;
  bool in_buffer_;
  Form form_ = Form::kOther;
  int depth_ = 0;
  Role last_role_ = Role::kNone;
  Piece last_, before_last_;
  std::string_view last_keyword_;
};

}  // namespace pmac::style
