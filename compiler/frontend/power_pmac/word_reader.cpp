#include "compiler/frontend/power_pmac/word_reader.h"

#include <algorithm>
#include <cctype>

#include "compiler/frontend/power_pmac/word_lexer.h"

namespace pmac::compiler::power_pmac {
namespace {

using T = grammar::PowerPmacParser;

constexpr std::string_view kOpensBuffer = "open prog 0\n";  // put before a text that stands inside a buffer

bool is_letter_type(std::size_t type) {
  switch (type) {
    case T::AXIS: case T::VECTOR: case T::RADIUS: case T::NORMAL_VECTOR: case T::PSET_AXIS: case T::CODE: case T::VAR: case T::LETTER: case T::LETTER_C:
    case T::LETTER_D: case T::LETTER_F: case T::LETTER_I: case T::LETTER_M: case T::LETTER_N: case T::LETTER_R: return true;
    default: return false;
  }
}

WordKind kind_of(std::size_t type, char first) {
  if (is_letter_type(type)) return WordKind::kLetter;
  switch (type) {
    case T::NAME: return WordKind::kName;
    case T::MEMBER: return WordKind::kMember;
    case T::NUMBER: return WordKind::kNumber;
    case T::STRING: return WordKind::kString;
    case T::IO_POINTER: return WordKind::kPointer;
    default: return std::isalpha(static_cast<unsigned char>(first)) ? WordKind::kKeyword : WordKind::kSign;
  }
}

}  // namespace

struct WordReader::State {
  State(std::string_view source, const Names& known, bool in_buffer)
      : lead(in_buffer ? kOpensBuffer.size() : 0),
        text(std::string(kOpensBuffer.substr(0, lead)).append(source)),
        input(lexer_input(text)),
        lexer(&input, text, names) {
    names.global = known;
  }

  void note_declared(std::string_view word) {
    if (names.local.contains(word) || names.global.contains(word)) declared.emplace(word);
  }

  std::size_t lead;
  std::string text;
  antlr4::ANTLRInputStream input;
  DeclaredNames names;
  WordLexer lexer;
  Names declared;
};

WordReader::WordReader(std::string_view text, const Names& names, bool in_buffer) : state_(std::make_unique<State>(text, names, in_buffer)) {}
WordReader::~WordReader() = default;
WordReader::WordReader(WordReader&&) noexcept = default;
const WordReader::Names& WordReader::declared() const { return state_->declared; }
const WordReader::Names& WordReader::shared() const { return state_->names.global; }

bool WordReader::next(Word& word) {
  std::unique_ptr<antlr4::Token> token = state_->lexer.nextToken();
  while (token->getType() != antlr4::Token::EOF && token->getStopIndex() < state_->lead) token = state_->lexer.nextToken();
  if (token->getType() == antlr4::Token::EOF) return false;
  const std::size_t begin = token->getStartIndex();
  const std::size_t end = token->getStopIndex() + 1;
  word.begin = static_cast<std::uint32_t>(begin - state_->lead);
  word.end = static_cast<std::uint32_t>(end - state_->lead);
  word.type = static_cast<std::uint16_t>(token->getType());
  word.kind = kind_of(token->getType(), state_->text[begin]);
  if (word.kind == WordKind::kName) state_->note_declared(std::string_view(state_->text).substr(begin, end - begin));
  return true;
}

}  // namespace pmac::compiler::power_pmac
