#include "runtime/value_text.h"

#include <cmath>

#include <fmt/format.h>

#include "runtime/element_store.h"

namespace pmac::runtime {
namespace {

using bytecode::ElementType;

/// 1e-05 becomes 1e-5, 1e+20 becomes 1e20.
std::string with_short_exponent(std::string text) {
  const std::size_t e = text.find('e');
  if (e == std::string::npos) return text;
  const std::string sign = text[e + 1] == '-' ? "-" : "";
  const std::size_t digits = text.find_first_not_of("+-0", e + 1);
  return text.substr(0, e + 1) + sign + (digits == std::string::npos ? "0" : text.substr(digits));
}

/// Like %g, but magnitudes below 0.001 have an exponent already.
std::string digits_text(double value, int digits) {
  if (std::isnan(value)) return "nan";  // whatever its sign
  const bool small = value != 0 && std::abs(value) < 1e-3;
  if (!small) return with_short_exponent(fmt::format("{:.{}g}", value, digits));
  std::string text = fmt::format("{:.{}e}", value, digits - 1);
  const std::size_t e = text.find('e');
  const std::size_t last = text.find_last_not_of('0', e - 1);
  text.erase(text[last] == '.' ? last : last + 1, e - (text[last] == '.' ? last : last + 1));
  return with_short_exponent(text);
}

}  // namespace

std::string double_text(double value) { return digits_text(value, 18); }

std::string float_text(double value) { return digits_text(static_cast<float>(value), 8); }

std::string mask_text(double value) {
  if (!(value > -0x1p31 && value < 0x1p53)) return double_text(value);
  if (value < 0) return fmt::format("${:x}", static_cast<std::uint32_t>(static_cast<std::int32_t>(value)));
  return fmt::format("${:x}", static_cast<std::uint64_t>(value));
}

std::string address_text(double value) {
  DecodedAddress address;
  if (!decode_address(value, address)) return double_text(value);
  const bool symbol = bytecode::element_info(address.element.id).type == ElementType::kSymbol;
  const std::string name = element_text(address.element) + (symbol ? "" : ".a");
  return address.offset == 0 ? name : fmt::format("{}+${:x}", name, address.offset);
}

std::string value_text(ElementType type, double value) {
  switch (type) {
    case ElementType::kFloat: return float_text(value);
    case ElementType::kMask: return mask_text(value);
    case ElementType::kAddress:
    case ElementType::kSymbol:
    case ElementType::kStructure: return address_text(value);
    default: return double_text(value);
  }
}

}  // namespace pmac::runtime
