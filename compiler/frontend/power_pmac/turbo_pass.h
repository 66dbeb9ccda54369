// Programs in the language of Turbo PMAC, the controller before. What Power PMAC refuses is reported with its own spelling and, where
// that is certain, a repair; then the tokens are made what they stand for, so that everything else in the file is still checked.
// Private to this folder: shows the parser generator's types.
#pragma once

#include <functional>
#include <memory>
#include <string_view>

#include "compiler/frontend/power_pmac/word_lexer.h"
#include "compiler/source/source.h"

namespace pmac::compiler::power_pmac {

/// What the pass must know of the text that the tokens come from.
struct TokenText {
  std::function<std::string_view(const antlr4::Token&)> text;
  std::function<source::Span(const antlr4::Token&)> span;
};

/// All tokens of the lexer, with those of Turbo PMAC replaced by those of Power PMAC. names: declared ones are what they are.
/// diagnostics: null to report nothing.
std::unique_ptr<antlr4::TokenSource> repair_turbo(antlr4::TokenSource& lexer, const TokenText& text, const DeclaredNames& names, source::Diagnostics* diagnostics);

}  // namespace pmac::compiler::power_pmac
