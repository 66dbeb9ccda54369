// Fuzz target: macros, conditions and includes. What the loader would see (-E) is printed or refused; where the program compiles, what is
// printed compiles, too, and printing it again changes nothing.
#include "compiler/compiler.h"
#include "tests/fuzz/target.h"

using namespace pmac;

namespace {

bool compiles(const std::string& text) {
  compiler::Session session;
  return session.compile({{"fuzz.pmc", text}}).has_value();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(fuzz::text_of(data, size));
  compiler::Session session;
  const std::string expanded = compiler::emit_preprocessed(session, {{"fuzz.pmc", text}});
  if (session.diagnostics().has_errors()) return 0;
  if (compiles(text)) fuzz::check(compiles(expanded), "what -E prints compiles where the program does");
  return 0;
}
