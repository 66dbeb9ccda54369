// Constants that an element cannot mean: Coord[1].SegMoveTime = -5.
#include <fmt/format.h>

#include <cmath>

#include "compiler/bytecode/element_range.h"
#include "compiler/sema/sema.h"

namespace pmac::compiler::sema {
namespace {

std::string describe(const bytecode::ElementRange& range) {
  const bool open_above = std::isinf(range.most);
  if (!open_above) return fmt::format("{} to {}", range.least, range.most);
  return range.least > 0 ? "greater than 0" : fmt::format("{} or more", range.least);
}

}  // namespace

void check_element_values(const ir::Assign& assign, source::Diagnostics& diagnostics) {
  const auto* element = std::get_if<ir::Element>(&assign.target->node);
  if (!element || element->element == bytecode::kNoElement || assign.op != bytecode::AssignOp::kSet) return;
  const bytecode::ElementRange range = bytecode::element_range(element->element);
  for (const ir::ExprPtr& value : assign.values) {
    const auto constant = ir::constant_value(*value);
    if (!constant || (*constant >= range.least && *constant <= range.most)) continue;
    diagnostics.warning("PM6013", value->span, fmt::format("{} is {}", bytecode::element_info(element->element).name, describe(range)));
  }
}

}  // namespace pmac::compiler::sema
