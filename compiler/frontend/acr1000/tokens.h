// The words of one line for a card: where commands begin, their first letters decide; blanks count only in quotes.
// Private to this folder: shows the parser generator's token numbers.
#pragma once

#include <Acr1000Parser.h>

#include <string>
#include <vector>

#include "compiler/source/source.h"

namespace pmac::compiler::acr1000 {

/// A word: its text without the blanks in it, and where it stands. Of a STRING the text is what stands in the quotes.
struct Token {
  std::size_t type = 0;
  std::string text;
  source::Span span;
};

/// A row of command.def.
struct CommandSpelling { std::size_t type; std::string_view key, spelling, usage; };
const std::vector<CommandSpelling>& command_spellings();
/// How a command is written, or empty.
std::string_view usage_of(std::size_t type);

/// The words of the text at `line` (no line end in it), left to right. False where a word is wrong, which has been reported; the words
/// before it stand in tokens.
bool lex_line(const source::SourceManager& sources, const source::Span& line, std::vector<Token>& tokens, source::Diagnostics& diagnostics);

std::string token_type_name(std::size_t type);

}  // namespace pmac::compiler::acr1000
