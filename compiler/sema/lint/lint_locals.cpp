// Local variables and parameters that nothing reads.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "compiler/ir/walk.h"
#include "compiler/sema/lint/lint.h"

namespace pmac::compiler::sema {
namespace {

struct LocalUse { source::Span span; bool is_parameter = false, by_reference = false; int reads = 0, writes = 0; };
using LocalUses = std::map<std::string, LocalUse, std::less<>>;

/// The statements of one scope: those of the buffer up to its first routine, or those of a routine.
struct Scope { const std::vector<ir::Parameter>* parameters; std::size_t first, last; };

std::vector<Scope> scopes_of(const ir::Buffer& buffer) {
  std::vector<Scope> scopes{{&buffer.parameters, 0, buffer.body.size()}};
  for (const ir::Routine& routine : buffer.routines) {
    scopes.back().last = routine.first;
    scopes.push_back({&routine.parameters, routine.first, buffer.body.size()});
  }
  return scopes;
}

/// False where a local is reached by a computed number, so that nothing can be said.
bool count_uses(const ir::Buffer& buffer, const Scope& scope, LocalUses& locals) {
  bool certain = true;
  const auto declare = [&](const ir::Stmt& statement) {
    const auto* declaration = std::get_if<ir::Locals>(&statement.node);
    if (!declaration) return;
    for (const ir::LocalDeclaration& name : declaration->names) locals.emplace(name.name, LocalUse{name.name_span, false, false, 0, 0});
  };
  const auto use = [&](const ir::Expr& expr, ir::Use how) {
    const auto* variable = std::get_if<ir::Variable>(&expr.node);
    if (!variable || variable->variable_class != ir::VariableClass::kL) return;
    certain = certain && !variable->name.empty();
    const auto local = locals.find(variable->name);
    if (local == locals.end()) return;
    local->second.reads += how != ir::Use::kWrite && how != ir::Use::kUpdate;
    local->second.writes += how != ir::Use::kRead;
  };
  for (std::size_t i = scope.first; i < scope.last; ++i) ir::walk(*buffer.body[i], {declare, {}});
  for (std::size_t i = scope.first; i < scope.last; ++i) ir::walk(*buffer.body[i], {{}, use});
  return certain;
}

void report(const std::string& name, const LocalUse& local, source::Diagnostics& diagnostics) {
  if (local.reads > 0 || (local.by_reference && local.writes > 0)) return;
  if (local.is_parameter && local.writes == 0) diagnostics.warning("PM7009", local.span, fmt::format("the parameter '{}' is not used", name));
  else if (local.writes == 0) diagnostics.warning("PM7007", local.span, fmt::format("the local variable '{}' is not used", name));
  else diagnostics.warning("PM7008", local.span, fmt::format("'{}' is assigned and never read", name));
}

}  // namespace

void lint_locals(const ir::Buffer& buffer, source::Diagnostics& diagnostics) {
  for (const Scope& scope : scopes_of(buffer)) {
    LocalUses locals;
    for (const ir::Parameter& parameter : *scope.parameters) locals.emplace(parameter.name, LocalUse{parameter.span, true, parameter.by_reference, 0, 0});
    if (!count_uses(buffer, scope, locals)) continue;
    for (const auto& [name, local] : locals) report(name, local, diagnostics);
  }
}

}  // namespace pmac::compiler::sema
