#include "compiler/source/characters.h"

#include <array>
#include <utility>

namespace pmac::source {
namespace {

constexpr char32_t byte_at(std::string_view text, std::size_t at) { return static_cast<unsigned char>(text[at]); }

/// Number of bytes that a first byte announces, or 1.
std::size_t announced_length(char32_t first) {
  if (first >= 0xc2 && first <= 0xdf) return 2;
  if (first >= 0xe0 && first <= 0xef) return 3;
  return first >= 0xf0 && first <= 0xf4 ? 4 : 1;
}

bool is_well_formed(char32_t code, std::size_t bytes) {
  if (bytes == 3) return code >= 0x800 && (code < 0xd800 || code > 0xdfff);
  return bytes == 2 || (code >= 0x10000 && code <= 0x10ffff);
}

using Range = std::pair<char32_t, char32_t>;
constexpr std::array<Range, 5> kZeroWidth{{{0x300, 0x36f}, {0x200b, 0x200f}, {0x20d0, 0x20ff}, {0xfe00, 0xfe0f}, {0xfeff, 0xfeff}}};
constexpr std::array<Range, 8> kWide{{{0x1100, 0x115f}, {0x2e80, 0x303e}, {0x3041, 0xa4cf}, {0xac00, 0xd7a3}, {0xf900, 0xfaff}, {0xfe30, 0xfe6f}, {0xff00, 0xff60}, {0x1f300, 0x1faff}}};

template <std::size_t N>
bool is_in(char32_t code, const std::array<Range, N>& ranges) {
  for (const auto& [first, last] : ranges)
    if (code >= first && code <= last) return true;
  return false;
}

}  // namespace

Character character_at(std::string_view text, std::size_t at) {
  const char32_t first = byte_at(text, at);
  const std::size_t bytes = announced_length(first);
  if (bytes == 1 || at + bytes > text.size()) return {first, 1};
  char32_t code = first & (0xffu >> (bytes + 1));
  for (std::size_t i = 1; i < bytes; ++i) {
    const char32_t next = byte_at(text, at + i);
    if ((next & 0xc0) != 0x80) return {first, 1};
    code = (code << 6) | (next & 0x3f);
  }
  return is_well_formed(code, bytes) ? Character{code, bytes} : Character{first, 1};
}

int terminal_width(char32_t code) {
  if (is_in(code, kZeroWidth)) return 0;
  return is_in(code, kWide) ? 2 : 1;
}

std::size_t utf16_length(std::string_view text) {
  std::size_t units = 0;
  for (std::size_t at = 0; at < text.size();) {
    const Character c = character_at(text, at);
    units += c.code > 0xffff ? 2 : 1;
    at += c.bytes;
  }
  return units;
}

void append_utf8(char32_t code, std::string& out) {
  const auto tail = [&](int shift) { out += static_cast<char>(0x80 | ((code >> shift) & 0x3f)); };
  if (code < 0x80) {
    out += static_cast<char>(code);
  } else if (code < 0x800) {
    out += static_cast<char>(0xc0 | (code >> 6));
    tail(0);
  } else if (code < 0x10000) {
    out += static_cast<char>(0xe0 | (code >> 12));
    tail(6);
    tail(0);
  } else {
    out += static_cast<char>(0xf0 | (code >> 18));
    tail(12);
    tail(6);
    tail(0);
  }
}

std::string to_utf8(std::string_view text) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const Character c = character_at(text, at);
    append_utf8(c.code, out);
    at += c.bytes;
  }
  return out;
}

}  // namespace pmac::source
