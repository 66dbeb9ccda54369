// The stages of the compiler, one after the other.
#include <fmt/format.h>

#include <stdexcept>

#include "compiler/codegen/codegen.h"
#include "compiler/compiler.h"
#include "compiler/frontend/power_pmac/frontend.h"
#include "compiler/ir/ir.h"
#include "compiler/sema/lint/lint.h"
#include "compiler/sema/sema.h"
#include "compiler/session_state.h"

namespace pmac::compiler {
namespace {

/// The number and text that the controller answers a refused on-line command with, by the code of our diagnostic.
std::string_view controller_error(std::string_view code) {
  struct Row { std::string_view prefix, text; };
  constexpr Row kRows[] = {
      {"PM3002", "error #25: INVALID NUMBER"},     {"PM3005", "error #26: INVALID RANGE"},      {"PM3009", "error #23: OUT OF RANGE NUMBER"},
      {"PM3045", "error #23: OUT OF RANGE NUMBER"}, {"PM3050", "error #23: OUT OF RANGE NUMBER"}, {"PM3031", "error #35: INVALID LABEL"},
      {"PM3028", "error #35: INVALID LABEL"},       {"PM3004", "error #21: ILLEGAL PARAMETER"},   {"PM3012", "error #21: ILLEGAL PARAMETER"},
      {"PM3013", "error #21: ILLEGAL PARAMETER"},   {"PM2", "error #20: ILLEGAL CMD"},            {"PM5", "error #20: ILLEGAL CMD"},
      {"PM", "error #31: COMPILE ERR"}};
  for (const Row& row : kRows)
    if (code.starts_with(row.prefix)) return row.text;
  return "error #20: ILLEGAL CMD";
}

/// Text outside of buffers that is no command is #20 to the controller, whatever we call it.
std::string_view online_error(const source::Diagnostic& diagnostic, bool in_buffer) {
  const bool unknown_name = diagnostic.code == "PM3054" || diagnostic.code == "PM3053";
  return unknown_name && !in_buffer ? "error #20: ILLEGAL CMD" : controller_error(diagnostic.code);
}

}  // namespace

Session::Session(Options options) : state_(std::make_unique<State>(std::move(options))) {}
Session::~Session() = default;
Session::Session(Session&&) noexcept = default;

std::vector<ir::Unit> Session::State::analyse(std::vector<InputFile> files, bool online) {
  if (options.dialect == Dialect::kAcr1000) return analyse_cards(files, online);
  const auto first_file = static_cast<std::int32_t>(sources.file_count());
  std::vector<ir::Unit> units;
  for (InputFile& file : files) units.push_back(frontend.read(file.name, std::move(file.text)));
  for (const std::string& name : frontend.known_names()) project.lexed_names.insert(name);
  for (const ir::Unit& unit : units) sema::reserve_numbers(unit, project);
  for (ir::Unit& unit : units) sema::declare(unit, project, diagnostics);
  const sema::Settings settings{online};
  for (ir::Unit& unit : units) sema::check(unit, project, settings, diagnostics);
  if (!online) sema::check_served_axes(units, project, diagnostics);
  for (const ir::Unit& unit : units) {
    if (unit.clear_all.valid() && has_programs) diagnostics.warning("PM5002", unit.clear_all, "clear all buffers empties the programs of this file; those that were loaded before it stay");
    has_programs = has_programs || !unit.buffers.empty();
  }
  if (!online && !diagnostics.has_errors()) sema::lint(units, project, diagnostics);
  if (!online) warning_control.report_comments(first_file, !diagnostics.has_errors(), diagnostics);
  return units;
}

std::optional<bytecode::Module> Session::State::generate(const std::vector<ir::Unit>& units) {
  if (diagnostics.has_errors()) return std::nullopt;
  bytecode::Module module = codegen::generate(units, project.names, sources, diagnostics);
  if (diagnostics.has_errors()) return std::nullopt;
  module.symbols.insert(module.symbols.end(), card_symbols.begin(), card_symbols.end());
  if (const std::string problem = bytecode::verify(module); !problem.empty()) throw std::logic_error("the compiler made a module that is not valid: " + problem);
  return module;
}

std::optional<bytecode::Module> Session::compile(std::vector<InputFile> files) {
  return state_->generate(state_->analyse(std::move(files), false));
}

std::optional<bytecode::Module> Session::compile_online(std::string_view text, std::string_view name) {
  std::vector<source::Diagnostic> earlier = state_->diagnostics.take();
  std::optional<bytecode::Module> module = state_->generate(state_->analyse({{std::string(name), std::string(text)}}, true));
  const bool in_buffer = text.find("open") != std::string_view::npos;
  std::vector<source::Diagnostic> found = state_->diagnostics.take();
  for (source::Diagnostic& diagnostic : earlier) state_->diagnostics.report(std::move(diagnostic));
  for (source::Diagnostic& diagnostic : found) {
    if (diagnostic.severity == source::Severity::kError && state_->options.dialect == Dialect::kPowerPmac) diagnostic.message = fmt::format("{}: {}", online_error(diagnostic, in_buffer), diagnostic.message);
    state_->diagnostics.report(std::move(diagnostic));
  }
  return module;
}

void Session::adopt(const bytecode::Module& module) {
  for (const bytecode::Symbol& symbol : module.symbols) {
    state_->project.names.adopt(symbol);
    if (symbol.kind == bytecode::SymbolKind::kMacro) state_->frontend.define(symbol.name, symbol.text);
    else state_->frontend.know_name(symbol.name);
    if (symbol.kind == bytecode::SymbolKind::kProg) state_->frontend.know_program(symbol.name);
  }
  state_->has_programs = state_->has_programs || module.programs.size() > module.load_order.size();
}

source::Diagnostics& Session::diagnostics() { return state_->diagnostics; }
const source::SourceManager& Session::sources() const { return state_->sources; }
source::SourceManager& Session::sources() { return state_->sources; }

void Session::set_variable_starts(const VariableStarts& starts) { state_->project.names.set_starts(starts.p, starts.q, starts.m); }

}  // namespace pmac::compiler
