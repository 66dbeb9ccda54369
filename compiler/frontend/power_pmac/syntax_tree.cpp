#include "compiler/frontend/power_pmac/syntax_tree.h"

#include <algorithm>

#include "compiler/frontend/power_pmac/turbo_pass.h"

namespace pmac::compiler::power_pmac {
namespace {

class AmbiguityListener : public antlr4::BaseErrorListener {
 public:
  explicit AmbiguityListener(std::vector<std::string>& found) : found_(found) {}
  void reportAmbiguity(antlr4::Parser* parser, const antlr4::dfa::DFA& dfa, std::size_t start, std::size_t stop, bool, const antlrcpp::BitSet&,
                       antlr4::atn::ATNConfigSet*) override {
    const std::size_t rule = dfa.atnStartState->ruleIndex;
    std::string text;
    for (std::size_t i = start; i <= stop; ++i) text += " " + parser->getTokenStream()->get(i)->getText();
    found_.push_back(std::to_string(parser->getTokenStream()->get(start)->getLine()) + ": " + parser->getRuleNames()[rule] + ":" + text);
  }

 private:
  std::vector<std::string>& found_;
};

}  // namespace

std::vector<std::string> find_ambiguities(ExpandedText expanded, DeclaredNames& names, source::Diagnostics& diagnostics) {
  const auto tree = lex(std::move(expanded), names);
  std::vector<std::string> found;
  if (!within_limits(*tree, diagnostics)) return found;
  grammar::PowerPmacParser parser(tree->tokens.get());
  AmbiguityListener listener(found);
  parser.removeErrorListeners();
  parser.addErrorListener(&listener);
  parser.setErrorHandler(make_recovery(*tree, names, diagnostics));
  parser.getInterpreter<antlr4::atn::ParserATNSimulator>()->setPredictionMode(antlr4::atn::PredictionMode::LL_EXACT_AMBIG_DETECTION);
  parser.file();
  return found;
}

source::Span SyntaxTree::span_of(const antlr4::Token& token) const {
  const std::size_t size = expanded.text().size();
  if (token.getType() == antlr4::Token::EOF) {
    const std::size_t last = expanded.text().find_last_not_of(" \t\r\n");
    const std::size_t at = last == std::string::npos ? 0 : last;
    return expanded.span_of(std::min(at, size), std::min(at + 1, size));
  }
  return expanded.span_of(token.getStartIndex(), token.getStopIndex() + 1);
}

source::Span SyntaxTree::span_of(const antlr4::ParserRuleContext& rule) const {
  if (!rule.start) return {};
  if (!rule.stop || rule.stop->getTokenIndex() < rule.start->getTokenIndex()) return span_of(*rule.start);
  return source::join(span_of(*rule.start), span_of(*rule.stop));
}

std::string_view SyntaxTree::text_of(const antlr4::Token& token) const {
  if (token.getType() == antlr4::Token::EOF) return {};
  return std::string_view(expanded.text()).substr(token.getStartIndex(), token.getStopIndex() + 1 - token.getStartIndex());
}

std::unique_ptr<SyntaxTree> lex(ExpandedText expanded, DeclaredNames& names, source::Diagnostics* diagnostics) {
  auto tree = std::make_unique<SyntaxTree>();
  tree->expanded = std::move(expanded);
  tree->input = std::make_unique<antlr4::ANTLRInputStream>(lexer_input(tree->expanded.text()));
  tree->lexer = std::make_unique<WordLexer>(tree->input.get(), tree->expanded.text(), names);
  const TokenText text{[&](const antlr4::Token& token) { return tree->text_of(token); }, [&](const antlr4::Token& token) { return tree->span_of(token); }};
  tree->repaired = repair_turbo(*tree->lexer, text, names, diagnostics);
  tree->source = run_token_pass(*tree->repaired);
  tree->tokens = std::make_unique<antlr4::CommonTokenStream>(tree->source.get());
  tree->tokens->fill();
  return tree;
}

std::unique_ptr<SyntaxTree> parse(ExpandedText expanded, DeclaredNames& names, source::Diagnostics& diagnostics) {
  auto tree = lex(std::move(expanded), names, &diagnostics);
  if (!within_limits(*tree, diagnostics)) return tree;
  tree->parser = std::make_unique<grammar::PowerPmacParser>(tree->tokens.get());
  tree->parser->removeErrorListeners();
  tree->parser->setErrorHandler(make_recovery(*tree, names, diagnostics));
  tree->parser->getInterpreter<antlr4::atn::ParserATNSimulator>()->setPredictionMode(antlr4::atn::PredictionMode::SLL);
  tree->root = tree->parser->file();
  return tree;
}

}  // namespace pmac::compiler::power_pmac
