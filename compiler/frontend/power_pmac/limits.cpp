// The parser, and every stage behind it, recurses over nested text. This pass over the tokens refuses text that is nested deeper
// than any program of people, before a stack can overflow.
#include <fmt/format.h>

#include "compiler/frontend/power_pmac/syntax_tree.h"
#include "compiler/frontend/power_pmac/word_lexer.h"

namespace pmac::compiler::power_pmac {
namespace {

using T = grammar::PowerPmacParser;

constexpr int kMaxParentheses = 200;
constexpr int kMaxBlocks = 100;
constexpr int kMaxBareNesting = 100;  // if (a) if (b) ... without braces
constexpr int kMaxElseIf = 500;
constexpr int kMaxOperators = 1000;   // of one statement
constexpr int kMaxLineTokens = 4000;  // after macro expansion; long lines cost time with the square of their length
constexpr int kMaxPrefix = 200;       // ---- in front of one operand

bool is_word(std::size_t type) { return type == T::NAME || type == T::MEMBER; }
bool is_else(std::size_t type) { return type == T::ELSE || type == T::ELSE_IF; }
bool is_control(std::size_t type) { return type == T::IF || type == T::WHILE || type == T::DO || is_else(type) || type == T::SWITCH; }

bool is_operator(std::size_t type) {
  return type == T::PLUS || type == T::MINUS || type == T::STAR || type == T::AMPERSAND || type == T::BIT_AND || type == T::SYNC_ASSIGN ||
         (type < T::SEMICOLON && type != 0);
}

/// Follows the nesting token by token.
class NestingScan {
 public:
  /// What is too deep from this token on, or null.
  const char* take(std::size_t type, bool new_line) {
    if (const char* problem = take_brackets(type, new_line)) return problem;
    return take_control(type);
  }

 private:
  const char* take_brackets(std::size_t type, bool new_line) {
    const bool ends_statement = type == T::SEMICOLON || type == T::LEFT_BRACE || type == T::RIGHT_BRACE || type == T::CLOSE || type == T::OPEN;
    if (ends_statement) parentheses_ = 0;
    if (ends_statement || (new_line && parentheses_ == 0 && !is_operator(last_))) operators_ = 0;
    if (type == T::LEFT || type == T::LEFT_BRACKET) ++parentheses_;
    if ((type == T::RIGHT || type == T::RIGHT_BRACKET) && parentheses_ > 0) --parentheses_;
    prefix_ = is_operator(type) ? prefix_ + 1 : 0;
    operators_ += is_operator(type);
    if (parentheses_ > kMaxParentheses) return "parentheses are nested too deep";
    if (operators_ > kMaxOperators || prefix_ > kMaxPrefix) return "this expression is too long; compute it in parts";
    return nullptr;
  }

  const char* take_control(std::size_t type) {
    if (type == T::LEFT_BRACE) {
      if (static_cast<int>(blocks_.size()) >= kMaxBlocks) return "blocks are nested too deep";
      blocks_.push_back({else_ifs_, bare_});
      else_ifs_ = bare_ = 0;
    } else if (type == T::RIGHT_BRACE && !blocks_.empty()) {
      else_ifs_ = blocks_.back().else_ifs;
      bare_ = blocks_.back().bare;
      blocks_.pop_back();
    } else if (type == T::CLOSE || type == T::OPEN) {
      blocks_.clear();
      else_ifs_ = bare_ = 0;
    } else if (is_control(type)) {
      const bool begins_chain = !is_else(type) && !is_else(last_);
      if (begins_chain && !header_ended_) else_ifs_ = bare_ = 0;
      ++bare_;
      else_ifs_ += is_else(type);
    }
    if (parentheses_ == 0 && type != T::RIGHT && !is_control(type)) header_ended_ = false;
    if (type == T::RIGHT && parentheses_ == 0) header_ended_ = in_header_;
    if (is_control(type)) in_header_ = true, header_ended_ = is_else(type) || type == T::DO;
    else if (parentheses_ == 0 && type != T::RIGHT) in_header_ = false;
    last_ = type;
    if (else_ifs_ > kMaxElseIf) return "this chain of else if is too long; use switch";
    if (bare_ - 2 * else_ifs_ > kMaxBareNesting) return "statements are nested too deep";
    return nullptr;
  }

  struct Block { int else_ifs; int bare; };
  std::vector<Block> blocks_;
  int parentheses_ = 0;
  int operators_ = 0;
  int prefix_ = 0;
  int else_ifs_ = 0;
  int bare_ = 0;
  bool in_header_ = false;
  bool header_ended_ = false;
  std::size_t last_ = 0;
};

}  // namespace

bool within_limits(SyntaxTree& tree, source::Diagnostics& diagnostics) {
  NestingScan scan;
  std::size_t line = 0;
  int on_line = 0;
  for (const antlr4::Token* token : tree.tokens->getTokens()) {
    const char* problem = scan.take(token->getType(), token->getLine() != line);
    on_line = token->getLine() == line ? on_line + 1 : 0;
    if (token->getStopIndex() - token->getStartIndex() >= kMaxWord && is_word(token->getType())) problem = "this word is too long; put blanks between its parts";
    if (on_line > kMaxLineTokens) problem = "this line is too long; break it";
    line = token->getLine();
    if (!problem) continue;
    diagnostics.error("PM2010", tree.span_of(*token), problem);
    return false;
  }
  return true;
}

}  // namespace pmac::compiler::power_pmac
