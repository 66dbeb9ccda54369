// From the words of a line to its parse tree. Private to this folder: shows the parser generator's types.
#pragma once

#include <Acr1000Parser.h>

#include <memory>
#include <string>
#include <vector>

#include "compiler/frontend/acr1000/tokens.h"

namespace pmac::compiler::acr1000 {

/// A line with everything that its tree refers to.
struct ParsedLine {
  std::vector<Token> tokens;
  std::unique_ptr<antlr4::ListTokenSource> source;
  std::unique_ptr<antlr4::CommonTokenStream> stream;
  std::unique_ptr<grammar::Acr1000Parser> parser;
  grammar::Acr1000Parser::LineContext* root = nullptr;  // null where the line is wrong

  const Token& token(const antlr4::Token& made) const { return tokens[made.getTokenIndex()]; }
  const Token& token(antlr4::tree::TerminalNode* leaf) const { return token(*leaf->getSymbol()); }
  source::Span span_of(const antlr4::ParserRuleContext& rule) const;
};

/// Reads one line; what is wrong is reported, and root is null then.
std::unique_ptr<ParsedLine> parse_line(const source::SourceManager& sources, const source::Span& line, source::Diagnostics& diagnostics);

/// The rules and words of a line, one a text line, indented.
std::string print_tree(const ParsedLine& line);

}  // namespace pmac::compiler::acr1000
