// Syntax errors: one message for each wrong statement, and on with the next statement. A rule inside a statement does not try to
// repair anything: its exception goes up to the statement, which skips to its end.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <iterator>

#include "compiler/frontend/power_pmac/frontend.h"
#include "compiler/frontend/power_pmac/syntax_tree.h"

namespace pmac::compiler::power_pmac {
namespace {

using Parser = grammar::PowerPmacParser;
using antlr4::Token;

bool absorbs_errors(std::size_t rule) {
  return rule == Parser::RuleStatement || rule == Parser::RuleOnline || rule == Parser::RuleOpenHeader || rule == Parser::RuleEntryPoint ||
         rule == Parser::RuleCaseLabel || rule == Parser::RuleBuffer || rule == Parser::RuleFile;
}

bool holds_statements(std::size_t rule) {
  return rule == Parser::RuleFile || rule == Parser::RuleBuffer || rule == Parser::RuleBlock || rule == Parser::RuleSwitchStatement;
}

class Recovery : public antlr4::DefaultErrorStrategy {
 public:
  Recovery(const SyntaxTree& tree, const DeclaredNames& names, source::Diagnostics& diagnostics) : tree_(tree), names_(names), diagnostics_(diagnostics) {}

  void recover(antlr4::Parser* parser, std::exception_ptr error) override {
    if (!absorbs_errors(parser->getContext()->getRuleIndex())) std::rethrow_exception(error);
    const bool no_progress = parser->getContext()->start && parser->getCurrentToken()->getTokenIndex() <= parser->getContext()->start->getTokenIndex();
    skip_statement(*parser, no_progress);
    endErrorCondition(parser);
  }

  antlr4::Token* recoverInline(antlr4::Parser* parser) override {
    const std::size_t next = parser->getCurrentToken()->getType();
    const bool buffer_left_open = parser->getContext()->getRuleIndex() == Parser::RuleBuffer && (next == Token::EOF || next == Parser::OPEN);
    if (buffer_left_open) {
      report_open_buffer(*parser);
      return parser->getCurrentToken();
    }
    throw antlr4::InputMismatchException(parser);
  }

  /// Before each turn of a loop over statements: skips what no statement begins with.
  void sync(antlr4::Parser* parser) override {
    if (!holds_statements(parser->getContext()->getRuleIndex())) return;
    const auto& expected = parser->getATN().nextTokens(parser->getInterpreter<antlr4::atn::ParserATNSimulator>()->atn.states[parser->getState()]);
    if (parser->getContext()->getRuleIndex() == Parser::RuleSwitchStatement && !is_inside_braces(*parser)) return;
    while (true) {
      const std::size_t next = parser->getCurrentToken()->getType();
      if (expected.contains(next) || expected.contains(Token::EPSILON)) return;
      if (next == Token::EOF || (next == Parser::OPEN || next == Parser::CLOSE)) return;
      report_unexpected_begin(*parser);
      skip_statement(*parser, true);
    }
  }

  void reportError(antlr4::Parser* parser, const antlr4::RecognitionException& error) override {
    const auto index = static_cast<std::ptrdiff_t>(error.getOffendingToken()->getTokenIndex());
    if (inErrorRecoveryMode(parser) || index == reported_index_) return;
    reported_index_ = index;
    beginErrorCondition(parser);
    describe(*parser, error);
  }

 private:
  static bool is_inside_braces(antlr4::Parser& parser) {
    auto* context = parser.getContext();
    return std::any_of(context->children.begin(), context->children.end(), [](antlr4::tree::ParseTree* child) { return child->getText() == "{"; });
  }

  void skip_statement(antlr4::Parser& parser, bool consume_first) {
    const auto take = [&] {
      if (parser.getCurrentToken()->getType() == Parser::LEFT_BRACE) ++phantom_braces_;
      parser.consume();
    };
    const auto stops = [&] {
      const std::size_t next = parser.getCurrentToken()->getType();
      const bool new_line = parser.getTokenStream()->index() > 0 && parser.getCurrentToken()->getLine() != parser.getTokenStream()->LT(-1)->getLine();
      return next == Token::EOF || next == Parser::CLOSE || next == Parser::OPEN || next == Parser::SEMICOLON || next == Parser::RIGHT_BRACE || next == Parser::LINE_END || new_line;
    };
    if (consume_first && parser.getCurrentToken()->getType() != Token::EOF) take();
    while (!stops()) take();
  }

  std::string quoted(const antlr4::Token& token) const {
    if (token.getType() == Token::EOF) return "the end of the file";
    return fmt::format("'{}'", tree_.text_of(token));
  }

  void report_open_buffer(antlr4::Parser& parser) {
    const auto* next = parser.getCurrentToken();
    const auto opened = tree_.span_of(*parser.getContext()->start);
    const bool at_end = next->getType() == Token::EOF;
    const char* message = at_end ? "the buffer is never closed; add close" : "open inside an open buffer; close is missing before it";
    diagnostics_.error(at_end ? "PM2004" : "PM2005", at_end ? opened : tree_.span_of(*next), message).notes.push_back({opened, "the buffer was opened here"});
  }

  void report_unexpected_begin(antlr4::Parser& parser) {
    const auto* next = parser.getCurrentToken();
    if (next->getType() == Parser::LINE_END) return;  // of a statement that was wrong
    if (next->getType() == Parser::RIGHT_BRACE && phantom_braces_ > 0) {
      --phantom_braces_;
      return;
    }
    const auto index = static_cast<std::ptrdiff_t>(next->getTokenIndex());
    if (index == reported_index_) return;
    reported_index_ = index;
    if (next->getType() == Parser::RIGHT_BRACE) diagnostics_.error("PM2003", tree_.span_of(*next), "this } closes nothing; remove it, or add the missing {");
    else if (next->getType() == Parser::ELSE || next->getType() == Parser::ELSE_IF) diagnostics_.error("PM2006", tree_.span_of(*next), "else without if");
    else diagnostics_.error("PM2001", tree_.span_of(*next), fmt::format("a statement cannot begin with {}{}", quoted(*next), hint_for(tree_.text_of(*next))));
  }

  /// What people mean by it: lines of CNC part programs, indices.
  static std::string_view hint_for(std::string_view begin) {
    if (begin == "%") return "; the % lines at the ends of a part program file are to be taken out";
    if (begin == "(") return "; comments of part programs stand behind // here";
    if (begin == "[") return "; square brackets belong to structures, the computed number of a variable stands in round ones: P(P2)";
    if (begin == "/") return "; a line that can be skipped begins with cskip and the number of its flag";
    return {};
  }

  void describe(antlr4::Parser& parser, const antlr4::RecognitionException& error) {
    const auto* offending = error.getOffendingToken();
    if (parser.getContext()->getRuleIndex() == Parser::RuleBuffer && (offending->getType() == Token::EOF || offending->getType() == Parser::OPEN)) return report_open_buffer(parser);
    if (describe_missing_brace(parser, *offending) || describe_unknown_word(parser, *offending) || describe_bare_number(parser)) return;
    const auto expected = error.getExpectedTokens();
    const std::string wanted = expected.size() == 1 ? describe_token(static_cast<std::size_t>(expected.getSingleElement())) : std::string();
    const antlr4::Token* before = parser.getTokenStream()->LT(-1);
    const antlr4::Token* begin = statement_begin(parser);
    const bool has_begun = before && begin && before->getTokenIndex() >= begin->getTokenIndex();
    const bool ends_too_early = has_begun && before->getLine() != offending->getLine();
    if (ends_too_early) {
      const source::Span place = tree_.span_of(*before);
      const std::string text = wanted.empty() ? fmt::format("the statement is not complete behind {}", quoted(*before)) : fmt::format("expected {} at the end of the line", wanted);
      diagnostics_.error(wanted.empty() ? "PM2014" : "PM2002", place, text);
    } else if (!wanted.empty()) {
      diagnostics_.error("PM2002", tree_.span_of(*offending), fmt::format("expected {} before {}", wanted, quoted(*offending)));
    } else {
      diagnostics_.error("PM2001", tree_.span_of(*offending), fmt::format("unexpected {}", quoted(*offending)));
    }
  }

  /// First token of the statement that the parser is in.
  static const antlr4::Token* statement_begin(antlr4::Parser& parser) {
    for (auto* context = parser.getContext(); context; context = dynamic_cast<antlr4::ParserRuleContext*>(context->parent)) {
      const std::size_t rule = context->getRuleIndex();
      if (rule == Parser::RuleStatement || rule == Parser::RuleOnline || rule == Parser::RuleOpenHeader || rule == Parser::RuleEntryPoint) return context->start;
    }
    return parser.getContext()->start;
  }

  bool describe_missing_brace(antlr4::Parser& parser, const antlr4::Token& offending) {
    const std::size_t rule = parser.getContext()->getRuleIndex();
    const bool in_block = rule == Parser::RuleBlock || rule == Parser::RuleSwitchStatement;
    const std::size_t next = offending.getType();
    if (!in_block || (next != Parser::CLOSE && next != Parser::OPEN && next != Token::EOF)) return false;
    auto& message = diagnostics_.error("PM2007", tree_.span_of(offending), fmt::format("missing }} before {}", quoted(offending)));
    message.notes.push_back({tree_.span_of(*parser.getContext()->start), "the block was opened here"});
    return true;
  }

  /// kill P1: read as kill, and then an assignment to P1 that has no =.
  bool describe_bare_number(antlr4::Parser& parser) {
    static constexpr std::string_view kCommands[] = {"kill", "dkill", "home", "homez", "enable", "disable", "ddisable", "adisable", "abort", "hold",
                                                     "pause", "resume", "run", "step", "start", "jog"};
    const antlr4::Token* number = statement_begin(parser);
    if (!number || number->getTokenIndex() == 0 || number->getTokenIndex() + 1 >= parser.getTokenStream()->size()) return false;
    const antlr4::Token* digits = parser.getTokenStream()->get(number->getTokenIndex() + 1);
    const std::string name = std::string(tree_.text_of(*number)) + std::string(tree_.text_of(*digits));   // a letter and its number are two tokens
    const bool is_variable = name.size() > 1 && std::string_view("PQMIpqmi").find(name[0]) != std::string_view::npos && name[1] >= '0' && name[1] <= '9';
    const antlr4::Token* word = parser.getTokenStream()->get(number->getTokenIndex() - 1);
    if (tree_.text_of(*word).find_first_of("+-/") == 0 && word->getTokenIndex() > 0) word = parser.getTokenStream()->get(word->getTokenIndex() - 1);
    std::string command(tree_.text_of(*word));
    std::transform(command.begin(), command.end(), command.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    const bool is_command = std::find(std::begin(kCommands), std::end(kCommands), command) != std::end(kCommands);
    if (!is_variable || !is_command || word->getLine() != number->getLine()) return false;
    source::Span place = tree_.span_of(*number);
    place.end = tree_.span_of(*digits).end;
    diagnostics_.error("PM3039", place, fmt::format("the number of a thing is a constant, a local variable, or an expression in parentheses: ({})", name)).fix =
        source::FixIt{place, fmt::format("({})", name), source::FixSafety::kSuggestion, {}};
    return true;
  }

  /// A statement that begins with a word of no meaning, or that names something undeclared.
  bool describe_unknown_word(antlr4::Parser& parser, const antlr4::Token& offending) {
    const antlr4::Token* word = nullptr;
    for (auto* context = parser.getContext(); context; context = dynamic_cast<antlr4::ParserRuleContext*>(context->parent)) {
      const std::size_t rule = context->getRuleIndex();
      if (rule != Parser::RuleStatement && rule != Parser::RuleOnline) continue;
      word = context->start;
      break;
    }
    const bool unknown = word && word->getType() == Parser::NAME && !names_.contains(tree_.text_of(*word)) &&
                         (offending.getTokenIndex() <= word->getTokenIndex() + 1);
    if (!unknown) return false;
    report_unknown_word(*word);
    return true;
  }

  void report_unknown_word(const antlr4::Token& token) {
    reported_index_ = static_cast<std::ptrdiff_t>(token.getTokenIndex());
    const std::string_view word = tree_.text_of(token);
    std::vector<std::string_view> candidates = keyword_names();
    if (diagnostics_.dropped_count() == 0) {  // otherwise only its number counts
      candidates.insert(candidates.end(), names_.global.begin(), names_.global.end());
      candidates.insert(candidates.end(), names_.local.begin(), names_.local.end());
    }
    const std::size_t letters = static_cast<std::size_t>(std::find_if(word.begin(), word.end(), [](char c) { return c >= '0' && c <= '9'; }) - word.begin());
    if (letters == 1 && word.size() > 1 && (word[0] == 'O' || word[0] == 'o')) {
      diagnostics_.error("PM2050", tree_.span_of(token), fmt::format("'{}' is the number of a part program; here it stands in open prog {}, so take this line out", word, word.substr(1)));
      return;
    }
    const bool looks_like_axis = letters <= 2 && letters < word.size();
    if (looks_like_axis) {
      diagnostics_.error("PM2009", tree_.span_of(token), fmt::format("'{}' is no axis; the axes are A B C U V W X Y Z and AA to HH, LL to ZZ", word.substr(0, letters)));
      return;
    }
    source::Span place = tree_.span_of(token);
    source::Guess near = source::guess_word(word, candidates);
    if (near.word.empty() || near.word.size() + 1 < word.size()) {  // circel1: a number is glued to the word
      const source::Guess without_number = source::guess_word(word.substr(0, letters), keyword_names());
      if (letters < word.size() && !without_number.word.empty() && place.expansion < 0) near = without_number, place.end = place.begin + static_cast<std::uint32_t>(letters);
    }
    auto& error = diagnostics_.error("PM2008", tree_.span_of(token), near.word.empty() ? fmt::format("unknown word '{}'", word) : fmt::format("unknown word '{}'; did you mean '{}'?", word, near.word));
    if (!near.word.empty()) error.fix = source::guess_fix(place, near);
  }

  const SyntaxTree& tree_;
  const DeclaredNames& names_;
  source::Diagnostics& diagnostics_;
  int phantom_braces_ = 0;              // opening braces that were skipped
  std::ptrdiff_t reported_index_ = -1;  // token of the last error: one message for each
};

}  // namespace

std::shared_ptr<antlr4::ANTLRErrorStrategy> make_recovery(const SyntaxTree& tree, const DeclaredNames& names, source::Diagnostics& diagnostics) {
  return std::make_shared<Recovery>(tree, names, diagnostics);
}

}  // namespace pmac::compiler::power_pmac
