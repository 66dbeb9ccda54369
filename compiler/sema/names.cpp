#include "compiler/sema/names.h"

#include <algorithm>
#include <cctype>

namespace pmac::compiler::sema {

using bytecode::SymbolKind;

namespace {

bool same_but_case(std::string_view a, std::string_view b) {
  const auto same = [](char x, char y) { return std::tolower(static_cast<unsigned char>(x)) == std::tolower(static_cast<unsigned char>(y)); };
  return a != b && a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), same);
}

std::int64_t last_number(SymbolKind kind) {
  switch (kind) {
    case SymbolKind::kGlobal: return bytecode::kPCount - 1;
    case SymbolKind::kCsGlobal: return bytecode::kQCount - 1;
    case SymbolKind::kPointer: return bytecode::kMCount - 1;
    case SymbolKind::kPlc: return bytecode::kMaxPlcs - 1;
    default: return 4294967295;
  }
}

}  // namespace

std::optional<ir::VariableClass> Name::variable_class() const {
  switch (kind) {
    case SymbolKind::kGlobal: return ir::VariableClass::kP;
    case SymbolKind::kCsGlobal: return ir::VariableClass::kQ;
    case SymbolKind::kPointer: return ir::VariableClass::kM;
    default: return std::nullopt;
  }
}

const Name* NameTable::find(std::string_view name) const {
  const auto found = names_.find(name);
  return found == names_.end() ? nullptr : &found->second;
}

Name* NameTable::find(std::string_view name) {
  const auto found = names_.find(name);
  return found == names_.end() ? nullptr : &found->second;
}

std::string_view NameTable::find_other_case(std::string_view name) const {
  for (const auto& [other, entry] : names_)
    if (same_but_case(name, other)) return other;
  return {};
}

std::int64_t& NameTable::next_number(SymbolKind kind) {
  switch (kind) {
    case SymbolKind::kCsGlobal: return next_csglobal_;
    case SymbolKind::kPointer: return next_pointer_;
    case SymbolKind::kProg: return next_prog_;
    case SymbolKind::kPlc: return next_plc_;
    case SymbolKind::kSubprog: return next_subprog_;
    default: return next_global_;
  }
}

Name& NameTable::add(const std::string& name, Name entry) {
  if (!names_.contains(name)) order_.push_back(name);
  return names_.insert_or_assign(name, std::move(entry)).first->second;
}

std::optional<std::int64_t> NameTable::declare_variable(const std::string& name, SymbolKind kind, std::int64_t size, source::Span span) {
  const Name* known = find(name);
  if (known && known->kind == kind && known->size >= size && (known->size == 0) == (size == 0)) return known->number;
  std::int64_t& next = next_number(kind);
  const std::int64_t number = next;
  const std::int64_t room = std::max<std::int64_t>(size, 1);
  if (number + room - 1 > last_number(kind)) return std::nullopt;
  next += room;
  add(name, Name{kind, number, size, span, {}, {}});
  return number;
}

std::optional<std::int64_t> NameTable::declare_program(const std::string& name, SymbolKind kind, source::Span span) {
  Name* known = find(name);
  if (known && known->kind == kind) {
    known->span = span;
    return known->number;
  }
  std::int64_t& next = next_number(kind);
  while (kind == SymbolKind::kPlc && plcs_in_use_.contains(next)) ++next;
  if (next > last_number(kind)) return std::nullopt;
  add(name, Name{kind, next, 0, span, {}, {}});
  return next++;
}

void NameTable::set_starts(std::int64_t global, std::int64_t csglobal, std::int64_t pointer) {
  next_global_ = global;
  next_csglobal_ = csglobal;
  next_pointer_ = pointer;
}

void NameTable::adopt(const bytecode::Symbol& symbol) {
  if (symbol.kind == SymbolKind::kMacro) return;
  add(symbol.name, Name{symbol.kind, symbol.number, symbol.size, {}, {}, {}});
  std::int64_t& next = next_number(symbol.kind);
  const std::int64_t end = static_cast<std::int64_t>(symbol.number) + std::max<std::int64_t>(symbol.size, 1);
  next = std::max(next, end);
}

}  // namespace pmac::compiler::sema
