// Fuzz target: text to the formatter. It is formatted or refused with a message; what is formatted once is not changed by the second time.
#include "compiler/style/style.h"
#include "tests/fuzz/target.h"

using namespace pmac;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const style::Formatted once = style::format(fuzz::text_of(data, size), "fuzz.pmc", {}, {});
  for (const style::Problem& problem : once.problems) fuzz::check(!problem.message.empty(), "a text that is not formatted has a message");
  if (!once.problems.empty()) return 0;
  const style::Formatted twice = style::format(once.text, "fuzz.pmc", {}, {});
  fuzz::check(twice.problems.empty(), "what the formatter makes can be formatted");
  fuzz::check(twice.text == once.text, "formatting twice is formatting once");
  return 0;
}
