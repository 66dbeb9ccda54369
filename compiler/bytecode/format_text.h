// printf formats of send, cmd and sprintf, taken apart: the compiler checks the values against them, the runtime fills them in.
// Source: the C library's printf; a width or precision that is itself a value (*) is not taken.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace pmac::bytecode {

/// What a conversion prints: nothing (%%), an integer (d i u x X o c), a number (e f g a and capitals), a text (s).
enum class ConversionKind { kPercent, kInteger, kNumber, kText };

/// One conversion. begin, end: its place in the format; flags_and_width: "-08.3" of %-08.3lf; letter: its last one.
struct Conversion {
  std::size_t begin = 0, end = 0;
  ConversionKind kind = ConversionKind::kPercent;
  std::string flags_and_width;
  char letter = '%';
};

/// problem: why the text is no format, a phrase, or empty; problem_at: where the wrong conversion begins.
struct FormatText {
  std::vector<Conversion> conversions;
  std::string problem;
  std::size_t problem_at = 0;
  std::size_t value_count() const;   // conversions that take a value
};

FormatText parse_format(std::string_view text);

}  // namespace pmac::bytecode
