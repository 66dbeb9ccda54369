// --emit=pmc: the cards of ACR1000 files as Power PMAC programs with the same path.
#include <fmt/format.h>

#include <algorithm>

#include "compiler/compiler.h"
#include "compiler/session_state.h"
#include "compiler/translate/card_trace.h"
#include "compiler/translate/path_merge.h"
#include "compiler/translate/pmc_writer.h"

namespace pmac::compiler {
namespace {

using translate::CardPath;
using translate::CardTrace;

double number_of(const std::vector<bytecode::Symbol>& symbols, const std::string& name, double fallback) {
  double value = fallback;
  for (const bytecode::Symbol& symbol : symbols)
    if (symbol.name == name) acr1000::read_number(symbol.text, value);
  return value;
}

std::vector<std::int64_t> relays_of(const std::vector<bytecode::Symbol>& symbols, const std::string& axis) {
  const std::string prefix = "card." + axis + ".BIT";
  std::vector<std::int64_t> relays;
  for (const bytecode::Symbol& symbol : symbols)
    if (symbol.name.starts_with(prefix) && symbol.text == "1") relays.push_back(std::stoll(symbol.name.substr(prefix.size())));
  return relays;
}

/// Cards whose names are no axes of the other controller get letters that are free.
std::vector<CardPath> paths_of(const std::vector<ir::Unit>& units, const std::vector<bytecode::Symbol>& symbols) {
  std::vector<CardPath> paths;
  for (const ir::Unit& unit : units) paths.push_back({bytecode::axis_index_from_name(unit.axis) >= 0 ? unit.axis : std::string(), number_of(symbols, "card." + unit.axis + ".START", 0)});
  for (CardPath& path : paths) {
    for (int axis = 6; path.axis.empty(); axis = (axis + 1) % bytecode::kAxisCount) {  // from X on
      const std::string letter(bytecode::axis_name(axis));
      if (std::none_of(paths.begin(), paths.end(), [&](const CardPath& other) { return other.axis == letter; })) path.axis = letter;
    }
  }
  return paths;
}

/// No card waits for another one: each is a coordinate system of its own.
bool all_move_alone(const std::vector<CardTrace>& traces) {
  return std::all_of(traces.begin(), traces.end(), [](const CardTrace& trace) {
    return std::all_of(trace.motions.begin(), trace.motions.end(), [](const translate::CardMotion& motion) { return motion.master_length == 0; });
  });
}

std::vector<translate::PmcSystem> systems_of(const std::vector<CardTrace>& traces, const std::vector<CardPath>& cards, const translate::PathOptions& options, source::Diagnostics& diagnostics) {
  std::vector<translate::PmcSystem> systems;
  if (traces.size() > 1 && all_move_alone(traces)) {
    for (std::size_t k = 0; k < traces.size(); ++k) {
      const int number = static_cast<int>(k) + 1;
      systems.push_back({number, number, number, {cards[k]}, translate::merge({traces[k]}, {cards[k]}, options, diagnostics)});
    }
    return systems;
  }
  systems.push_back({1, 1, 1, cards, translate::merge(traces, cards, options, diagnostics)});
  return systems;
}

}  // namespace

std::string emit_pmc(Session& session, const std::vector<InputFile>& files) {
  Session::State& state = session.state();
  const std::vector<ir::Unit> units = state.analyse(files, false);
  if (state.diagnostics.has_errors() || units.empty()) return {};
  translate::TraceRules rules;
  rules.busy_relay = static_cast<std::int64_t>(number_of(state.card_symbols, "system.BUSY", 96));
  std::vector<CardTrace> traces;
  for (const ir::Unit& unit : units) traces.push_back(translate::trace_card(unit, rules, relays_of(state.card_symbols, unit.axis), state.diagnostics));
  const std::vector<CardPath> cards = paths_of(units, state.card_symbols);
  const translate::PathOptions options{number_of(state.card_symbols, "system.VEL_UNIT", 1), number_of(state.card_symbols, "system.RAMP_UNIT", 1)};
  const std::vector<translate::PmcSystem> systems = state.diagnostics.has_errors() ? std::vector<translate::PmcSystem>() : systems_of(traces, cards, options, state.diagnostics);
  std::string origin;
  for (const InputFile& file : files) origin += (origin.empty() ? "" : ", ") + file.name;
  return state.diagnostics.has_errors() ? std::string() : translate::write_pmc(systems, origin, state.diagnostics);
}

}  // namespace pmac::compiler
