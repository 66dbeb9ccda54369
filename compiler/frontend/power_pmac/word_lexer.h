// The tokens of Power PMAC script: the generated lexer finds where words begin, this class decides what they are. A declared
// name comes first, then keywords, then letters with the number glued to them (X1.5Y4, ta500ts0, x60y0): of such a word it
// hands out the first run of letters and lets the lexer read on right behind it.
// Private to this folder, like every header that shows the parser generator's types.
#pragma once

#include <PowerPmacLexer.h>
#include <PowerPmacParser.h>

#include <memory>
#include <set>
#include <string>
#include <string_view>

namespace pmac::compiler::power_pmac {

/// Names that are one word wherever they stand.
struct DeclaredNames {
  std::set<std::string, std::less<>> global;
  std::set<std::string, std::less<>> local;  // of the open buffer
  std::set<std::string, std::less<>> programs;  // of open prog: known behind b, begin and start glued to them
  bool may_change_moves = false;    // one of them is a name that plain move lines could use: X10
  bool may_change_lines = false;    // or other plain lines: G1
  void add_global(std::string_view name);
  void add_local(std::string_view name);
  void note(std::string_view name);
  bool contains(std::string_view name) const { return global.contains(name) || local.contains(name); }
};

/// Longest word; a longer one is not cut into its parts, which costs time with the square of its length, and is refused.
inline constexpr std::size_t kMaxWord = 1000;

/// A text as the parser generator's input. It reads UTF-8; one byte must stay one position, so other bytes than ASCII become question
/// marks. A quotation mark that is not closed becomes a character that no token begins with, as the mark itself would be none: the
/// generated lexer would look for the end of every one of them. Texts and comments keep theirs: they are taken from the text itself.
std::string lexer_input(std::string_view text);

class WordLexer : public grammar::PowerPmacLexer {
 public:
  /// text: what input holds. names: extended by the declarations that the lexer meets.
  WordLexer(antlr4::ANTLRInputStream* input, std::string_view text, DeclaredNames& names);

  std::unique_ptr<antlr4::Token> nextToken() override;

 private:
  struct Word { std::size_t type; std::size_t length; };

  bool begins_range(const antlr4::Token& number) const;
  void cut(antlr4::Token& token, std::size_t length);
  Word classify(std::string_view word, std::size_t begin, std::size_t line);
  bool must_be_name(std::string_view word, std::size_t end) const;
  Word split(std::string_view word, std::size_t begin) const;
  std::size_t type_of_run(std::string_view run, bool digit_follows, std::size_t begin) const;
  std::size_t online_type(std::string_view run, bool value_follows) const;
  std::size_t axis_definition_type(std::string_view run) const;
  std::size_t exponent_length(std::size_t at) const;
  bool axis_before_variable(std::string_view run) const;
  Word split_commands(std::string_view word, std::size_t begin) const;
  Word split_program_name(std::string_view word, std::size_t begin);
  void declare(std::string_view name);
  void follow(std::size_t kind, std::size_t line);
  void follow_declaration(std::size_t kind, std::size_t line);
  void follow_mode(std::size_t kind, std::size_t line);

  enum class Declaring { kNothing, kGlobal, kLocal, kParameters };

  std::string_view text_;
  DeclaredNames& names_;
  bool in_buffer_ = false;
  bool line_is_buffered_ = false;   // cx: the rest of the line is buffered statements
  std::size_t buffered_line_ = 0;
  bool axis_definition_ = false;    // behind #1->
  std::size_t axis_line_ = 0;
  Declaring declaring_ = Declaring::kNothing;
  bool expect_name_ = false;
  int depth_ = 0;                   // of parentheses inside a declaration
  std::size_t last_[3] = {0, 0, 0}; // types of the tokens before, last one first
  std::size_t last_end_ = 0;        // offset behind the token before
  std::size_t last_line_ = 0;
  std::size_t line_of_word_ = 0;    // of the word that is being classified
  std::size_t code_line_ = 0;       // line of the last code letter or call: E and O are letters behind it
  std::size_t split_end_ = 0;       // words that begin before this offset are the rest of a split word
  bool last_number_is_zero_ = false;
  std::size_t program_begin_ = 0, program_length_ = 0;  // of the name in bMain
};

/// Name of a token type as the user writes it: 'while', ')', a number, a name.
std::string describe_token(std::size_t type);
/// Name of a token type in the grammar, or empty for operators.
std::string token_name(std::size_t type);

}  // namespace pmac::compiler::power_pmac
