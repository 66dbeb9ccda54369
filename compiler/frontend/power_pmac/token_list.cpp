#include "compiler/frontend/power_pmac/token_list.h"

#include <algorithm>
#include <cctype>

namespace pmac::compiler::power_pmac {

using T = grammar::PowerPmacParser;

TokenList::TokenList(antlr4::TokenSource& source, const TokenText& text, source::Diagnostics* diagnostics) : text_(text), diagnostics_(diagnostics) {
  for (bool last = false; !last;) {
    tokens_.push_back(source.nextToken());
    last = tokens_.back()->getType() == antlr4::Token::EOF;
  }
  dropped_.resize(tokens_.size());
  pair_parentheses();
}

void TokenList::pair_parentheses() {
  closing_.assign(tokens_.size(), kNone);
  std::vector<std::size_t> open;
  for (std::size_t i = 0; i < tokens_.size(); ++i) {
    const std::size_t type = tokens_[i]->getType();
    if (type == T::LEFT_BRACE || type == T::RIGHT_BRACE || type == T::OPEN || type == T::CLOSE) open.clear();
    if (type == T::LEFT) open.push_back(i);
    if (type != T::RIGHT || open.empty()) continue;
    closing_[open.back()] = i;
    open.pop_back();
  }
}

std::string TokenList::exact_text(std::size_t i) const { return i < tokens_.size() ? std::string(text_.text(*tokens_[i])) : std::string(); }

std::string TokenList::text(std::size_t i) const {
  std::string result = exact_text(i);
  for (char& c : result) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return result;
}

std::size_t TokenList::last_of_line(std::size_t i) const {
  while (i + 2 < tokens_.size() && line(i + 1) == line(i)) ++i;
  return i;
}

void TokenList::retype(std::size_t i, std::size_t type) { static_cast<antlr4::CommonToken*>(tokens_[i].get())->setType(type); }

void TokenList::drop(std::size_t first, std::size_t last) {
  for (std::size_t i = first; i <= last && i + 1 < tokens_.size(); ++i) {
    dropped_[i] = true;
    retype(i, T::OTHER);  // whoever looks at it later sees no word
  }
}

source::Diagnostic* TokenList::error(const char* code, source::Span span, std::string message) { return diagnostics_ ? &diagnostics_->error(code, span, std::move(message)) : nullptr; }

void TokenList::warning(const char* code, source::Span span, std::string message) {
  if (diagnostics_) diagnostics_->warning(code, span, std::move(message));
}

std::unique_ptr<antlr4::Token> TokenList::made_from(std::size_t i, std::size_t type) const {
  auto made = std::make_unique<antlr4::CommonToken>(tokens_[i].get());
  made->setType(type);
  return made;
}

TokenList::Tokens TokenList::finish() {
  Tokens out;
  out.reserve(tokens_.size() + before_.size() + behind_.size());
  for (std::size_t i = 0; i < tokens_.size(); ++i) {
    if (const auto made = before_.find(i); made != before_.end())
      for (const std::size_t type : made->second) out.push_back(made_from(i, type));
    std::vector<std::unique_ptr<antlr4::Token>> after;
    if (const auto made = behind_.find(i); made != behind_.end())
      for (const std::size_t type : made->second) after.push_back(made_from(i, type));
    if (const auto split = split_.find(i); split != split_.end()) {
      auto number = std::make_unique<antlr4::CommonToken>(tokens_[i].get());
      number->setType(T::NUMBER);
      number->setStartIndex(tokens_[i]->getStartIndex() + split->second);
      after.push_back(std::move(number));
    }
    if (!dropped_[i]) out.push_back(std::move(tokens_[i]));
    std::move(after.begin(), after.end(), std::back_inserter(out));
  }
  tokens_.clear();
  return out;
}

std::size_t literal_type(std::string_view text) {
  static const T parser(nullptr);
  const auto& vocabulary = const_cast<T&>(parser).getVocabulary();
  for (std::size_t type = 1; type < T::SEMICOLON; ++type)
    if (vocabulary.getLiteralName(type) == "'" + std::string(text) + "'") return type;
  return antlr4::Token::INVALID_TYPE;
}

}  // namespace pmac::compiler::power_pmac
