// Loops that cannot end, or that wait where nothing can happen. In a PLC program a scan ends where the body of a loop ends (or with a
// goto back), in a motion program calculation is suspended after a loop without a move: there a loop may wait for anything that
// changes meanwhile. A kinematic routine runs within one calculation; nothing changes while it loops.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "compiler/bytecode/module_text.h"
#include "compiler/ir/walk.h"
#include "compiler/sema/lint/changes.h"
#include "compiler/sema/lint/lint.h"
#include "compiler/sema/lint/loops.h"

namespace pmac::compiler::sema {
namespace {

using bytecode::ProgramKind;
using ir::VariableClass;

bool is_kinematic(const ir::Buffer& buffer) { return buffer.kind == ProgramKind::kForward || buffer.kind == ProgramKind::kInverse; }

/// Also a comparison of constants, as in while (DEBUG == 1).
bool is_always_true(const Loop& loop) {
  if (!loop.condition) return true;
  if (const auto value = ir::constant_value(*loop.condition)) return *value != 0;
  const Needs needs = needs_of(*loop.condition);
  return !needs.unknown && needs.variables.empty() && needs.elements.empty();
}

bool is_never_true(const Loop& loop) {
  const auto value = loop.condition ? ir::constant_value(*loop.condition) : std::nullopt;
  return value && *value == 0;
}

/// The controller, a pointer's target or another program may change the value while the loop runs.
bool changes_by_itself(const Needs& needs) {
  const auto is_set_up = [](bytecode::ElementId id) { return id != bytecode::kNoElement && bytecode::element_info(id).access == bytecode::ElementAccess::kSaved; };
  return needs.unknown || !std::all_of(needs.elements.begin(), needs.elements.end(), is_set_up);
}

class LoopLint {
 public:
  LoopLint(const std::vector<ir::Unit>& units, const Project& project, source::Diagnostics& diagnostics) : units_(units), names_(project.names), diagnostics_(diagnostics), programs_(project.names) {
    for_each_buffer([&](const ir::Buffer& buffer) {
      programs_.add(buffer.body);
      if (buffer.kind == ProgramKind::kSubprog) subprograms_[buffer.number] = &buffer;
    });
    const auto note_pointer = [&](const ir::Stmt& statement) {
      const auto* pointer = std::get_if<ir::DefinePointer>(&statement.node);
      if (pointer && pointer->definition.kind != bytecode::PointerKind::kSelf) pointers_.insert(pointer->definition.first_m);
    };
    for (const ir::Unit& unit : units_) ir::walk(unit.load, {note_pointer, {}});
    for_each_buffer([&](const ir::Buffer& buffer) { ir::walk(buffer.body, {note_pointer, {}}); });
  }

  void run() {
    for_each_buffer([&](const ir::Buffer& buffer) {
      for_each_loop(buffer.body, [&](const Loop& loop) { look(buffer, loop); });
      if (is_kinematic(buffer)) look_at_calls(buffer);
    });
  }

 private:
  template <class Visit>
  void for_each_buffer(const Visit& visit) const {
    for (const ir::Unit& unit : units_)
      for (const ir::Buffer& buffer : unit.buffers) visit(buffer);
  }

  void look(const ir::Buffer& buffer, const Loop& loop) {
    if (is_never_true(loop) || has_way_out(loop)) return;
    if (is_kinematic(buffer)) {
      if (blocks_calculation(loop)) diagnostics_.warning("PM7024", loop.span, "a kinematic routine runs within one calculation, and nothing in this loop changes what it waits for; it ends in a fault");
    } else if (is_always_true(loop)) {
      if (buffer.kind == ProgramKind::kProg && !may_take_time(loop)) diagnostics_.warning("PM7003", loop.span, "this loop never ends, and nothing in it moves or waits");
    } else {
      look_at_condition(loop);
    }
  }

  void look_at_condition(const Loop& loop) {
    const Needs needs = needs_of(*loop.condition);
    if (changes_by_itself(needs) || changes_in(loop, needs)) return;
    std::set<VariablePlace> shared;
    for (const VariablePlace& place : needs.variables) {
      if (place.first == VariableClass::kL) continue;
      const bool is_pointer = place.first == VariableClass::kM && pointers_.contains(place.second);
      if (is_pointer || is_of_frame(place.first)) return;
      shared.insert(place);
    }
    if (shared.empty() && needs.elements.empty()) diagnostics_.warning("PM7003", loop.span, "nothing in this loop changes what its condition depends on; once begun it never ends");
    else if (!programs_.may_change({shared, needs.elements, false})) report_host_wait(loop, shared);
  }

  void report_host_wait(const Loop& loop, const std::set<VariablePlace>& shared) {
    const std::string what = shared.empty() ? "this element" : name_of(*shared.begin());
    diagnostics_.warning("PM7023", loop.span, fmt::format("no program of the project assigns {}; only a host computer can end this loop", what));
  }

  std::string name_of(const VariablePlace& place) const {
    for (const auto& [name, entry] : names_.all())
      if (entry.variable_class() == place.first && place.second >= entry.number && place.second < entry.number + std::max<std::int64_t>(entry.size, 1)) return "'" + name + "'";
    return bytecode::variable_class_name(place.first) + std::to_string(place.second);
  }

  bool changes_in(const Loop& loop, const Needs& needs) const {
    Assigned assigned(names_);
    for (const ir::Stmt* statement : loop.body) assigned.add(*statement);
    return assigned.may_change(needs);
  }

  /// Nothing in the loop changes its condition, and while a calculation runs nothing else does.
  bool blocks_calculation(const Loop& loop) const { return is_always_true(loop) || !changes_in(loop, needs_of(*loop.condition)); }

  /// Calls of subprograms that wait in a loop.
  void look_at_calls(const ir::Buffer& buffer) {
    ir::walk(buffer.body, {[&](const ir::Stmt& statement) {
                             const auto* call = std::get_if<ir::Call>(&statement.node);
                             if (!call) return;
                             std::set<std::int64_t> seen;
                             const auto wait = wait_of(call->subprogram, seen);
                             if (wait.valid()) diagnostics_.warning("PM7024", statement.span, "a kinematic routine runs within one calculation, and this calls a loop that waits; it ends in a fault").notes.push_back({wait, "the loop is here"});
                           },
                           {}});
  }

  /// The first loop of a subprogram, or of one that it calls, that would block a calculation.
  source::Span wait_of(std::int64_t number, std::set<std::int64_t>& seen) const {
    const auto subprogram = subprograms_.find(number);
    if (subprogram == subprograms_.end() || !seen.insert(number).second) return {};
    source::Span wait;
    for_each_loop(subprogram->second->body, [&](const Loop& loop) {
      if (!wait.valid() && !is_never_true(loop) && !has_way_out(loop) && blocks_calculation(loop)) wait = loop.span;
    });
    ir::walk(subprogram->second->body, {[&](const ir::Stmt& statement) {
                                          const auto* call = std::get_if<ir::Call>(&statement.node);
                                          if (call && !wait.valid()) wait = wait_of(call->subprogram, seen);
                                        },
                                        {}});
    return wait;
  }

  const std::vector<ir::Unit>& units_;
  const NameTable& names_;
  source::Diagnostics& diagnostics_;
  Assigned programs_;                                          // by any buffer
  std::map<std::int64_t, const ir::Buffer*> subprograms_;
  std::set<std::int64_t> pointers_;                            // M variables that point at something
};

}  // namespace

void lint_loops(const std::vector<ir::Unit>& units, const Project& project, source::Diagnostics& diagnostics) { LoopLint(units, project, diagnostics).run(); }

}  // namespace pmac::compiler::sema
