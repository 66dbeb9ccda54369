// The tokens of a text with changes noted beside them, done all at once at the end.
// Private to this folder: shows the parser generator's types.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "compiler/frontend/power_pmac/turbo_pass.h"

namespace pmac::compiler::power_pmac {

class TokenList {
 public:
  using Tokens = std::vector<std::unique_ptr<antlr4::Token>>;

  TokenList(antlr4::TokenSource& source, const TokenText& text, source::Diagnostics* diagnostics);

  std::size_t size() const { return tokens_.size(); }
  std::size_t type(std::size_t i) const { return i < tokens_.size() ? tokens_[i]->getType() : antlr4::Token::EOF; }
  std::size_t line(std::size_t i) const { return i < tokens_.size() ? tokens_[i]->getLine() : 0; }
  /// Text in lower case, and as written. Empty behind the end.
  std::string text(std::size_t i) const;
  std::string exact_text(std::size_t i) const;
  source::Span span(std::size_t i) const { return text_.span(*tokens_[std::min(i, tokens_.size() - 1)]); }
  bool starts_line(std::size_t i) const { return i == 0 || line(i) != line(i - 1); }
  std::size_t last_of_line(std::size_t i) const;
  /// The parenthesis that closes the one at i, or kNone where a block or the buffer ends before. As the text was before any change.
  std::size_t closing_parenthesis(std::size_t i) const { return closing_[i]; }

  void retype(std::size_t i, std::size_t type);
  void drop(std::size_t first, std::size_t last);
  void insert_before(std::size_t i, std::size_t type) { before_[i].push_back(type); }
  void insert_behind(std::size_t i, std::size_t type) { behind_[i].push_back(type); }
  /// The word at i ends after `letters` characters; the rest is a number of its own.
  void split_number(std::size_t i, std::size_t letters) { split_[i] = letters; }

  /// Null where nothing is to be reported.
  source::Diagnostic* error(const char* code, source::Span span, std::string message);
  void warning(const char* code, source::Span span, std::string message);

  /// The tokens with all changes made; the list is empty afterwards.
  Tokens finish();

  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);

 private:
  void pair_parentheses();
  std::unique_ptr<antlr4::Token> made_from(std::size_t i, std::size_t type) const;

  const TokenText& text_;
  source::Diagnostics* diagnostics_;
  Tokens tokens_;
  std::vector<std::size_t> closing_;  // by token
  std::vector<bool> dropped_;
  std::map<std::size_t, std::vector<std::size_t>> before_, behind_;
  std::map<std::size_t, std::size_t> split_;
};

/// Type of a token that the grammar writes as a text: "&&".
std::size_t literal_type(std::string_view text);

}  // namespace pmac::compiler::power_pmac
