// Bytes of source lines as characters. Text is UTF-8; a byte that is not part of valid UTF-8 counts as one Latin-1 character,
// as old programs have them in their comments.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace pmac::source {

struct Character { char32_t code; std::size_t bytes; };

/// The character at an offset; at < text.size().
Character character_at(std::string_view text, std::size_t at);

/// Columns of a terminal: 2 for East Asian wide characters, 0 for combining marks, else 1.
int terminal_width(char32_t code);

/// Number of UTF-16 code units of a text.
std::size_t utf16_length(std::string_view text);

/// As valid UTF-8; Latin-1 bytes become their characters.
std::string to_utf8(std::string_view text);
void append_utf8(char32_t code, std::string& out);

}  // namespace pmac::source
