#include "compiler/bytecode/format_text.h"

#include <algorithm>

namespace pmac::bytecode {
namespace {

constexpr int kMostWidth = 1000;

bool is_one_of(char c, std::string_view letters) { return letters.find(c) != std::string_view::npos; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Reads one conversion; empty, or what is wrong with it.
class ConversionReader {
 public:
  ConversionReader(std::string_view text, std::size_t begin) : text_(text), at_(begin + 1) { conversion.begin = begin; }

  std::string read() {
    while (is_one_of(peek(), "-+ #0")) take();
    if (!read_number()) return "the width of a conversion is at most 1000";
    if (peek() == '.') {
      take();
      if (!read_number()) return "the precision of a conversion is at most 1000";
    }
    if (peek() == '*') return "a width or precision is a number, not *";
    while (is_one_of(peek(), "lhqLjzt")) ++at_;
    return read_letter();
  }

  Conversion conversion;

 private:
  char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }
  void take() { conversion.flags_and_width += text_[at_++]; }

  bool read_number() {
    int value = 0;
    while (is_digit(peek()) && value <= kMostWidth) {
      value = 10 * value + (peek() - '0');
      take();
    }
    return value <= kMostWidth;
  }

  std::string read_letter() {
    const char letter = peek();
    if (is_one_of(letter, "diuxXoc")) conversion.kind = ConversionKind::kInteger;
    else if (is_one_of(letter, "eEfFgGaA")) conversion.kind = ConversionKind::kNumber;
    else if (letter == 's') conversion.kind = ConversionKind::kText;
    else if (letter != '%') return "a conversion ends with one of d i u x X o c e f g s, and %% prints %";
    conversion.letter = letter;
    conversion.end = at_ + 1;
    return {};
  }

  std::string_view text_;
  std::size_t at_;
};

}  // namespace

std::size_t FormatText::value_count() const {
  return static_cast<std::size_t>(std::count_if(conversions.begin(), conversions.end(), [](const Conversion& c) { return c.kind != ConversionKind::kPercent; }));
}

FormatText parse_format(std::string_view text) {
  FormatText format;
  for (std::size_t at = text.find('%'); at != std::string_view::npos; at = text.find('%', at)) {
    ConversionReader reader(text, at);
    format.problem = reader.read();
    format.problem_at = at;
    if (!format.problem.empty()) return format;
    at = reader.conversion.end;
    format.conversions.push_back(std::move(reader.conversion));
  }
  return format;
}

}  // namespace pmac::bytecode
