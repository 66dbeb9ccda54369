#include "compiler/frontend/acr1000/parse.h"

#include <fmt/format.h>

namespace pmac::compiler::acr1000 {
namespace {

using Parser = grammar::Acr1000Parser;

constexpr std::size_t kMaxParentheses = 100;  // more would use up the parser's stack
constexpr std::size_t kMaxTokens = 2000;      // of a line; long ones cost time with the square of their length

/// One message for a line: what stands wrong, and how the command is written. The line is given up then.
class OneMessage : public antlr4::DefaultErrorStrategy {
 public:
  OneMessage(const ParsedLine& line, const source::Span& place, source::Diagnostics& diagnostics) : line_(line), place_(place), diagnostics_(diagnostics) {}

  void recover(antlr4::Parser*, std::exception_ptr error) override { std::rethrow_exception(error); }
  antlr4::Token* recoverInline(antlr4::Parser* parser) override { throw antlr4::InputMismatchException(parser); }
  void sync(antlr4::Parser*) override {}
  void reportError(antlr4::Parser*, const antlr4::RecognitionException& error) override {
    if (reported_) return;
    reported_ = true;
    const std::size_t at = error.getOffendingToken()->getTokenIndex();
    const std::string how = usage_before(at);
    diagnostics_.error("ACR-E02", span_of(at), fmt::format("{}{}{}", wrong(at), how.empty() ? "" : "; ", how));
  }

 private:
  std::string wrong(std::size_t at) const {
    const bool begins_command = at == 0 || previous_is(at, Parser::COLON) || previous_is(at, Parser::LINE_NUMBER) || previous_is(at, Parser::THEN);
    if (at >= line_.tokens.size()) return begins_command && at > 0 ? "a command is missing at the end of the line" : "the line ends here, and something is missing";
    const Token& token = line_.tokens[at];
    if (begins_command && token.type == Parser::COLON) return "a command is missing before this :";
    if (begins_command) return fmt::format("a command begins with its name, not with '{}'", token.text);
    if (token.type == Parser::REMARK) return "REM is a command of its own; put a : before it";
    return fmt::format("'{}' cannot stand here", token.type == Parser::STRING ? "\"" + token.text + "\"" : token.text);
  }

  bool previous_is(std::size_t at, std::size_t type) const { return at > 0 && at <= line_.tokens.size() && line_.tokens[at - 1].type == type; }

  /// How the command is written that the word belongs to.
  std::string usage_before(std::size_t at) const {
    for (std::size_t i = std::min(at + 1, line_.tokens.size()); i-- > 0;) {
      const std::size_t type = line_.tokens[i].type;
      if (type == Parser::COLON && i < at) break;
      if (type == Parser::PARAMETER && (i == 0 || previous_is(i, Parser::COLON) || previous_is(i, Parser::LINE_NUMBER) || previous_is(i, Parser::THEN))) return "a parameter takes one value: P30=1000 or P30=P31";
      if (const std::string_view usage = usage_of(type); !usage.empty()) return std::string(usage);
    }
    return {};
  }

  source::Span span_of(std::size_t at) const {
    if (at < line_.tokens.size()) return line_.tokens[at].span;
    return {place_.file, place_.end, place_.end, -1};
  }

  const ParsedLine& line_;
  source::Span place_;
  source::Diagnostics& diagnostics_;
  bool reported_ = false;
};

bool nests_too_deep(const std::vector<Token>& tokens) {
  std::size_t depth = 0;
  for (const Token& token : tokens)
    if (token.type == Parser::LEFT && ++depth > kMaxParentheses) return true;
    else if (token.type == Parser::RIGHT && depth > 0) --depth;
  return false;
}

bool too_many_conditions(const std::vector<Token>& tokens) {
  return std::count_if(tokens.begin(), tokens.end(), [](const Token& token) { return token.type == Parser::IF; }) > static_cast<std::ptrdiff_t>(kMaxParentheses);
}

std::unique_ptr<antlr4::ListTokenSource> token_source(const std::vector<Token>& tokens) {
  std::vector<std::unique_ptr<antlr4::Token>> made;
  made.reserve(tokens.size());
  for (const Token& token : tokens) made.push_back(std::make_unique<antlr4::CommonToken>(token.type, std::string()));
  return std::make_unique<antlr4::ListTokenSource>(std::move(made));
}

void print_node(const ParsedLine& line, antlr4::tree::ParseTree* node, int depth, std::string& out) {
  const std::string indent(static_cast<std::size_t>(2 * depth), ' ');
  if (auto* leaf = dynamic_cast<antlr4::tree::TerminalNode*>(node)) {
    if (leaf->getSymbol()->getType() != antlr4::Token::EOF) out += fmt::format("{}'{}'\n", indent, line.token(leaf).text);
    return;
  }
  const auto* rule = dynamic_cast<antlr4::ParserRuleContext*>(node);
  out += fmt::format("{}{}\n", indent, line.parser->getRuleNames()[rule->getRuleIndex()]);
  for (antlr4::tree::ParseTree* child : node->children) print_node(line, child, depth + 1, out);
}

}  // namespace

source::Span ParsedLine::span_of(const antlr4::ParserRuleContext& rule) const {
  const std::size_t first = rule.start->getTokenIndex();
  const std::size_t last = rule.stop ? std::max(rule.stop->getTokenIndex(), first) : first;
  if (first >= tokens.size()) return tokens.empty() ? source::Span{} : tokens.back().span;
  return source::join(tokens[first].span, tokens[std::min(last, tokens.size() - 1)].span);
}

std::unique_ptr<ParsedLine> parse_line(const source::SourceManager& sources, const source::Span& place, source::Diagnostics& diagnostics) {
  auto line = std::make_unique<ParsedLine>();
  if (!lex_line(sources, place, line->tokens, diagnostics)) return line;
  if (nests_too_deep(line->tokens) || too_many_conditions(line->tokens)) {
    diagnostics.error("ACR-E02", place, "the line is nested deeper than any program needs");
    return line;
  }
  if (line->tokens.size() > kMaxTokens) {
    diagnostics.error("ACR-E02", place, fmt::format("a line has at most {} words and signs; make several lines of it", kMaxTokens));
    return line;
  }
  line->source = token_source(line->tokens);
  line->stream = std::make_unique<antlr4::CommonTokenStream>(line->source.get());
  line->parser = std::make_unique<Parser>(line->stream.get());
  line->parser->removeErrorListeners();
  line->parser->setErrorHandler(std::make_shared<OneMessage>(*line, place, diagnostics));
  line->parser->getInterpreter<antlr4::atn::ParserATNSimulator>()->setPredictionMode(antlr4::atn::PredictionMode::SLL);
  try {
    line->root = line->parser->line();
  } catch (const antlr4::RuntimeException&) {
    line->root = nullptr;  // has been reported
  }
  return line;
}

std::string print_tree(const ParsedLine& line) {
  std::string out;
  if (line.root) print_node(line, line.root, 0, out);
  return out;
}

std::string token_type_name(std::size_t type) {
  static const Parser parser(nullptr);
  return std::string(parser.getVocabulary().getSymbolicName(type));
}

}  // namespace pmac::compiler::acr1000
