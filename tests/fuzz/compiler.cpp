// Fuzz target: program text to the compiler. It compiles or is refused with a message; what compiles is accepted by verify(), and its object
// file loads to the same bytes.
#include "compiler/bytecode/object_file.h"
#include "compiler/compiler.h"
#include "tests/fuzz/target.h"

using namespace pmac;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  compiler::Session session;
  const auto module = session.compile({{"fuzz.pmc", std::string(fuzz::text_of(data, size))}});
  fuzz::check(module.has_value() != session.diagnostics().has_errors(), "a module, or an error that says why there is none");
  if (!module) return 0;
  fuzz::check(bytecode::verify(*module).empty(), "what the compiler makes is verified");
  const auto bytes = bytecode::save(*module);
  const auto loaded = bytecode::load(bytes);
  fuzz::check(std::holds_alternative<bytecode::Module>(loaded), "what is saved can be loaded");
  fuzz::check(bytecode::save(std::get<bytecode::Module>(loaded)) == bytes, "what is loaded is saved as the same bytes");
  return 0;
}
