// The names of a project and the numbers behind them, as the vendor's IDE assigns them: globals from P8192, C.S. globals from
// Q1024, pointers from M8192, named programs and subprograms from 100000, named PLCs from 1 (numbers in use are skipped), SUB:
// routines from label 10000. A session keeps one table for all its files.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "compiler/ir/ir.h"

namespace pmac::compiler::sema {

inline constexpr std::int64_t kFirstGlobal = 8192;
inline constexpr std::int64_t kFirstCsGlobal = 1024;
inline constexpr std::int64_t kFirstPointer = 8192;
inline constexpr std::int64_t kFirstNamedProgram = 100000;
inline constexpr std::int64_t kFirstRoutineLabel = 10000;

struct RoutineName { std::int64_t label = -1; std::vector<ir::Parameter> parameters; };

struct Name {
  bytecode::SymbolKind kind = bytecode::SymbolKind::kGlobal;
  std::int64_t number = 0;
  std::int64_t size = 0;  // elements of an array; 0: scalar
  source::Span span;
  std::vector<ir::Parameter> parameters;                     // of a subprogram
  std::map<std::string, RoutineName, std::less<>> routines;  // of a subprogram
  std::optional<ir::VariableClass> variable_class() const;
};

class NameTable {
 public:
  const Name* find(std::string_view name) const;
  Name* find(std::string_view name);
  /// A name that differs from the given one only in case, or empty.
  std::string_view find_other_case(std::string_view name) const;
  /// Makes a variable; a name that exists with the same kind and enough room keeps its number. nullopt: no numbers left.
  std::optional<std::int64_t> declare_variable(const std::string& name, bytecode::SymbolKind kind, std::int64_t size, source::Span span);
  /// Makes a program, PLC or subprogram with the next number.
  std::optional<std::int64_t> declare_program(const std::string& name, bytecode::SymbolKind kind, source::Span span);
  void use_plc_number(std::int64_t number) { plcs_in_use_.insert(number); }
  std::int64_t next_routine_label() { return next_routine_label_++; }
  /// Parameters of a subprogram that has a number and no name.
  void declare_numbered(std::int64_t number, std::vector<ir::Parameter> parameters) { numbered_[number] = std::move(parameters); }
  const std::vector<ir::Parameter>* parameters_of(std::int64_t number) const {
    const auto known = numbered_.find(number);
    return known == numbered_.end() ? nullptr : &known->second;
  }
  /// Takes a name of an object file over.
  void adopt(const bytecode::Symbol& symbol);

  /// First numbers of globals, C.S. globals and pointers that are declared from now on.
  void set_starts(std::int64_t global, std::int64_t csglobal, std::int64_t pointer);

  const std::map<std::string, Name, std::less<>>& all() const { return names_; }
  /// In order of declaration, for the symbol table of a module.
  const std::vector<std::string>& order() const { return order_; }

 private:
  Name& add(const std::string& name, Name entry);
  std::int64_t& next_number(bytecode::SymbolKind kind);

  std::map<std::string, Name, std::less<>> names_;
  std::vector<std::string> order_;
  std::map<std::int64_t, std::vector<ir::Parameter>> numbered_;
  std::set<std::int64_t> plcs_in_use_;
  std::int64_t next_global_ = kFirstGlobal, next_csglobal_ = kFirstCsGlobal, next_pointer_ = kFirstPointer;
  std::int64_t next_prog_ = kFirstNamedProgram, next_subprog_ = kFirstNamedProgram, next_plc_ = 1;
  std::int64_t next_routine_label_ = kFirstRoutineLabel;
};

}  // namespace pmac::compiler::sema
