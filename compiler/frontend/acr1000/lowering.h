// From the parse tree of one line to statements. Private to this folder: shows the parser generator's types.
#pragma once

#include <functional>
#include <optional>

#include "compiler/frontend/acr1000/parse.h"
#include "compiler/frontend/acr1000/settings.h"
#include "compiler/ir/ir.h"

namespace pmac::compiler::acr1000 {

/// What a line does to the stored program, where it is not itself stored.
class ProgramStore {
 public:
  virtual ~ProgramStore() = default;
  virtual void run(const source::Span& span, ir::Body& out, ir::ExprPtr first_line) = 0;
  virtual void list(const source::Span& span, ir::Body& out) = 0;
  virtual void erase(const source::Span& span, ir::Body& out) = 0;
  virtual void renumber(const source::Span& span, ir::Body& out) = 0;
};

/// Lowers the commands of one line. What is wrong is reported, and the statement left out.
class LineLowering {
 public:
  /// stored: the line belongs to a program; else store does what RUN, LIST, NEW and RENUMBER say.
  LineLowering(const ParsedLine& line, const Settings& settings, source::Diagnostics& diagnostics, ProgramStore* store)
      : line_(line), settings_(settings), diagnostics_(diagnostics), store_(store) {}

  /// Whether a line of that number is stored; empty: not known yet, every line is taken to be.
  std::function<bool(std::int64_t)> is_stored;

  void lower(grammar::Acr1000Parser::CommandsContext* commands, ir::Body& out);

 private:
  using Parser = grammar::Acr1000Parser;

  void command(Parser::CommandContext* command, ir::Body& out);
  void assignment(Parser::AssignmentContext* node, ir::Body& out);
  void rate(Parser::RateContext* node, ir::Body& out);
  void move(Parser::MoveContext* node, ir::Body& out);
  void circle(Parser::CircleContext* node, ir::Body& out);
  void branch(Parser::BranchContext* node, ir::Body& out);
  void conditional(Parser::ConditionalContext* node, ir::Body& out);
  void relay(Parser::RelayContext* node, ir::Body& out);
  void print(Parser::PrintContext* node, ir::Body& out);
  void poke(Parser::PokeContext* node, ir::Body& out);
  void peek(Parser::PeekContext* node, ir::Body& out);
  void plain(Parser::PlainContext* node, ir::Body& out);
  void jump(std::int64_t number, bool call, const source::Span& number_span, const source::Span& span, ir::Body& out);
  void return_from_subroutine(const source::Span& span, ir::Body& out);

  ir::ExprPtr expression(Parser::ExpressionContext* node);
  ir::ExprPtr sum(Parser::SumContext* node);
  ir::ExprPtr product(Parser::ProductContext* node);
  ir::ExprPtr operand(Parser::OperandContext* node);
  ir::ExprPtr parameter(const Token& token);
  ir::ExprPtr number(const Token& token, bool negative, const source::Span& span);
  ir::ExprPtr rotation(Parser::RotationContext* node);
  ir::ExprPtr bare_hex(antlr4::tree::TerminalNode* leaf, std::int64_t most, const char* what);
  std::optional<std::int64_t> line_number(const Token& token);
  void check_range(const ir::Expr& value, double least, double most, const std::string& what);
  source::Span span_of(const antlr4::ParserRuleContext& rule) const { return line_.span_of(rule); }

  const ParsedLine& line_;
  const Settings& settings_;
  source::Diagnostics& diagnostics_;
  ProgramStore* store_;
  bool in_condition_ = false;
};

inline constexpr std::int64_t kMaxLineNumber = 65535;

/// The line number that a digit text is, or nullopt where it is too large.
std::optional<std::int64_t> line_number_of(std::string_view digits);

ir::StmtPtr card_action(const source::Span& span, ir::CardVerb verb);
ir::StmtPtr card_action(const source::Span& span, ir::CardVerb verb, ir::ExprPtr argument);

}  // namespace pmac::compiler::acr1000
