// The pass that binds and checks one unit; private to this folder.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "compiler/bytecode/format_text.h"
#include "compiler/sema/sema.h"

namespace pmac::compiler::sema {

class Binder {
 public:
  Binder(Project& project, const Settings& settings, source::Diagnostics& diagnostics) : project_(project), settings_(settings), diagnostics_(diagnostics) {}

  void bind_buffer(ir::Buffer& buffer);
  void bind_statement(ir::Stmt& statement);

  /// How many L variables the load stream has used since its last buffer.
  std::int64_t local_count() const { return highest_local_ + 1; }

 private:
  struct Local { std::int64_t number; std::int64_t size; source::Span span; };

  // statements (check.cpp)
  void bind_body(ir::Body& body);
  void bind(ir::Block& node, const source::Span& span);
  void bind(ir::Assign& node, const source::Span& span);
  void bind(ir::AssignSeries& node, const source::Span& span);
  void bind(ir::If& node, const source::Span& span);
  void bind(ir::While& node, const source::Span& span);
  void bind(ir::DoWhile& node, const source::Span& span);
  void bind(ir::Switch& node, const source::Span& span);
  void bind(ir::Break& node, const source::Span& span);
  void bind(ir::Continue& node, const source::Span& span);
  void bind(ir::Label& node, const source::Span& span);
  void bind(ir::Locals& node, const source::Span& span);
  void bind(ir::Jump& node, const source::Span& span);
  void bind(ir::Call& node, const source::Span& span);
  void bind(ir::CodeLine& node, const source::Span& span);
  void bind(ir::LineCondition& node, const source::Span& span);
  void bind(ir::SetFlag& node, const source::Span& span);
  void bind(ir::Cycle& node, const source::Span& span);
  void check_flag(const ir::Expr& flag);
  void bind(ir::SetParameter& node, const source::Span& span);
  void bind(ir::SetNormal& node, const source::Span& span);
  void bind(ir::Move& node, const source::Span& span);
  void bind(ir::MoveRows&, const source::Span&) {}  // constants in a prog or subprog buffer
  void bind(ir::Dwell& node, const source::Span& span);
  void bind(ir::Delay& node, const source::Span& span);
  void bind(ir::Evaluate& node, const source::Span& span);
  void bind(ir::Control& node, const source::Span& span);
  void bind(ir::Command& node, const source::Span& span);
  void bind(ir::Send& node, const source::Span& span);
  void bind(ir::AddressCoord& node, const source::Span& span);
  void bind(ir::AddressMotor& node, const source::Span& span);
  void bind(ir::DefineAxis& node, const source::Span& span);
  void bind(ir::DefinePointer& node, const source::Span& span);
  void bind(ir::Globals& node, const source::Span& span);
  void bind(ir::Report& node, const source::Span& span);
  template <class Other> void bind(Other&, const source::Span&) {}  // nothing to bind

  void bind_routine_name(ir::Jump& node, const source::Span& span);
  void bind_named_call(ir::Call& node, const source::Span& span);
  void bind_program_name(ir::Expr& expr, bytecode::SymbolKind kind, std::string_view what);
  void bind_arguments_of_call(std::vector<ir::ExprPtr>& arguments, std::vector<bool>& by_reference);
  void mark_references(std::vector<bool>& by_reference, std::vector<ir::ExprPtr>& arguments, const std::vector<ir::Parameter>& parameters, const source::Span& span, std::string_view name);
  void check_returned(const ir::Expr& argument, std::string_view name);
  void bind_pointer_element(ir::Expr& expr);
  void check_list_bounds(const ir::Assign& node);
  void check_bare_number(const ir::Expr& number);
  void check_control_number(const ir::Control& node);
  void begin_buffer(ir::Buffer& buffer);
  void begin_routine(const std::vector<ir::Parameter>& parameters);
  void resolve_addressed(ir::Buffer& buffer);
  std::int64_t declare_local(const std::string& name, std::int64_t size, const source::Span& span);

  // expressions (bind_expression.cpp)
  void bind_value(ir::Expr& expr);       // a number: no comparison in it
  void bind_condition(ir::Expr& expr);   // comparisons, && || !, or a number
  void bind_target(ir::Expr& expr);      // something that can be assigned
  void bind_optional(ir::ExprPtr& expr);
  void bind_expr(ir::Expr& expr);
  void bind_variable(ir::Variable& variable, const source::Span& span);
  void bind_name(ir::Expr& expr);
  bool bind_kinematic_name(ir::Expr& expr, std::string_view name);
  bool bind_declared_name(ir::Expr& expr, ir::NameUse& use);

  // functions and texts (bind_function.cpp)
  bool is_function(std::string_view name) const;
  bool is_declared(std::string_view name) const;
  bool is_variable(std::string_view name) const;
  bool report_misspelt_statement(const std::string& name, const source::Span& span);
  void report_user_routine(const source::Span& span);
  void bind_function(ir::Expr& expr, ir::NameUse& use);
  void bind_arguments(bytecode::Function function, std::vector<ir::ExprPtr>& arguments, const source::Span& span);
  void bind_argument(ir::Expr& argument, char letter, std::string_view function, std::size_t number);
  void bind_address(ir::Expr& argument, bool variables_only);
  std::int64_t array_end(const ir::Variable& variable) const;
  void bind_format(const std::string& text, const std::vector<ir::Expr*>& values, const source::Span& span);
  void bind_format_value(ir::Expr& value, const bytecode::Conversion& conversion);
  void bind_text_out(const std::string& text, std::vector<ir::ExprPtr>& values, const source::Span& span);

  void bind_indexed(ir::Expr& expr, ir::NameUse& use, ir::VariableClass variable_class, std::int64_t first, std::int64_t size);
  void bind_element(ir::Element& element, const source::Span& span);
  void check_element_index(const ir::Expr& index, int count, std::string_view element);
  void report_unknown_element(const ir::Element& element, const source::Span& span);
  void report_unknown(std::string_view name, const source::Span& span, std::string_view what);
  void note_stored_element(const ir::Element& element, const source::Span& span);
  void note_uncomputed_element(const ir::Element& element, const source::Span& span);
  bool is_assignable(const ir::Expr& expr) const;

  Project& project_;
  const Settings& settings_;
  source::Diagnostics& diagnostics_;
  ir::Buffer* buffer_ = nullptr;
  std::map<std::string, Local, std::less<>> locals_;
  std::int64_t next_local_ = 0;
  std::int64_t highest_local_ = -1;
  int loops_ = 0;
  int switches_ = 0;
  std::vector<std::pair<std::int64_t, source::Span>> labels_, jumps_;
};

}  // namespace pmac::compiler::sema
