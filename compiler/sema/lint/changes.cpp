#include "compiler/sema/lint/changes.h"

#include <algorithm>
#include <cctype>
#include <charconv>

#include "compiler/bytecode/function.h"
#include "compiler/ir/walk.h"

namespace pmac::compiler::sema {
namespace {

using bytecode::ElementId;
using ir::VariableClass;

bool is_random(const ir::FunctionCall& call) { return call.function == bytecode::Function::kRandx || call.function == bytecode::Function::kSeed; }

/// Words of an on-line text that an = follows: what it may assign.
std::set<std::string> assigned_words(const std::string& text) {
  std::set<std::string> words;
  const auto is_word = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; };
  for (std::size_t at = text.find('='); at != std::string::npos; at = text.find('=', at + 1)) {
    std::size_t end = at;
    while (end > 0 && !is_word(text[end - 1])) --end;
    std::size_t begin = end;
    while (begin > 0 && is_word(text[begin - 1])) --begin;
    words.insert(text.substr(begin, end - begin));
  }
  return words;
}

}  // namespace

bool is_of_frame(VariableClass variable_class) {
  return variable_class == VariableClass::kL || variable_class == VariableClass::kR || variable_class == VariableClass::kC || variable_class == VariableClass::kD;
}

Needs needs_of(const ir::Expr& expr) {
  Needs needs;
  ir::walk(expr, ir::Use::kRead, {{}, [&](const ir::Expr& part, ir::Use) {
                                    if (const auto* variable = std::get_if<ir::Variable>(&part.node)) {
                                      const bool unknown = variable->index || variable->variable_class == VariableClass::kI || variable->variable_class == VariableClass::kElement;
                                      if (unknown) needs.unknown = true;
                                      else needs.variables.emplace(variable->variable_class, variable->number);
                                    } else if (const auto* element = std::get_if<ir::Element>(&part.node)) {
                                      needs.elements.insert(element->element);
                                    } else if (const auto* call = std::get_if<ir::FunctionCall>(&part.node)) {
                                      needs.unknown = needs.unknown || is_random(*call);
                                    } else if (std::holds_alternative<ir::AddressOf>(part.node) || std::holds_alternative<ir::NameUse>(part.node)) {
                                      needs.unknown = true;
                                    }
                                  }});
  return needs;
}

void Assigned::add(const ir::Stmt& statement) {
  ir::walk(statement, {[&](const ir::Stmt& inner) {
                         if (const auto* assign = std::get_if<ir::Assign>(&inner.node)) add_series(*assign);
                         else if (const auto* series = std::get_if<ir::AssignSeries>(&inner.node)) add_all(std::get_if<ir::Variable>(&series->target->node) ? std::get_if<ir::Variable>(&series->target->node)->variable_class : VariableClass::kP);
                         else if (const auto* command = std::get_if<ir::Command>(&inner.node)) add_command(command->text);
                         else if (std::holds_alternative<ir::ReadWords>(inner.node) || std::holds_alternative<ir::Control>(inner.node)) add_all(VariableClass::kD);
                       },
                       [&](const ir::Expr& expr, ir::Use use) {
                         if (use != ir::Use::kRead) add_target(expr);
                       }});
  const auto* locals = std::get_if<ir::Locals>(&statement.node);
  if (!locals) return;
  for (const ir::LocalDeclaration& name : locals->names)
    if (name.value) add_range(VariableClass::kL, name.number, 1);
}

void Assigned::add(const ir::Body& body) {
  for (const ir::StmtPtr& statement : body) add(*statement);
}

void Assigned::add_target(const ir::Expr& target) {
  if (const auto* variable = std::get_if<ir::Variable>(&target.node)) add_variable(*variable);
  else if (const auto* element = std::get_if<ir::Element>(&target.node)) add_element(element->element);
}

void Assigned::add_variable(const ir::Variable& variable) {
  if (variable.variable_class == VariableClass::kI) any_element_ = true;
  if (variable.variable_class == VariableClass::kM) any_element_ = true;  // it may point at an element
  if (!variable.index) return add_range(variable.variable_class, variable.number, 1);
  const Name* array = variable.name.empty() ? nullptr : names_.find(variable.name);
  if (array && array->size > 0) add_range(variable.variable_class, array->number, array->size);
  else add_all(variable.variable_class);
}

void Assigned::add_element(ElementId element) {
  elements_.insert(element);
  if (element == ElementId::kSysP) add_all(VariableClass::kP);
  if (element == ElementId::kCoordQ) add_all(VariableClass::kQ);
}

/// P100=1,2,3 assigns the variables behind the target, too.
void Assigned::add_series(const ir::Assign& assign) {
  const auto* first = std::get_if<ir::Variable>(&assign.target->node);
  if (first && !first->index) add_range(first->variable_class, first->number, static_cast<std::int64_t>(assign.values.size()));
}

/// What an on-line text may assign. With % in it, its numbers are known at run time only.
void Assigned::add_command(const std::string& text) {
  const auto words = assigned_words(text);
  for (const std::string& word : words) add_word(word);
  if (words.empty()) return;
  any_element_ = any_element_ || text.find('.') != std::string::npos;
  if (text.find('%') == std::string::npos && text.find("->") == std::string::npos) return;
  any_element_ = true;
  for (const VariableClass variable_class : {VariableClass::kP, VariableClass::kQ, VariableClass::kM}) add_all(variable_class);
}

void Assigned::add_word(const std::string& word) {
  if (const Name* name = names_.find(word)) {
    const auto variable_class = name->variable_class();
    if (variable_class) add_range(*variable_class, name->number, std::max<std::int64_t>(name->size, 1));
    return;
  }
  const char letter = word.empty() ? ' ' : static_cast<char>(std::tolower(static_cast<unsigned char>(word[0])));
  std::int64_t number = 0;
  const auto [end, wrong] = std::from_chars(word.data() + std::min<std::size_t>(1, word.size()), word.data() + word.size(), number);
  if (wrong != std::errc{} || end != word.data() + word.size()) return;
  if (letter == 'p') add_range(VariableClass::kP, number, 1);
  if (letter == 'q') add_range(VariableClass::kQ, number, 1);
  if (letter == 'm') add_range(VariableClass::kM, number, 1);
  any_element_ = any_element_ || letter == 'i' || letter == 'm';
}

void Assigned::add_range(VariableClass variable_class, std::int64_t first, std::int64_t count) {
  std::int64_t& end = ranges_[{variable_class, first}];
  end = std::max(end, first + count);
}

bool Assigned::may_change(const VariablePlace& place) const {
  if (all_[static_cast<std::size_t>(place.first)]) return true;
  return std::any_of(ranges_.begin(), ranges_.upper_bound(place), [&](const auto& range) { return range.first.first == place.first && place.second < range.second; });
}

bool Assigned::may_change(const Needs& needs) const {
  return needs.unknown || std::any_of(needs.variables.begin(), needs.variables.end(), [&](const VariablePlace& place) { return may_change(place); }) ||
         std::any_of(needs.elements.begin(), needs.elements.end(), [&](ElementId element) { return may_change(element); });
}

}  // namespace pmac::compiler::sema
