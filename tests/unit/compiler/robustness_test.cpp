// Damaged programs: every result is either a valid module or an error message. The generator is seeded and the seed is printed.
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

#include "compiler/compiler.h"

using namespace pmac;

namespace {

std::vector<std::string> example_programs() {
  std::vector<std::string> texts;
  for (const char* folder : {"/programs", "/tests/golden/ir", "/tests/golden/errors", "/tests/golden/lines", "/tests/golden/flow", "/tests/golden/motion", "/tests/golden/rotary"}) {
    for (const auto& entry : std::filesystem::directory_iterator(std::string(PMAC_SOURCE_DIR) + folder)) {
      if (!entry.is_regular_file() || entry.path().extension() == ".expect" || entry.path().extension() == ".md") continue;
      std::ifstream stream(entry.path(), std::ios::binary);
      texts.emplace_back(std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>());
    }
  }
  return texts;
}

/// Flips, inserts, removes or repeats a few bytes.
std::string damaged(std::string text, std::mt19937& random) {
  const auto below = [&](std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n ? n - 1 : 0)(random); };
  constexpr std::string_view kPieces[] = {"(", ")", "{", "}", "open ", "close", "\n", ";", "=", "==", "..", "#", "&1", "->", "$", "\"", "/*", "*/", "if ", "else ", "[", "]", ".", "9e999", "\xff", "#define ", "while", "local "};
  for (std::size_t edits = 1 + below(6); edits > 0 && !text.empty(); --edits) {
    const std::size_t at = below(text.size());
    switch (below(5)) {
      case 0: text[at] = static_cast<char>(below(256)); break;
      case 1: text.erase(at, 1 + below(10)); break;
      case 2: text.insert(at, kPieces[below(std::size(kPieces))]); break;
      case 3: text.insert(at, text.substr(below(text.size()), below(40))); break;
      default: text.resize(at); break;
    }
  }
  return text;
}

void must_end_well(const std::string& text) {
  compiler::Session session;
  const auto module = session.compile({{"fuzz.pmc", text}});
  const bool told = session.diagnostics().has_errors();
  if (module.has_value() == told) {
    INFO(text);
    REQUIRE(module.has_value() != told);
  }
  compiler::Session online;
  online.compile_online(std::string_view(text).substr(0, 80), "-e");
}

}  // namespace

TEST_CASE("damaged programs compile or are refused with a message", "[robustness]") {
  constexpr unsigned kSeed = 20240611;
  CAPTURE(kSeed);
  std::mt19937 random(kSeed);
  const std::vector<std::string> texts = example_programs();
  REQUIRE_FALSE(texts.empty());
  for (int round = 0; round < 1500; ++round) {
    const std::string text = damaged(texts[random() % texts.size()], random);
    CAPTURE(round);
    must_end_well(text);
  }
}

TEST_CASE("random bytes compile or are refused with a message", "[robustness]") {
  constexpr unsigned kSeed = 7;
  CAPTURE(kSeed);
  std::mt19937 random(kSeed);
  for (int round = 0; round < 200; ++round) {
    std::string text(random() % 400, '\0');
    for (char& c : text) c = static_cast<char>(random() % 256);
    must_end_well(text);
  }
}
