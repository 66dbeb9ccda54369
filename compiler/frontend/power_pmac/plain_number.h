// Numbers of lines that are read in front of the grammar.
#pragma once

#include <array>
#include <charconv>
#include <cstddef>
#include <cstdint>

namespace pmac::compiler::power_pmac {

constexpr bool is_digit(char c) { return static_cast<unsigned char>(c - '0') < 10; }
constexpr bool is_letter(char c) { return static_cast<unsigned char>((c | 0x20) - 'a') < 26; }

/// [+-] digits [. digits], or [+-] . digits, to the nearest double. Returns the place behind, or null: what stands there is no number,
/// or has more to it for the grammar (an exponent, a second point).
inline const char* read_plain_number(const char* at, const char* end, double& value) {
  constexpr std::array<double, 23> kPowersOf10 = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                                  1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
  const bool negative = at < end && *at == '-';
  if (at < end && (*at == '-' || *at == '+')) ++at;
  const char* const begin = at;
  std::uint64_t digits = 0;
  const auto take_digits = [&] {
    for (; at < end && is_digit(*at); ++at) digits = digits * 10 + static_cast<unsigned>(*at - '0');
  };
  take_digits();
  const char* const point = at;
  std::size_t decimals = 0;
  if (at < end && *at == '.') {
    ++at;
    take_digits();
    decimals = static_cast<std::size_t>(at - point) - 1;
  }
  const auto length = static_cast<std::size_t>(at - begin);
  const bool has_digits = point > begin || decimals > 0;
  const bool goes_on = at < end && (*at == '.' || *at == '_' || (*at | 0x20) == 'e');
  if (!has_digits || goes_on) return nullptr;
  // up to 15 digits the quotient of two exact numbers is the nearest number, as from_chars gives it
  if (length <= 16 && digits < 1'000'000'000'000'000) value = static_cast<double>(digits) / kPowersOf10[decimals];
  else if (std::from_chars(begin, at, value).ec != std::errc()) return nullptr;
  if (negative) value = -value;
  return at;
}

}  // namespace pmac::compiler::power_pmac
