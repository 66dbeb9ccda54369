// Variables used by their number where the number belongs to a declared name.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "compiler/ir/walk.h"
#include "compiler/sema/lint/lint.h"

namespace pmac::compiler::sema {
namespace {

using Place = std::pair<ir::VariableClass, std::int64_t>;

/// First number of each declared name -> the name.
class TakenNumbers {
 public:
  explicit TakenNumbers(const NameTable& names) {
    for (const auto& [name, entry] : names.all())
      if (const auto variable_class = entry.variable_class()) by_first_[{*variable_class, entry.number}] = {name, &entry};
  }

  /// The name that a number belongs to, or null.
  const std::pair<std::string, const Name*>* find(ir::VariableClass variable_class, std::int64_t number) const {
    auto after = by_first_.upper_bound({variable_class, number});
    if (after == by_first_.begin()) return nullptr;
    const auto& [place, name] = *std::prev(after);
    const std::int64_t size = std::max<std::int64_t>(name.second->size, 1);
    return place.first == variable_class && number < place.second + size ? &name : nullptr;
  }

 private:
  std::map<Place, std::pair<std::string, const Name*>> by_first_;
};

std::string_view letter_of(ir::VariableClass variable_class) {
  return variable_class == ir::VariableClass::kP ? "P" : variable_class == ir::VariableClass::kQ ? "Q" : "M";
}

}  // namespace

void lint_names(const std::vector<ir::Unit>& units, const Project& project, source::Diagnostics& diagnostics) {
  const TakenNumbers taken(project.names);
  std::set<Place> reported;
  const auto look = [&](const ir::Expr& expr, ir::Use) {
    const auto* variable = std::get_if<ir::Variable>(&expr.node);
    if (!variable || !variable->name.empty() || variable->index) return;
    const auto* owner = taken.find(variable->variable_class, variable->number);
    if (!owner || !reported.insert({variable->variable_class, variable->number}).second) return;
    auto& warning = diagnostics.warning("PM7002", expr.span, fmt::format("{}{} is the number of '{}'; use the name, or a number below {}", letter_of(variable->variable_class), variable->number, owner->first,
                                                                         variable->variable_class == ir::VariableClass::kQ ? kFirstCsGlobal : kFirstGlobal));
    if (owner->second->span.valid()) warning.notes.push_back({owner->second->span, "declared here"});
  };
  const auto look_at_pointer = [&](const ir::Stmt& statement) {
    const auto* pointer = std::get_if<ir::DefinePointer>(&statement.node);
    if (!pointer || !pointer->name.empty() || !pointer->definition.name.empty() || pointer->definition.first_m != pointer->definition.last_m) return;
    const auto* owner = taken.find(ir::VariableClass::kM, pointer->definition.first_m);
    if (!owner || !reported.insert({ir::VariableClass::kM, pointer->definition.first_m}).second) return;
    auto& warning = diagnostics.warning("PM7002", statement.span, fmt::format("M{} is the number of '{}'; use the name, or a number below {}", pointer->definition.first_m, owner->first, kFirstPointer));
    if (owner->second->span.valid()) warning.notes.push_back({owner->second->span, "declared here"});
  };
  for (const ir::Unit& unit : units) {
    ir::walk(unit.load, {look_at_pointer, look});
    for (const ir::Buffer& buffer : unit.buffers) ir::walk(buffer.body, {{}, look});
  }
}

}  // namespace pmac::compiler::sema
