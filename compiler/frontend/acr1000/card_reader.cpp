#include "compiler/frontend/acr1000/card_reader.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "compiler/bytecode/card.h"

namespace pmac::compiler::acr1000 {
namespace {

using ir::CardVerb;
using Parser = grammar::Acr1000Parser;

constexpr std::size_t kMaxLowered = 4'000'000;  // stored lines of one card, counted each time a changed program is run

}  // namespace

CardReader::CardReader(source::SourceManager& sources, source::Diagnostics& diagnostics, const Settings& settings, std::int64_t card, std::string axis, bool at_once)
    : sources_(sources), diagnostics_(diagnostics), settings_(settings), at_once_(at_once) {
  unit_.card = card;
  unit_.axis = std::move(axis);
}

void CardReader::take(const source::Span& line) {
  const auto parsed = parse_line(sources_, line, diagnostics_);
  const bool numbered = !parsed->tokens.empty() && parsed->tokens[0].type == Parser::LINE_NUMBER;
  if (numbered && !line_number_of(parsed->tokens[0].text)) return void(diagnostics_.error("ACR-E03", parsed->tokens[0].span, fmt::format("line numbers are from 0 to {}", kMaxLineNumber)));
  if (!parsed->root) return;
  if (numbered) return store(line, *parsed);
  if (parsed->root->commands()) LineLowering(*parsed, settings_, diagnostics_, this).lower(parsed->root->commands(), unit_.load);
}

void CardReader::take_block(const source::Span& line, const std::string& digits) { unit_.load.push_back(ir::make_stmt(line, ir::SystemCommand{"hex " + digits})); }

/// Replaces a line of that number; a number alone deletes it. A wrong line is not stored.
void CardReader::store(const source::Span& line, const ParsedLine& parsed) {
  const std::int64_t number = *line_number_of(parsed.tokens[0].text);
  changed_ = true;
  if (!parsed.root->commands()) return void(lines_.erase(number));
  const std::size_t errors = diagnostics_.error_count();
  ir::Body checked;
  LineLowering(parsed, settings_, diagnostics_, nullptr).lower(parsed.root->commands(), checked);
  if (diagnostics_.error_count() == errors) lines_[number] = line;
}

void CardReader::lower_stored(std::int64_t number, const source::Span& line, ir::Body& body) {
  const auto parsed = parse_line(sources_, line, diagnostics_);
  if (!parsed->root || !parsed->root->commands()) return;
  body.push_back(ir::make_stmt(line, ir::Label{number}));
  LineLowering lowering(*parsed, settings_, diagnostics_, nullptr);
  lowering.is_stored = [this](std::int64_t target) { return lines_.contains(target); };
  lowering.lower(parsed->root->commands(), body);
}

/// The program as it is stored now. It ends behind its last line, from any depth of subroutines.
ir::Buffer CardReader::snapshot() {
  ir::Buffer buffer;
  buffer.kind = bytecode::ProgramKind::kProg;
  buffer.number = unit_.card;
  buffer.name = unit_.axis;
  for (const auto& [number, line] : lines_) lower_stored(number, line, buffer.body);
  if (lines_.empty()) return buffer;
  buffer.span = lines_.begin()->second;
  buffer.close_span = lines_.rbegin()->second;
  buffer.body.push_back(ir::make_stmt(buffer.close_span, ir::Stop{}));
  return buffer;
}

void CardReader::run(const source::Span& span, ir::Body& out, ir::ExprPtr first_line) {
  was_run_ = true;
  const double number = ir::constant_value(*first_line).value_or(std::numeric_limits<double>::quiet_NaN());
  const bool missing = !at_once_ && !std::isnan(number) && !lines_.contains(static_cast<std::int64_t>(number));
  if (missing) {
    diagnostics_.warning("ACR-W01", first_line->span, fmt::format("line {} is not stored; this is an error when it is taken", number));
    return out.push_back(card_action(span, CardVerb::kMissingLine, std::move(first_line)));
  }
  if (changed_ && !at_once_) {
    lowered_ += lines_.size();
    if (lowered_ > kMaxLowered) return void(diagnostics_.error("ACR-H01", span, "changed programs are run more often than one file can; divide it"));
    changed_ = false;
    out.push_back(ir::make_stmt(span, ir::OpenBuffer{unit_.buffers.size()}));
    unit_.buffers.push_back(snapshot());
  }
  out.push_back(card_action(span, CardVerb::kRun, std::move(first_line)));
}

void CardReader::list(const source::Span& span, ir::Body& out) {
  if (at_once_) return out.push_back(card_action(span, CardVerb::kList));
  std::string text;
  for (const auto& [number, line] : lines_) text += std::string(sources_.text(line)) + "\r\n";
  out.push_back(ir::make_stmt(span, ir::Send{0, std::move(text), {}}));
}

void CardReader::erase(const source::Span& span, ir::Body& out) {
  lines_.clear();
  changed_ = true;
  out.push_back(card_action(span, CardVerb::kNew));
}

/// The new lines become a text of their own, for what is said about them later.
void CardReader::renumber(const source::Span& span, ir::Body& out) {
  if (at_once_) return out.push_back(card_action(span, CardVerb::kRenumber));
  const std::vector<std::string> renumbered = acr1000::renumber(sources_, lines_, span, diagnostics_);
  if (renumbered.empty()) return;
  const std::int32_t file = sources_.add_file(sources_.file(span.file).name + " (renumbered)", fmt::format("{}\n", fmt::join(renumbered, "\n")));
  StoredLines lines;
  std::uint32_t at = 0;
  for (const std::string& line : renumbered) {
    const auto end = static_cast<std::uint32_t>(at + line.size());
    lines[10 * (static_cast<std::int64_t>(lines.size()) + 1)] = {file, at, end, -1};
    at = end + 1;
  }
  lines_ = std::move(lines);
  changed_ = true;
}

ir::Unit CardReader::finish() {
  if (!at_once_ && !was_run_ && !lines_.empty()) {
    const source::Span end = lines_.rbegin()->second;
    run(end, unit_.load, ir::make_number(std::numeric_limits<double>::quiet_NaN(), end));
  }
  return std::move(unit_);
}

}  // namespace pmac::compiler::acr1000
