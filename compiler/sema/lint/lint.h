// Programs that are correct and yet suspicious: what no one writes on purpose. Each check is a warning of its own name. They run on
// bound IR without errors, and are silent wherever the text does not decide.
#pragma once

#include <vector>

#include "compiler/ir/ir.h"
#include "compiler/sema/sema.h"

namespace pmac::compiler::sema {

/// All checks below, on the units of one compilation.
void lint(const std::vector<ir::Unit>& units, const Project& project, source::Diagnostics& diagnostics);

/// Local variables and parameters that nothing reads (lint_locals.cpp).
void lint_locals(const ir::Buffer& buffer, source::Diagnostics& diagnostics);
/// Statements that are never reached, cases that fall through, conditions and assignments without effect, labels without jump
/// (lint_flow.cpp).
void lint_flow(const ir::Buffer& buffer, source::Diagnostics& diagnostics);
/// Waits and synchronous assignments where they do nothing, outputs that come early, moves without a mode (lint_motion.cpp).
void lint_motion(const ir::Buffer& buffer, source::Diagnostics& diagnostics);
/// Loops without end, and loops that wait where nothing can happen (lint_loops.cpp).
void lint_loops(const std::vector<ir::Unit>& units, const Project& project, source::Diagnostics& diagnostics);
/// Circles where the set-up switches no segmentation on (lint_motion.cpp).
void lint_circles(const std::vector<ir::Unit>& units, const Project& project, source::Diagnostics& diagnostics);
/// Variables used by a number that belongs to a declared name (lint_names.cpp).
void lint_names(const std::vector<ir::Unit>& units, const Project& project, source::Diagnostics& diagnostics);

}  // namespace pmac::compiler::sema
