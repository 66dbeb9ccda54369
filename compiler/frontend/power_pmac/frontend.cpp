#include "compiler/frontend/power_pmac/frontend.h"

#include <fmt/format.h>

#include "compiler/frontend/power_pmac/lowering.h"
#include "compiler/frontend/power_pmac/preprocessor.h"
#include "compiler/frontend/power_pmac/syntax_tree.h"

namespace pmac::compiler::power_pmac {

struct Frontend::State {
  State(source::SourceManager& s, source::Diagnostics& d, const std::vector<std::string>& dirs) : sources(s), diagnostics(d), preprocessor(s, d, dirs) {}

  ExpandedText expand(const std::string& name, std::string text) { return preprocessor.run(sources.add_file(name, std::move(text))); }

  /// The text as it is, or with its plain moves written out where it declares names that these lines could use.
  ExpandedText with_safe_moves(ExpandedText expanded) const {
    if (!expanded.has_plain_moves() && !expanded.has_plain_lines()) return expanded;
    DeclaredNames later = names;
    lex(expanded.text_only(), later);
    return later.may_change_moves || (expanded.has_plain_lines() && later.may_change_lines) ? expanded.with_moves_written_out(sources) : std::move(expanded);
  }

  source::SourceManager& sources;
  source::Diagnostics& diagnostics;
  Preprocessor preprocessor;
  DeclaredNames names;
  bool reads_plain_moves = true;
};

Frontend::Frontend(source::SourceManager& sources, source::Diagnostics& diagnostics, const std::vector<std::string>& include_dirs)
    : state_(std::make_unique<State>(sources, diagnostics, include_dirs)) {}
Frontend::~Frontend() = default;

void Frontend::define(const std::string& name, const std::string& text) { state_->preprocessor.define(name, text); }
void Frontend::know_name(const std::string& name) { state_->names.add_global(name); }

void Frontend::know_program(const std::string& name) { state_->names.programs.insert(name); }

std::vector<std::string> Frontend::known_names() const { return {state_->names.global.begin(), state_->names.global.end()}; }

void Frontend::record_lines() { state_->preprocessor.record_lines(); }
const std::vector<SourceLine>& Frontend::recorded_lines() const { return state_->preprocessor.recorded(); }
const std::vector<MacroDefinition>& Frontend::macro_definitions() const { return state_->preprocessor.definitions(); }

void Frontend::set_max_include_depth(int depth) { state_->preprocessor.set_max_include_depth(depth); }

void Frontend::read_plain_moves(bool on) { state_->reads_plain_moves = on; }

ir::Unit Frontend::read(const std::string& name, std::string text) {
  state_->names.local.clear();
  const bool plain = state_->reads_plain_moves && !state_->names.may_change_moves;
  state_->preprocessor.read_plain_text(plain, plain && !state_->names.may_change_lines);
  ExpandedText expanded = state_->expand(name, std::move(text));
  state_->preprocessor.read_plain_text(false, false);
  const auto tree = parse(state_->with_safe_moves(std::move(expanded)), state_->names, state_->diagnostics);
  return Lowering(*tree, state_->diagnostics).lower_file(tree->root);
}

namespace {

/// Tokens that the token pass has put in; no text stands behind them.
bool is_made_up(std::size_t type) { return type == grammar::PowerPmacParser::JOIN || type == grammar::PowerPmacParser::LINE_END; }

}  // namespace

std::string Frontend::tokens(const std::string& name, std::string text) {
  const auto tree = lex(state_->expand(name, std::move(text)), state_->names);
  std::string out;
  for (const antlr4::Token* token : tree->tokens->getTokens()) {
    if (token->getType() == antlr4::Token::EOF) break;
    if (is_made_up(token->getType())) {
      out += fmt::format("  {}\n", token_name(token->getType()));
      continue;
    }
    const source::Span span = tree->span_of(*token);
    const source::LineColumn at = state_->sources.line_column(span.file, span.begin);
    std::string kind = token_name(token->getType());
    if (kind.empty()) kind = "OPERATOR";
    out += fmt::format("{}:{} {} {}\n", at.line, at.column, kind, tree->text_of(*token));
  }
  return out;
}

namespace {

void print_tree(const SyntaxTree& tree, antlr4::tree::ParseTree* node, int depth, std::string& out) {
  const std::string indent(static_cast<std::size_t>(2 * depth), ' ');
  if (auto* leaf = dynamic_cast<antlr4::tree::TerminalNode*>(node)) {
    if (!is_made_up(leaf->getSymbol()->getType()) && leaf->getSymbol()->getType() != antlr4::Token::EOF) out += fmt::format("{}'{}'\n", indent, tree.text_of(*leaf->getSymbol()));
    return;
  }
  const auto* rule = dynamic_cast<antlr4::ParserRuleContext*>(node);
  out += fmt::format("{}{}\n", indent, tree.parser->getRuleNames()[rule->getRuleIndex()]);
  for (antlr4::tree::ParseTree* child : node->children) print_tree(tree, child, depth + 1, out);
}

}  // namespace

std::vector<std::string> Frontend::ambiguities(const std::string& name, std::string text) {
  state_->names.local.clear();
  return find_ambiguities(state_->expand(name, std::move(text)), state_->names, state_->diagnostics);
}

std::string Frontend::tree(const std::string& name, std::string text) {
  const auto tree = parse(state_->expand(name, std::move(text)), state_->names, state_->diagnostics);
  std::string out;
  if (tree->root) print_tree(*tree, tree->root, 0, out);
  return out;
}

}  // namespace pmac::compiler::power_pmac
