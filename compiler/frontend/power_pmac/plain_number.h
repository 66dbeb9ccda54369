// Numbers of lines that are read in front of the grammar.
#pragma once

#include <array>
#include <bit>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace pmac::compiler::power_pmac {

constexpr bool is_digit(char c) { return static_cast<unsigned char>(c - '0') < 10; }
constexpr bool is_letter(char c) { return static_cast<unsigned char>((c | 0x20) - 'a') < 26; }

/// The digits at `at`, where eight characters can be read: how many there are, up to eight, and the number that up to seven of them make.
struct FewDigits { std::size_t count; std::uint64_t value; };
inline FewDigits read_few_digits(const char* at) {
  constexpr std::uint64_t kEach = 0x0101010101010101;
  std::uint64_t characters = 0;
  std::memcpy(&characters, at, sizeof characters);
  const std::uint64_t values = characters ^ (kEach * '0');                                      // 0 .. 9 in each byte that is a digit
  const std::uint64_t others = ((values + kEach * (0x80 - 10)) | values) & (kEach * 0x80);      // a carry from a byte tells of the bytes behind a first other one only
  if (others == 0) return {8, 0};
  const auto count = static_cast<std::size_t>(std::countr_zero(others)) / 8;
  if (count == 0) return {0, 0};
  std::uint64_t value = values << (64 - 8 * count);                                             // zeros in front, and nothing behind
  value = (value * 10 + (value >> 8)) & 0x00ff00ff00ff00ff;                                     // pairs
  value = (value * 100 + (value >> 16)) & 0x0000ffff0000ffff;
  return {count, (value * 10000 + (value >> 32)) & 0xffffffff};
}

/// The most frequent form of read_plain_number(): up to seven digits, a point, up to seven digits. Null: another one.
inline const char* read_short_number(const char* at, const char* end, double& value) {
  constexpr std::array<double, 8> kPowersOf10 = {1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7};
  constexpr std::array<std::uint64_t, 8> kWholePowersOf10 = {1, 10, 100, 1000, 10'000, 100'000, 1'000'000, 10'000'000};
  if (std::endian::native != std::endian::little || end - at < 18) return nullptr;
  const bool negative = *at == '-';
  at += negative;
  const FewDigits whole = read_few_digits(at);
  if (whole.count == 0 || whole.count > 7 || at[whole.count] != '.') return nullptr;
  at += whole.count + 1;
  const FewDigits part = read_few_digits(at);
  if (part.count > 7) return nullptr;
  at += part.count;
  if (*at == '.' || *at == '_' || (*at | 0x20) == 'e') return nullptr;
  value = static_cast<double>(whole.value * kWholePowersOf10[part.count] + part.value) / kPowersOf10[part.count];
  if (negative) value = -value;
  return at;
}

/// [+-] digits [. digits], or [+-] . digits, to the nearest double. Returns the place behind, or null: what stands there is no number,
/// or has more to it for the grammar (an exponent, a second point).
inline const char* read_plain_number(const char* at, const char* end, double& value) {
  constexpr std::array<double, 23> kPowersOf10 = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                                  1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
  if (const char* behind = read_short_number(at, end, value)) return behind;
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
