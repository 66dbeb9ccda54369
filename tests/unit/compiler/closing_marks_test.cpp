#include "compiler/source/closing_marks.h"

#include <catch2/catch.hpp>
#include <random>
#include <string>

using pmac::source::ClosingMarks;

namespace {

/// The rule, looked up anew for every mark.
std::size_t plain_end(std::string_view text, std::size_t opening, bool line_end_can_be_taken) {
  const auto ends_line = [&](char c) { return c == '\n' || (c == '\r' && !line_end_can_be_taken); };
  for (std::size_t at = opening + 1; at < text.size() && !ends_line(text[at]); ++at) {
    if (text[at] == '"') return at + 1;
    if (text[at] != '\\') continue;
    if (!line_end_can_be_taken && at + 1 < text.size() && ends_line(text[at + 1])) break;
    ++at;
  }
  return opening + 1;
}

std::string random_text(std::mt19937& random) {
  constexpr char kCharacters[] = {'"', '"', '\\', '\\', 'a', '\n', '\r'};
  std::string text;
  for (std::size_t i = random() % 40; i > 0; --i) text += kCharacters[random() % std::size(kCharacters)];
  return text;
}

}  // namespace

TEST_CASE("closing marks: asked from beginning to end, every mark has the end that a search for it alone finds", "[source]") {
  constexpr unsigned kSeed = 20240917;
  CAPTURE(kSeed);
  std::mt19937 random(kSeed);
  for (int i = 0; i < 20'000; ++i) {
    const std::string text = random_text(random);
    for (const bool taken : {true, false}) {
      ClosingMarks marks(text, taken ? ClosingMarks::LineEnd::kCanBeTaken : ClosingMarks::LineEnd::kEndsText);
      std::size_t wrong = 0;
      for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = text[at] == '"' ? marks.end_of(at) : at + 1;
        wrong += text[at] == '"' && end != plain_end(text, at, taken);
        at = end;
      }
      if (wrong == 0) continue;
      INFO(text);
      REQUIRE(wrong == 0);
    }
  }
}

TEST_CASE("closing marks: a mark behind a backslash closes nothing, and a text ends with its line", "[source]") {
  CHECK(ClosingMarks(R"("a\"b")").end_of(0) == 6);
  CHECK(ClosingMarks("\"a\nb\"").end_of(0) == 1);
  CHECK(ClosingMarks("\"a\\\nb\"").end_of(0) == 6);
  CHECK(ClosingMarks("\"a\\\nb\"", ClosingMarks::LineEnd::kEndsText).end_of(0) == 1);
}
