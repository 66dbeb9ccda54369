// Writes one program: registers, labels, and the instructions of expressions and statements. Private to this folder.
//
// Registers: L variables first, temporaries above them as a stack. R variables stand behind the frame, whose size is known only
// at the end: instructions name R(i) as kOutgoing + i until finish() puts the real numbers in.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "compiler/codegen/tables.h"
#include "compiler/ir/ir.h"

namespace pmac::compiler::codegen {

class ProgramWriter {
 public:
  ProgramWriter(Tables& tables, source::Diagnostics& diagnostics) : tables_(tables), diagnostics_(diagnostics) {}

  /// A buffer as a program.
  bytecode::Program write_buffer(const ir::Buffer& buffer);
  /// The load stream of a unit. first_program: index in the module of the unit's first buffer.
  bytecode::Program write_load(const ir::Unit& unit, std::size_t first_program);

 private:
  using Opcode = bytecode::Opcode;
  using Register = unsigned;
  static constexpr Register kOutgoing = 0x8000;

  /// A place that jumps lead to: known (backward, counted) or still to come.
  struct Target { std::int64_t pc = -1; std::vector<std::size_t> waiting; };
  struct Loop { Target* continues; Target* breaks; };
  struct LabelJump { std::size_t pc; std::int64_t label; source::Span span; };

  // program_writer.cpp
  void begin(std::int64_t local_count);
  void finish(bytecode::Program& program);
  std::size_t emit(bytecode::Instruction instruction);
  std::size_t emit_imm(Opcode op, Register a, std::int64_t imm) { return emit(bytecode::Instruction::with_imm(op, a, static_cast<std::int32_t>(imm))); }
  std::size_t emit_abc(Opcode op, Register a, Register b, Register c = 0) { return emit(bytecode::Instruction::with_bc(op, a, b, c)); }
  void jump_to(Opcode op, Register a, Target& target);
  void place(Target& target);
  Register take(unsigned count = 1);
  void place_source(const source::Span& span);
  Register outgoing(std::int64_t number);
  void patch_label_jumps();
  void patch_outgoing(bytecode::Program& program);

  // write_expression.cpp
  Register value(const ir::Expr& expr);                        // in a register of its own choice: a local stays where it is
  void value_into(const ir::Expr& expr, Register destination);
  void load_number(double number, Register destination);
  void load_variable(const ir::Variable& variable, Register destination);
  void store_variable(const ir::Variable& variable, Register source);
  void store(const ir::Expr& target, Register source);
  Register index_of(const ir::Variable& variable);
  bytecode::ElementRef make_element_ref(const ir::Element& element);
  std::int32_t element_ref(const ir::Element& element) { return tables_.element(make_element_ref(element)); }
  void binary_into(const ir::Binary& node, Register destination);
  void condition_into(const ir::Expr& expr, Register destination);
  void call_into(const ir::FunctionCall& call, Register destination);
  void address_into(const ir::AddressOf& address, Register destination);
  void format_values(const std::vector<const ir::Expr*>& values);
  void branch(const ir::Expr& condition, bool sense, Target& target);

  // write_statement.cpp
  void body(const ir::Body& statements);
  void statement(const ir::Stmt& statement);
  void write(const ir::Block& node, const source::Span& span);
  void write(const ir::Assign& node, const source::Span& span);
  void write(const ir::AssignSeries& node, const source::Span& span);
  void write(const ir::If& node, const source::Span& span);
  void write(const ir::While& node, const source::Span& span);
  void write(const ir::DoWhile& node, const source::Span& span);
  void write(const ir::Switch& node, const source::Span& span);
  void write(const ir::Break& node, const source::Span& span);
  void write(const ir::Continue& node, const source::Span& span);
  void write(const ir::Label& node, const source::Span& span);
  void write(const ir::Locals& node, const source::Span& span);
  void write(const ir::Jump& node, const source::Span& span);
  void write(const ir::Call& node, const source::Span& span);
  void write(const ir::Return& node, const source::Span& span);
  void write(const ir::Stop& node, const source::Span& span);
  void write(const ir::CodeLine& node, const source::Span& span);        // these six in write_line.cpp
  void write(const ir::ReadWords& node, const source::Span& span);
  void write(const ir::LineCondition& node, const source::Span& span);
  void write(const ir::SetFlag& node, const source::Span& span);
  void write(const ir::Cycle& node, const source::Span& span);
  void write(const ir::StepBlock& node, const source::Span& span);
  void write(const ir::SetMode& node, const source::Span& span);
  void write(const ir::SetParameter& node, const source::Span& span);
  void write(const ir::SetAbsInc& node, const source::Span& span);
  void write(const ir::SetFrax& node, const source::Span& span);
  void write(const ir::SetNormal& node, const source::Span& span);
  void write(const ir::Move& node, const source::Span& span);
  void write(const ir::MoveRows& node, const source::Span& span);
  void write(const ir::Dwell& node, const source::Span& span);
  void write(const ir::Delay& node, const source::Span& span);
  void write(const ir::Evaluate& node, const source::Span& span);
  void write(const ir::Control& node, const source::Span& span);
  void write(const ir::CardAction& node, const source::Span& span);
  void write(const ir::RelayCondition& node, const source::Span& span);
  void write(const ir::Command& node, const source::Span& span);
  void write(const ir::Send& node, const source::Span& span);
  void write(const ir::AddressCoord& node, const source::Span& span);
  void write(const ir::AddressMotor& node, const source::Span& span);
  void write(const ir::DefineAxis& node, const source::Span& span);
  void write(const ir::DefinePointer& node, const source::Span& span);
  void write(const ir::Globals& node, const source::Span& span);
  void write(const ir::Report& node, const source::Span& span);
  void write(const ir::SystemCommand& node, const source::Span& span);
  void write(const ir::OpenBuffer& node, const source::Span& span);
  void write(const ir::ExecuteAtOnce& node, const source::Span& span);
  void assign(const ir::Expr& target, bytecode::AssignOp op, const ir::Expr& right);
  void assign_synchronously(const ir::Assign& node);
  void assign_list(const ir::Assign& node);
  void assign_elements(const ir::Assign& node);
  void pass_arguments(const std::vector<ir::ExprPtr>& arguments);
  void put_line_words(const ir::CodeLine& line, std::size_t begin, std::size_t end, bool only_computed);
  void write_code(const ir::CodeLine& line, std::size_t word);
  void write_line_part(const ir::CodeLine& line, std::size_t begin, std::size_t end);
  void write_block_word(const ir::CodeLine& line, std::size_t number);
  void take_results(const std::vector<ir::ExprPtr>& arguments, const std::vector<bool>& by_reference);

  Tables& tables_;
  source::Diagnostics& diagnostics_;
  std::vector<bytecode::Instruction> code_;
  std::vector<bytecode::LineEntry> lines_;
  std::map<std::int64_t, std::size_t> labels_;
  std::vector<LabelJump> label_jumps_;
  std::vector<Loop> loops_;  // also switches: continues is null there
  std::int64_t local_count_ = 0;
  bool may_scan_ = false;    // a PLC program or a subprogram that one may call: its while loops end scans
  Register next_ = 0;
  Register highest_ = 0;
  std::int64_t outgoing_count_ = 0;
  std::size_t first_program_ = 0;
  std::optional<double> addressed_coord_;  // by the load script so far, where it is a constant
  source::Span span_;        // of the statement being written
};

}  // namespace pmac::compiler::codegen
