// --emit=symbols: every name with its class, number and size, in the order of the vendor's symbol files: macros and variables as
// they appear in the load stream, then the buffers with their arguments, locals and SUB: routines. A macro that stands for one
// variable (#define Ready M4024) is listed as that variable, as the vendor's files do.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>

#include "compiler/compiler.h"
#include "compiler/session_state.h"

namespace pmac::compiler {
namespace {

using bytecode::ProgramKind;
using bytecode::SymbolKind;

/// Where a place stands in the load stream: offsets and files from the file of the command line down to the included one.
std::vector<std::uint32_t> load_position(const source::SourceManager& sources, source::Span span) {
  std::vector<std::uint32_t> position;
  for (; span.valid(); span = sources.file(span.file).included_from) {
    position.push_back(span.begin);
    position.push_back(static_cast<std::uint32_t>(span.file));
  }
  std::reverse(position.begin(), position.end());
  return position;
}

struct Row { std::vector<std::uint32_t> position; std::string text; };

std::string size_suffix(std::int64_t size) { return size > 0 ? fmt::format(" size {}", size) : std::string(); }

/// P, Q or M and the digits behind it where the text is nothing else.
std::optional<std::string> variable_of(std::string_view text) {
  if (text.size() < 2 || text.find_first_not_of("0123456789", 1) != std::string_view::npos) return std::nullopt;
  switch (text[0]) {
    case 'P': case 'p': return fmt::format("global {{}} P{}", text.substr(1));
    case 'Q': case 'q': return fmt::format("csglobal {{}} Q{}", text.substr(1));
    case 'M': case 'm': return fmt::format("ptr {{}} M{}", text.substr(1));
    default: return std::nullopt;
  }
}

std::string macro_row(const power_pmac::MacroDefinition& macro) {
  const std::string prefix = macro.active ? "" : "inactive ";
  const auto variable = macro.parameters.empty() ? variable_of(macro.text) : std::nullopt;
  if (variable) return prefix + fmt::format(fmt::runtime(*variable), macro.name) + "\n";
  return fmt::format("{}macro {}{} {}\n", prefix, macro.name, macro.parameters, macro.text);
}

std::optional<std::string> variable_row(const std::string& name, const sema::Name& entry) {
  switch (entry.kind) {
    case SymbolKind::kGlobal: return fmt::format("global {} P{}{}\n", name, entry.number, size_suffix(entry.size));
    case SymbolKind::kCsGlobal: return fmt::format("csglobal {} Q{}{}\n", name, entry.number, size_suffix(entry.size));
    case SymbolKind::kPointer: return fmt::format("ptr {} M{}{}\n", name, entry.number, size_suffix(entry.size));
    default: return std::nullopt;
  }
}

/// Rows of the local declarations in a statement and below it.
class LocalRows {
 public:
  void of_parameters(const std::vector<ir::Parameter>& parameters) {
    int number = 0;
    for (const ir::Parameter& parameter : parameters) text += fmt::format("  argument {}{} L{}\n", parameter.by_reference ? "&" : "", parameter.name, number++);
  }
  void of_body(const ir::Body& body) {
    for (const ir::StmtPtr& statement : body) of_statement(*statement);
  }
  void of_statement(const ir::Stmt& statement) {
    if (const auto* locals = std::get_if<ir::Locals>(&statement.node)) return of_locals(*locals);
    if (const auto* block = std::get_if<ir::Block>(&statement.node)) return of_body(block->body);
    if (const auto* loop = std::get_if<ir::While>(&statement.node)) return of_statement(*loop->body);
    if (const auto* loop = std::get_if<ir::DoWhile>(&statement.node)) return of_statement(*loop->body);
    if (const auto* choice = std::get_if<ir::Switch>(&statement.node)) return of_body(choice->body);
    const auto* branches = std::get_if<ir::If>(&statement.node);
    if (!branches) return;
    for (const ir::IfBranch& branch : branches->branches) of_statement(*branch.body);
    if (branches->otherwise) of_statement(*branches->otherwise);
  }
  std::string text;

 private:
  void of_locals(const ir::Locals& locals) {
    for (const ir::LocalDeclaration& local : locals.names) {
      const auto size = local.size ? ir::constant_value(*local.size) : std::nullopt;
      text += fmt::format("  local {} L{}{}\n", local.name, local.number, size_suffix(size ? static_cast<std::int64_t>(*size) : 0));
    }
  }
};

std::string buffer_rows(const ir::Buffer& buffer) {
  LocalRows rows;
  rows.of_parameters(buffer.parameters);
  std::size_t routine = 0;
  for (std::size_t i = 0; i <= buffer.body.size(); ++i) {
    for (; routine < buffer.routines.size() && buffer.routines[routine].first == i; ++routine) {
      rows.text += fmt::format("  sub {} N{}\n", buffer.routines[routine].name, buffer.routines[routine].label);
      rows.of_parameters(buffer.routines[routine].parameters);
    }
    if (i < buffer.body.size()) rows.of_statement(*buffer.body[i]);
  }
  return rows.text;
}

/// The declared name of a buffer, or the macro that its number came from.
std::string buffer_name(const ir::Buffer& buffer, const source::SourceManager& sources) {
  if (!buffer.name.empty()) return buffer.name + " ";
  if (buffer.name_span.expansion < 0) return {};
  return std::string(sources.text(buffer.name_span)) + " ";
}

}  // namespace

std::string emit_symbols(Session& session, const std::vector<InputFile>& files) {
  Session::State& state = session.state();
  const std::vector<ir::Unit> units = state.analyse(files, false);
  if (state.options.dialect == Dialect::kAcr1000) return card_symbols_text(units, state.card_symbols);
  std::vector<Row> rows;
  for (const power_pmac::MacroDefinition& macro : state.frontend.macro_definitions()) rows.push_back({load_position(state.sources, macro.span), macro_row(macro)});
  for (const auto& [name, entry] : state.project.names.all())
    if (auto row = variable_row(name, entry)) rows.push_back({load_position(state.sources, entry.span), std::move(*row)});
  std::stable_sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) { return a.position < b.position; });
  std::string out;
  for (const Row& row : rows) out += row.text;
  for (const ir::Unit& unit : units)
    for (const ir::Buffer& buffer : unit.buffers)
      out += fmt::format("{} {}{}\n{}", bytecode::program_kind_name(buffer.kind), buffer_name(buffer, state.sources), buffer.number, buffer_rows(buffer));
  return out;
}

}  // namespace pmac::compiler
