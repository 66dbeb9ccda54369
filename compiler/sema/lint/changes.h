// What the value of an expression depends on, and what statements assign: from both follows whether a condition can change.
#pragma once

#include <array>
#include <map>
#include <set>
#include <string>

#include "compiler/bytecode/element.h"
#include "compiler/ir/ir.h"
#include "compiler/sema/names.h"

namespace pmac::compiler::sema {

using VariablePlace = std::pair<ir::VariableClass, std::int64_t>;

struct Needs {
  std::set<VariablePlace> variables;
  std::set<bytecode::ElementId> elements;
  bool unknown = false;  // a computed number, an I variable, a random number, a text: nothing can be said
};

Needs needs_of(const ir::Expr& expr);

/// Classes of variables that belong to one running program: no other program assigns them.
bool is_of_frame(ir::VariableClass variable_class);

/// What statements may assign. Where a number is computed, every variable of the class may be meant.
class Assigned {
 public:
  explicit Assigned(const NameTable& names) : names_(names) {}

  void add(const ir::Stmt& statement);
  void add(const ir::Body& body);
  /// False: no statement that was added can change the value.
  bool may_change(const Needs& needs) const;
  bool may_change(const VariablePlace& place) const;
  bool may_change(bytecode::ElementId element) const { return any_element_ || elements_.contains(element); }

 private:
  void add_target(const ir::Expr& target);
  void add_variable(const ir::Variable& variable);
  void add_element(bytecode::ElementId element);
  void add_series(const ir::Assign& assign);
  void add_command(const std::string& text);
  void add_word(const std::string& word);
  void add_all(ir::VariableClass variable_class) { all_[static_cast<std::size_t>(variable_class)] = true; }
  void add_range(ir::VariableClass variable_class, std::int64_t first, std::int64_t count);

  const NameTable& names_;
  std::map<VariablePlace, std::int64_t> ranges_;  // first -> number behind the last
  std::set<bytecode::ElementId> elements_;
  std::array<bool, 16> all_{};
  bool any_element_ = false;
};

}  // namespace pmac::compiler::sema
