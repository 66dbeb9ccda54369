#include "compiler/frontend/acr1000/renumber.h"

#include <fmt/format.h>

#include "compiler/frontend/acr1000/lowering.h"
#include "compiler/frontend/acr1000/tokens.h"

namespace pmac::compiler::acr1000 {
namespace {

using Parser = grammar::Acr1000Parser;

constexpr std::int64_t kStep = 10;

bool is_target(const std::vector<Token>& tokens, std::size_t at) {
  if (at == 0 || tokens[at].type != Parser::NUMBER) return false;
  const std::size_t before = tokens[at - 1].type;
  return before == Parser::GOT || before == Parser::GSB || before == Parser::THEN;
}

/// The text of a line from its first word behind the number on, with new targets.
std::string rewritten(const source::SourceManager& sources, const source::Span& line, const std::map<std::int64_t, std::int64_t>& numbers, source::Diagnostics& diagnostics) {
  std::vector<Token> tokens;
  lex_line(sources, line, tokens, diagnostics);
  std::string text;
  std::uint32_t done = tokens.size() > 1 ? tokens[1].span.begin : line.end;
  for (std::size_t i = 1; i < tokens.size(); ++i) {
    if (!is_target(tokens, i)) continue;
    const auto old = line_number_of(tokens[i].text);
    const auto found = old ? numbers.find(*old) : numbers.end();
    if (found == numbers.end()) {
      diagnostics.warning("ACR-W01", tokens[i].span, fmt::format("line {} is not stored; RENUMBER leaves this branch as it is", tokens[i].text));
      continue;
    }
    text += sources.text({line.file, done, tokens[i].span.begin, -1});
    text += std::to_string(found->second);
    done = tokens[i].span.end;
  }
  text += sources.text({line.file, done, line.end, -1});
  return text;
}

}  // namespace

std::vector<std::string> renumber(const source::SourceManager& sources, const StoredLines& lines, const source::Span& span, source::Diagnostics& diagnostics) {
  if (static_cast<std::int64_t>(lines.size()) * kStep > kMaxLineNumber) {
    diagnostics.error("ACR-E03", span, fmt::format("{} lines cannot be numbered in steps of {}: line numbers end at {}", lines.size(), kStep, kMaxLineNumber));
    return {};
  }
  std::map<std::int64_t, std::int64_t> numbers;
  for (const auto& [old, place] : lines) numbers[old] = kStep * (static_cast<std::int64_t>(numbers.size()) + 1);
  std::vector<std::string> renumbered;
  for (const auto& [old, place] : lines) renumbered.push_back(fmt::format("{} {}", numbers[old], rewritten(sources, place, numbers, diagnostics)));
  return renumbered;
}

}  // namespace pmac::compiler::acr1000
