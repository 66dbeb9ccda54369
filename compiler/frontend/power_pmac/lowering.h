// From the parse tree to IR, one function for each rule of the grammar, named for it. What the grammar accepts only to be refused
// is refused here. Private to this folder: shows the parser generator's types.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "compiler/frontend/power_pmac/syntax_tree.h"
#include "compiler/ir/ir.h"

namespace pmac::compiler::power_pmac {

class Lowering {
 public:
  using P = grammar::PowerPmacParser;

  Lowering(const SyntaxTree& tree, source::Diagnostics& diagnostics) : tree_(tree), diagnostics_(diagnostics) {}

  ir::Unit lower_file(P::FileContext* file);

 private:
  // expressions (lower_expression.cpp)
  ir::ExprPtr lower_expression(P::ExpressionContext* expression);
  ir::ExprPtr lower_condition(P::ConditionContext* condition);
  ir::ExprPtr lower_data(P::DataContext* data);
  ir::ExprPtr lower_lvalue(P::LvalueContext* lvalue);
  ir::ExprPtr lower_variable(P::VariableContext* variable);
  ir::ExprPtr lower_reference(P::ReferenceContext* reference);
  ir::ExprPtr lower_element(P::ReferenceContext* reference);
  ir::ExprPtr lower_number(antlr4::Token* token);
  std::vector<ir::ExprPtr> lower_arguments(P::ArgumentsContext* arguments);
  ir::ExprPtr lower_argument(P::ArgumentContext* argument);
  std::optional<std::int64_t> whole_number(antlr4::Token* token, std::int64_t most);
  double number_value(const antlr4::Token& token) const;

  // statements (lower_statement.cpp)
  void lower_statement(P::StatementContext* statement, ir::Body& out);
  void check_control_word(const antlr4::Token* word);
  void lower_statements(const std::vector<P::StatementContext*>& statements, ir::Body& out);
  ir::StmtPtr lower_body(P::BodyContext* body);
  ir::StmtPtr lower_block(P::BlockContext* block);
  ir::StmtPtr lower_if(P::IfStatementContext* statement);
  ir::StmtPtr lower_switch(P::SwitchStatementContext* statement);
  void lower_assignment(P::AssignmentContext* assignment, ir::Body& out);
  void lower_simple(P::SimpleStatementContext* statement, ir::Body& out);
  ir::StmtPtr lower_jump(P::SimpleStatementContext* statement);
  ir::StmtPtr lower_call(P::SimpleStatementContext* statement);
  void lower_declaration(P::DeclarationContext* declaration, ir::Body& out);
  std::vector<std::uint64_t> bit_numbers(P::PointerTargetContext* target);
  void set_self_format(P::PointerTargetContext* target, bytecode::PointerDefinition& definition);
  ir::StmtPtr lower_pointer(P::PointerTargetContext* target, source::Span span, bytecode::PointerDefinition definition);
  void lower_label(P::LabelContext* label, ir::Body& out);
  void lower_axis_query(P::SimpleStatementContext* statement, ir::Body& out);

  // motion (lower_motion.cpp)
  void lower_motion_line(P::MotionLineContext* line, ir::Body& out);
  void lower_plain_moves(P::StatementContext* statement, ir::Body& out);
  void lower_motion_word(P::MotionWordContext* word, ir::Body& out);
  void lower_spline_times(const std::vector<P::MotionWordContext*>& words, std::size_t& at, ir::Body& out);
  void lower_normal(P::MotionWordContext* word, ir::Body& out);
  void lower_axis_mode(P::MotionWordContext* word, ir::Body& out);
  void lower_move(P::MoveContext* move, ir::Body& out);
  void append_words(P::MoveWordContext* word, std::vector<ir::Word>& words);
  std::uint32_t axis_mask(P::AxisListContext* list, bool* centres);
  int axis_index(antlr4::Token* token);

  // lines of words (lower_lines.cpp)
  void lower_code_line(P::CodeLineContext* line, ir::Body& out);
  ir::LineWord lower_line_word(P::LineWordContext* word);
  /// The statement with the words behind it; the statement itself where there are none.
  ir::StmtPtr with_words(ir::StmtPtr statement, const std::vector<P::LineWordContext*>& words);
  ir::StmtPtr lower_move_with_words(P::MoveContext* move);
  bool lower_flags_and_cycles(P::SimpleStatementContext* statement, ir::Body& out);
  ir::StmtPtr lower_read(P::SimpleStatementContext* statement);
  void check_word_count(const std::vector<ir::LineWord>& words, source::Span span);

  // programs, motors, coordinate systems (lower_control.cpp)
  void lower_program_control(P::ProgramControlContext* control, ir::Body& out);
  /// Parts of a jog command; distance and trigger may be missing.
  struct Jog { std::string operation; P::JogDistanceContext* distance; P::DataContext* trigger; source::Span span; };
  void lower_jog(P::JogActionContext* jog, source::Span span, ir::Body& out);
  std::optional<ir::ControlVerb> jog_verb(const Jog& jog);
  void add_jogs(const Jog& jog, std::vector<ir::ExprPtr> motors, ir::Body& out);
  void lower_start(P::ProgramControlContext* control, ir::Body& out);
  void lower_text_out(P::ProgramControlContext* control, ir::Body& out);
  void lower_pset(P::SimpleStatementContext* statement, ir::Body& out);
  std::vector<ir::ExprPtr> lower_number_list(P::NumberListContext* list);
  std::vector<ir::ExprPtr> lower_plc_list(P::PlcListContext* list);
  void append_range(antlr4::Token* from, antlr4::Token* to, source::Span span, std::vector<ir::ExprPtr>& numbers);
  ir::ExprPtr lower_program_name(P::ProgramNameContext* name);
  ir::ExprPtr lower_program_named(antlr4::Token* name);
  std::vector<ir::ExprPtr> started_coords(P::StartItemContext* item);
  void add_control(ir::ControlVerb verb, source::Span span, std::vector<ir::ExprPtr> arguments, ir::Body& out);
  std::string string_value(const antlr4::Token& token) const;

  // what a rotary buffer cannot hold (lower_lines.cpp)
  void check_rotary(P::StatementContext* statement);

  // the load stream (lower_online.cpp)
  void lower_at_once(P::OnlineContext* online, ir::Unit& unit);
  void lower_buffer(P::BufferContext* buffer, ir::Unit& unit);
  void lower_clear(P::OnlineContext* online, ir::Unit& unit);
  void lower_clear_all(P::OnlineContext* online, ir::Unit& unit);
  void lower_open_header(P::OpenHeaderContext* header, ir::Buffer& buffer);
  std::vector<ir::Parameter> lower_parameters(P::ParametersContext* parameters);
  void lower_online(P::OnlineContext* online, ir::Body& out);
  void lower_address(P::OnlineContext* online, ir::Body& out);
  void lower_axis_definition(P::OnlineContext* online, ir::Body& out);
  void lower_pointer_command(P::OnlineContext* online, ir::Body& out);
  void lower_pointer_query(P::OnlineContext* online, ir::Body& out);
  std::int32_t index_of_pointer(P::ReferenceContext* reference);
  void lower_command(std::string_view word, source::Span span, ir::Body& out);
  // what the load stream asks (lower_query.cpp)
  void lower_alias_query(P::OnlineContext* online, ir::Body& out);
  void lower_axis_query(P::OnlineContext* online, ir::Body& out);
  void lower_variable_range(P::OnlineContext* online, ir::Body& out);
  void lower_system_command(P::OnlineContext* online, ir::Body& out);
  void lower_list(P::ListedContext* listed, source::Span span, ir::Body& out);
  bool lower_report(std::string_view word, source::Span span, ir::Body& out);
  void lower_online_jog(P::OnlineJogContext* jog, source::Span span, ir::Body& out);
  void lower_series(P::OnlineListAssignmentContext* assignment, ir::Body& out);
  std::vector<ir::ExprPtr> addressed_motors(source::Span span);
  std::vector<ir::ExprPtr> addressed_coords(source::Span span);
  std::vector<ir::ExprPtr> addressed(std::vector<std::int64_t>& list, source::Span span);

  source::Span span_of(const antlr4::ParserRuleContext* rule) const { return rule ? tree_.span_of(*rule) : source::Span{}; }
  source::Span span_of(const antlr4::Token* token) const { return token ? tree_.span_of(*token) : source::Span{}; }
  std::string text_of(const antlr4::Token* token) const { return token ? std::string(tree_.text_of(*token)) : std::string(); }
  void not_supported(source::Span span, std::string_view what);
  static antlr4::Token* token_of(antlr4::tree::TerminalNode* node) { return node ? node->getSymbol() : nullptr; }

  const SyntaxTree& tree_;
  source::Diagnostics& diagnostics_;
  bool online_ = false;                        // lowering an on-line command
  bool in_rotary_ = false;                     // lowering a rotary buffer: no jumps, blocks of one line
  bool coord_addressed_last_ = false;          // & came after #
  bool addressed_on_line_ = false;             // # or & stood on this line
  std::size_t address_line_ = 0;
  std::vector<std::int64_t> motor_list_, coord_list_;  // of #1..3 and &1,2: for the next command of the line
};

std::string lower_case(std::string_view text);

}  // namespace pmac::compiler::power_pmac
