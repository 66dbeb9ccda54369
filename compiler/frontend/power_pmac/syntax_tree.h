// From expanded text to the parse tree: lexer, limits, parser with recovery by statement.
// Private to this folder: shows the parser generator's types.
#pragma once

#include <PowerPmacParser.h>

#include <memory>
#include <string>
#include <vector>

#include "compiler/frontend/power_pmac/preprocessor.h"
#include "compiler/frontend/power_pmac/word_lexer.h"
#include "compiler/source/source.h"

namespace pmac::compiler::power_pmac {

/// A parse tree with everything it refers to.
struct SyntaxTree {
  ExpandedText expanded;
  std::unique_ptr<antlr4::ANTLRInputStream> input;
  std::unique_ptr<WordLexer> lexer;
  std::unique_ptr<antlr4::TokenSource> repaired;  // the lexer's tokens with those of Turbo PMAC replaced
  std::unique_ptr<antlr4::TokenSource> source;    // these after the token pass
  std::unique_ptr<antlr4::CommonTokenStream> tokens;
  std::unique_ptr<grammar::PowerPmacParser> parser;
  grammar::PowerPmacParser::FileContext* root = nullptr;  // null where a limit stopped the parse

  source::Span span_of(const antlr4::Token& token) const;
  source::Span span_of(const antlr4::ParserRuleContext& rule) const;
  std::string_view text_of(const antlr4::Token& token) const;
};

/// All tokens of the lexer, with what lines mean told by tokens: see token_pass.cpp.
std::unique_ptr<antlr4::TokenSource> run_token_pass(antlr4::TokenSource& lexer);

/// Lexes without parsing, for --emit=tokens.
std::unique_ptr<SyntaxTree> lex(ExpandedText expanded, DeclaredNames& names, source::Diagnostics* diagnostics = nullptr);

/// Reports every syntax error to diagnostics; the tree then has gaps (rules with an exception).
std::unique_ptr<SyntaxTree> parse(ExpandedText expanded, DeclaredNames& names, source::Diagnostics& diagnostics);

/// Parses with full-context prediction; every ambiguity is one text "line: rule: tokens".
std::vector<std::string> find_ambiguities(ExpandedText expanded, DeclaredNames& names, source::Diagnostics& diagnostics);

/// Finds nesting that would be too deep for the parser's stack. False: reported, do not parse.
bool within_limits(SyntaxTree& tree, source::Diagnostics& diagnostics);

/// Reports syntax errors and skips to the next statement.
std::shared_ptr<antlr4::ANTLRErrorStrategy> make_recovery(const SyntaxTree& tree, const DeclaredNames& names, source::Diagnostics& diagnostics);

}  // namespace pmac::compiler::power_pmac
