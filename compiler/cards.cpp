// ACR1000 files: what the stages do with cards.
#include <algorithm>
#include <cctype>
#include <set>

#include <fmt/format.h>

#include "compiler/bytecode/card.h"
#include "compiler/compiler.h"
#include "compiler/ir/walk.h"
#include "compiler/session_state.h"

namespace pmac::compiler {
namespace {

std::string ending_of(const std::string& name) {
  const std::size_t dot = name.rfind('.');
  std::string ending = dot == std::string::npos ? std::string() : name.substr(dot);
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

std::vector<acr1000::File> card_files(const std::vector<InputFile>& files) {
  std::vector<acr1000::File> all;
  for (const InputFile& file : files) all.push_back({file.name, file.text});
  return all;
}

}  // namespace

std::optional<Dialect> dialect_of(const std::vector<std::string>& file_names) {
  std::size_t cards = 0, others = 0;
  for (const std::string& name : file_names) {
    const std::string ending = ending_of(name);
    if (ending == ".acr") ++cards;
    else if (ending != ".sys") ++others;
  }
  if (cards == 0) return Dialect::kPowerPmac;
  return others == 0 ? std::optional(Dialect::kAcr1000) : std::nullopt;
}

std::vector<ir::Unit> Session::State::analyse_cards(const std::vector<InputFile>& files, bool online) {
  std::vector<ir::Unit> units;
  if (online) {
    for (const InputFile& file : files) units.push_back(cards.read_line({file.name, file.text}));
    return units;
  }
  acr1000::System system = cards.read(card_files(files));
  card_symbols = std::move(system.symbols);
  return std::move(system.units);
}

namespace {

/// What the statements of a card use.
struct CardUse { std::set<std::int64_t> lines, parameters, relays; };

void note_relay(const std::vector<ir::ExprPtr>& arguments, CardUse& use) {
  if (const auto number = arguments.empty() ? std::nullopt : ir::constant_value(*arguments[0])) use.relays.insert(static_cast<std::int64_t>(*number));
}

void note(const ir::Stmt& statement, CardUse& use) {
  if (const auto* label = std::get_if<ir::Label>(&statement.node)) use.lines.insert(label->number);
  if (const auto* condition = std::get_if<ir::RelayCondition>(&statement.node))
    if (const auto number = ir::constant_value(*condition->relay)) use.relays.insert(static_cast<std::int64_t>(*number));
  const auto* action = std::get_if<ir::CardAction>(&statement.node);
  if (action && (action->verb == bytecode::CardVerb::kSetRelay || action->verb == bytecode::CardVerb::kClearRelay)) note_relay(action->arguments, use);
}

CardUse use_of(const ir::Unit& unit) {
  CardUse use;
  ir::Visitor visitor;
  visitor.statement = [&](const ir::Stmt& statement) { note(statement, use); };
  visitor.expression = [&](const ir::Expr& expr, ir::Use) {
    if (const auto* variable = std::get_if<ir::Variable>(&expr.node)) use.parameters.insert(variable->number);
  };
  for (const ir::Buffer& buffer : unit.buffers) ir::walk(buffer.body, visitor);
  ir::walk(unit.load, visitor);
  return use;
}

std::string row(std::string_view title, const std::set<std::int64_t>& numbers, std::string_view letter) {
  if (numbers.empty()) return {};
  std::string text = fmt::format("  {}", title);
  for (const std::int64_t number : numbers) text += fmt::format(" {}{}", letter, number);
  return text + "\n";
}

}  // namespace

std::string card_symbols_text(const std::vector<ir::Unit>& units, const std::vector<bytecode::Symbol>& settings) {
  std::string text;
  for (const bytecode::Symbol& symbol : settings) text += fmt::format("setting {} {}\n", symbol.name, symbol.text);
  for (const ir::Unit& unit : units) {
    const CardUse use = use_of(unit);
    text += fmt::format("card {} {}\n", unit.axis, unit.card) + row("lines", use.lines, "") + row("parameters", use.parameters, "P") + row("relays", use.relays, "");
  }
  return text;
}

std::vector<std::string> Session::renumbered(const InputFile& program) { return state_->cards.renumbered({program.name, program.text}); }

}  // namespace pmac::compiler
