// Macros and their expansion, by the rules of C: arguments are expanded before they are put in place, # makes a text of an argument,
// ## joins two tokens, the result is read again together with what follows it, and a macro does not expand inside itself.
// Method: a stack of token lists, as GNU cpp has it. A macro is locked while its list is on the stack.
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/source/source.h"

namespace pmac::compiler::power_pmac {

/// A piece of a line: an identifier, a number, a string, blanks or one other character.
struct PreprocessorToken {
  enum class Kind : std::uint8_t { kIdentifier, kNumber, kString, kBlank, kNewline, kOther };
  Kind kind;
  std::string_view text;
  source::Span span;
  bool locked = false;  // the name of a macro that was met inside itself: never expanded again
};
using PreprocessorTokens = std::vector<PreprocessorToken>;

struct Macro {
  std::string name;
  bool function_like = false;
  bool variadic = false;                  // the last parameter is __VA_ARGS__
  std::vector<std::string> parameters;
  PreprocessorTokens body;
  source::Span name_span;
  std::string body_text;
  mutable int open = 0;                   // its lists on the stack
  mutable std::vector<std::int32_t> expansions;  // of its body's tokens where it is used in a file directly
};

/// Tokens of a text; comments must have been blanked before. span: place of the text.
PreprocessorTokens split_tokens(std::string_view text, const source::Span& span);

/// Index of the first token from `at` on that is no blank.
std::size_t skip_blanks(const PreprocessorTokens& line, std::size_t at);

/// Value of a #if expression over tokens without macros (unknown identifiers are 0); the reason where it has none.
struct IfValue { long long value = 0; std::string problem; };
IfValue evaluate_if(const PreprocessorTokens& tokens);

class MacroTable {
 public:
  MacroTable(source::SourceManager& sources, source::Diagnostics& diagnostics) : sources_(sources), diagnostics_(diagnostics) {}

  /// A known name with another text is replaced, with a warning.
  void define(Macro macro);
  void undefine(std::string_view name);
  /// Also the built-in ones, __LINE__ and __FILE__.
  bool is_defined(std::string_view name) const;
  /// A macro has a name that plain move lines could use: X10.
  bool may_change_moves() const { return move_like_names_; }
  /// The same of other plain lines: G1, N5.
  bool may_change_lines() const { return line_like_names_; }

  /// Expands the tokens of a line, or of several where the arguments of a call go on.
  PreprocessorTokens expand(const PreprocessorTokens& line);
  /// The arguments of a macro call are not closed in this line.
  bool needs_next_line(const PreprocessorTokens& line) const;

 private:
  using Token = PreprocessorToken;
  using Tokens = PreprocessorTokens;
  struct List { Tokens tokens; std::size_t at = 0; const Macro* macro = nullptr; };
  struct Call { std::vector<Tokens> arguments; source::Span use; };

  const Macro* find(std::string_view name) const;
  const Macro* called_by(std::string_view name) const;
  void expand_list(Tokens tokens, Tokens& out);
  bool expand_name(const Token& name, const Macro& macro, std::size_t base, Tokens& out);
  bool parenthesis_follows(std::size_t base) const;
  std::optional<Token> take(std::size_t base);
  std::optional<Call> read_call(const Token& name, const Macro& macro, std::size_t base, Tokens& out);
  void separate_variadic(const Macro& macro, std::vector<Tokens>& arguments) const;
  Tokens substitute(const Macro& macro, const Call& call);
  const Tokens* argument_of(const Macro& macro, const Token& token, const std::vector<Tokens>& arguments) const;
  void append_body_token(const Macro& macro, std::size_t at, const Call& call, Tokens& result);
  void paste(const Tokens& right, Tokens& result, const source::Span& use);
  Token text_of(const Tokens& argument, const source::Span& span);
  Token built_in(const Token& name);
  std::string_view keep(std::string text);
  void too_much(const Token& token, std::string_view name);

  source::SourceManager& sources_;
  source::Diagnostics& diagnostics_;
  std::map<std::string, Macro, std::less<>> macros_;
  std::vector<List> lists_;
  std::deque<std::string> texts_;   // of tokens that # and ## made
  bool move_like_names_ = false;    // some macro was defined with such a name
  bool line_like_names_ = false;
  int argument_depth_ = 0;          // calls inside the arguments of calls, at the moment
  std::size_t produced_ = 0;        // tokens made for the current line: stops explosive macros
};

}  // namespace pmac::compiler::power_pmac
