#include "runtime/interpreter/print_format.h"

#include <cmath>
#include <cstdint>

#include <fmt/printf.h>

#include "compiler/bytecode/operators.h"

namespace pmac::runtime {
namespace {

using bytecode::Conversion;
using bytecode::ConversionKind;

/// The conversion with another letter; flags that mean nothing for it are left out.
std::string with_letter(const Conversion& conversion, char letter, std::string_view without) {
  std::string text = "%";
  bool in_flags = true;
  for (const char c : conversion.flags_and_width) {
    in_flags = in_flags && (c < '1' || c > '9') && c != '.';
    if (!in_flags || without.find(c) == std::string_view::npos) text += c;
  }
  return text + letter;
}

std::string without_precision(std::string spec) {
  const std::size_t dot = spec.find('.');
  if (dot == std::string::npos) return spec;
  return spec.substr(0, dot) + spec.back();
}

std::string print_integer(const Conversion& conversion, double value) {
  const std::int64_t integer = bytecode::integer_from(value);
  switch (conversion.letter) {
    case 'd':
    case 'i': return fmt::sprintf(with_letter(conversion, 'd', "#"), static_cast<long long>(integer));
    case 'c': return fmt::sprintf(without_precision(with_letter(conversion, 'c', "#+ 0")), static_cast<char>(integer & 0xff));
    case 'u': return fmt::sprintf(with_letter(conversion, 'u', "#+ "), static_cast<unsigned long long>(integer));
    default: return fmt::sprintf(with_letter(conversion, conversion.letter, "+ "), static_cast<unsigned long long>(integer));
  }
}

}  // namespace

std::string print_value(const Conversion& conversion, double value) {
  if (!std::isfinite(value)) return fmt::sprintf(without_precision(with_letter(conversion, 'f', "#0")), std::isnan(value) ? std::abs(value) : value);  // nan has no sign
  if (conversion.kind == ConversionKind::kInteger) return print_integer(conversion, value);
  return fmt::sprintf("%" + conversion.flags_and_width + conversion.letter, value);
}

std::string print_text(const Conversion& conversion, const std::string& text) {
  return fmt::sprintf(with_letter(conversion, 's', "#+ 0"), text);
}

}  // namespace pmac::runtime
