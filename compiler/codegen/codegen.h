// From checked IR to bytecode: registers, jumps, tables, the line table.
#pragma once

#include "compiler/ir/ir.h"
#include "compiler/sema/names.h"
#include "compiler/source/source.h"

namespace pmac::compiler::codegen {

/// The module of units that sema found no error in: for each unit its buffers and one load script.
bytecode::Module generate(const std::vector<ir::Unit>& units, const sema::NameTable& names, const source::SourceManager& sources, source::Diagnostics& diagnostics);

}  // namespace pmac::compiler::codegen
