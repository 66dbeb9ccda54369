#include "compiler/explain.h"

#include <fmt/format.h>

namespace pmac::compiler {
namespace {

struct Row { std::string_view code, text; };

constexpr Row kRows[] = {
#define EXPLANATION(code, text) {code, text},
#include "compiler/explain.def"
#undef EXPLANATION
};

}  // namespace

std::string explain(std::string_view code) {
  for (const Row& row : kRows)
    if (row.code == code) return fmt::format("{}: {}\n", row.code, row.text);
  return {};
}

}  // namespace pmac::compiler
