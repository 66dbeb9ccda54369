#include "compiler/codegen/codegen.h"

#include "compiler/codegen/program_writer.h"

namespace pmac::compiler::codegen {
namespace {

void write_symbols(const sema::NameTable& names, bytecode::Module& module) {
  for (const std::string& name : names.order()) {
    const sema::Name* entry = names.find(name);
    if (!entry) continue;
    module.symbols.push_back({entry->kind, name, static_cast<std::uint32_t>(entry->number), static_cast<std::uint32_t>(entry->size), {}});
  }
}

}  // namespace

bytecode::Module generate(const std::vector<ir::Unit>& units, const sema::NameTable& names, const source::SourceManager& sources, source::Diagnostics& diagnostics) {
  bytecode::Module module;
  Tables tables(module, sources);
  for (const ir::Unit& unit : units) {
    const std::size_t first = module.programs.size();
    for (const ir::Buffer& buffer : unit.buffers) module.programs.push_back(ProgramWriter(tables, diagnostics).write_buffer(buffer));
    bytecode::Program load = ProgramWriter(tables, diagnostics).write_load(unit, first);
    module.load_order.push_back(static_cast<std::uint32_t>(module.programs.size()));
    module.programs.push_back(std::move(load));
  }
  write_symbols(names, module);
  return module;
}

}  // namespace pmac::compiler::codegen
