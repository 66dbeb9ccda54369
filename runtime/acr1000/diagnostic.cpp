#include "runtime/acr1000/diagnostic.h"

#include <fmt/format.h>

namespace pmac::acr1000 {

const DiagnosticRow& row_of(DiagnosticId id) {
  static constexpr DiagnosticRow kRows[] = {
#define DIAGNOSTIC(Name, text, is_error, meaning) {text, is_error, meaning},
#include "runtime/acr1000/diagnostic.def"
#undef DIAGNOSTIC
  };
  return kRows[static_cast<std::size_t>(id)];
}

std::string text_of(const Place& place) {
  if (place.line_number >= 0) return fmt::format("line {}", place.line_number);
  return place.source.line > 0 ? fmt::format("file line {}", place.source.line) : "the host";
}

}  // namespace pmac::acr1000
