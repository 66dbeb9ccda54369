#include "compiler/sema/lint/lint.h"

namespace pmac::compiler::sema {

void lint(const std::vector<ir::Unit>& units, const Project& project, source::Diagnostics& diagnostics) {
  for (const ir::Unit& unit : units) {
    for (const ir::Buffer& buffer : unit.buffers) {
      lint_locals(buffer, diagnostics);
      lint_flow(buffer, diagnostics);
      lint_motion(buffer, diagnostics);
    }
  }
  lint_loops(units, project, diagnostics);
  lint_circles(units, project, diagnostics);
  lint_names(units, project, diagnostics);
}

}  // namespace pmac::compiler::sema
