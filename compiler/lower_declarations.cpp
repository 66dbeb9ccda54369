// From checked IR to the edits of pmacc -E: global, csglobal, local and ptr become #define lines; arguments and locals are defined
// behind the open line (or SUB:) and undefined before the next one and before close; a global name that they hide is restored.
#include <fmt/format.h>

#include <algorithm>

#include "compiler/preprocessed.h"

namespace pmac::compiler {
namespace {

using bytecode::SymbolKind;

char letter_of(SymbolKind kind) { return kind == SymbolKind::kGlobal ? 'P' : kind == SymbolKind::kCsGlobal ? 'Q' : 'M'; }

class DeclarationLowering {
 public:
  DeclarationLowering(const sema::NameTable& names, const source::SourceManager& sources) : names_(names), sources_(sources) {}

  LoweredStream run(const std::vector<ir::Unit>& units) {
    for (const ir::Unit& unit : units) {
      of_load(unit);
      for (const ir::Buffer& buffer : unit.buffers) of_buffer(buffer);
    }
    for (auto& [file, edits] : stream_.edits)
      std::stable_sort(edits.begin(), edits.end(), [](const Edit& a, const Edit& b) { return std::pair(a.begin, a.end) < std::pair(b.begin, b.end); });
    return std::move(stream_);
  }

 private:
  void add(const source::Span& span, Edit edit) {
    edit.begin = span.begin;
    edit.end = span.end;
    stream_.edits[span.file].push_back(std::move(edit));
  }
  void add_lines(std::int32_t file, std::uint32_t at, std::vector<std::string> lines) {
    if (!lines.empty()) add({file, at, at, -1}, {0, 0, Edit::Kind::kLines, {}, {}, std::move(lines)});
  }

  void of_load(const ir::Unit& unit) {
    std::int64_t coord = -1;
    for (const ir::StmtPtr& statement : unit.load) {
      if (const auto* address = std::get_if<ir::AddressCoord>(&statement->node)) coord = static_cast<std::int64_t>(ir::constant_value(*address->number).value_or(-1));
      if (std::holds_alternative<ir::DefineAxis>(statement->node) && coord >= 0 && begins_line(statement->span))
        add({statement->span.file, statement->span.begin, statement->span.begin, -1}, {0, 0, Edit::Kind::kInline, {}, {}, {fmt::format("&{}", coord)}});
      of_statement(*statement);
    }
  }

  bool begins_line(const source::Span& span) const {
    const std::string_view text = sources_.file(span.file).text;
    const std::size_t before = span.begin == 0 ? std::string_view::npos : text.find_last_not_of(" \t", span.begin - 1);
    return before == std::string_view::npos || text[before] == '\n';
  }

  void of_buffer(const ir::Buffer& buffer) {
    std::vector<std::string> open;  // names that are defined in the buffer, in order
    begin_routine(buffer.span, buffer.parameters, open);
    std::size_t routine = 0;
    for (std::size_t i = 0; i <= buffer.body.size(); ++i) {
      for (; routine < buffer.routines.size() && buffer.routines[routine].first == i; ++routine) {
        end_routine(buffer.routines[routine].span, open);
        begin_routine(buffer.routines[routine].span, buffer.routines[routine].parameters, open);
      }
      if (i < buffer.body.size()) of_statement(*buffer.body[i], &open);
    }
    end_routine(buffer.close_span, open);
  }

  /// Parameters keep their places in the open line, where calls need them; a macro of such a name is undefined before it.
  void begin_routine(const source::Span& header, const std::vector<ir::Parameter>& parameters, std::vector<std::string>& open) {
    std::vector<std::string> before, behind;
    std::int64_t number = 0;
    for (const ir::Parameter& parameter : parameters) {
      if (names_.find(parameter.name)) before.push_back("#undef " + parameter.name);
      behind.push_back(LoweredName{parameter.name, 'L', number++, false, 1}.define());
      stream_.names.insert(parameter.name);
      open.push_back(parameter.name);
    }
    add_lines(header.file, header.begin, std::move(before));
    add_lines(header.file, header.end, std::move(behind));
  }

  void end_routine(const source::Span& next, std::vector<std::string>& open) {
    std::vector<std::string> lines;
    for (const std::string& name : open) {
      lines.push_back("#undef " + name);
      const sema::Name* hidden = names_.find(name);
      if (hidden && hidden->variable_class()) lines.push_back(lowered(name, *hidden).define());
    }
    open.clear();
    add_lines(next.file, next.begin, std::move(lines));
  }

  void of_statement(const ir::Stmt& statement, std::vector<std::string>* open = nullptr) {
    if (const auto* globals = std::get_if<ir::Globals>(&statement.node)) return of_globals(*globals, statement.span);
    if (const auto* pointer = std::get_if<ir::DefinePointer>(&statement.node)) return of_pointer(*pointer);
    if (const auto* locals = std::get_if<ir::Locals>(&statement.node); locals && open) return of_locals(*locals, statement.span, *open);
    const auto of_body = [&](const ir::Body& body) { for (const ir::StmtPtr& inner : body) of_statement(*inner, open); };
    if (const auto* block = std::get_if<ir::Block>(&statement.node)) return of_body(block->body);
    if (const auto* loop = std::get_if<ir::While>(&statement.node)) return of_statement(*loop->body, open);
    if (const auto* loop = std::get_if<ir::DoWhile>(&statement.node)) return of_statement(*loop->body, open);
    if (const auto* choice = std::get_if<ir::Switch>(&statement.node)) return of_body(choice->body);
    const auto* branches = std::get_if<ir::If>(&statement.node);
    if (!branches) return;
    for (const ir::IfBranch& branch : branches->branches) of_statement(*branch.body, open);
    if (branches->otherwise) of_statement(*branches->otherwise, open);
  }

  LoweredName lowered(const std::string& name, const sema::Name& entry) const { return {name, letter_of(entry.kind), entry.number, entry.size > 0, 1}; }

  void of_globals(const ir::Globals& globals, const source::Span& span) {
    Edit edit{0, 0, Edit::Kind::kDeclaration, {}, {}, {}};
    for (const ir::GlobalDeclaration& name : globals.names) {
      const LoweredName entry{name.name, name.variable_class == ir::VariableClass::kP ? 'P' : 'Q', name.number, name.size != nullptr, 1};
      stream_.names.insert(name.name);
      if (entry.array) stream_.arrays.emplace(name.name, entry);
      edit.names.push_back(entry);
      edit.fallbacks.push_back(name.value ? ir::print(*name.value) : std::string());
    }
    add(span, std::move(edit));
  }

  void of_locals(const ir::Locals& locals, const source::Span& span, std::vector<std::string>& open) {
    Edit edit{0, 0, Edit::Kind::kDeclaration, {}, {}, {}};
    for (const ir::LocalDeclaration& name : locals.names) {
      if (names_.find(name.name)) edit.lines.push_back("#undef " + name.name);
      edit.names.push_back({name.name, 'L', name.number, name.size != nullptr, 1});
      edit.fallbacks.push_back(name.value ? ir::print(*name.value) : std::string());
      stream_.names.insert(name.name);
      open.push_back(name.name);
    }
    add(span, std::move(edit));
  }

  /// All pointers of one declaration are one edit.
  void of_pointer(const ir::DefinePointer& pointer) {
    if (!pointer.declaration.valid()) return;
    std::vector<Edit>& edits = stream_.edits[pointer.declaration.file];
    const LoweredName entry{pointer.name, 'M', pointer.definition.first_m, pointer.size > 0, pointer.definition.last_m - pointer.definition.first_m + 1};
    stream_.names.insert(pointer.name);
    if (entry.array) stream_.arrays.emplace(pointer.name, entry);
    const bool continues = !edits.empty() && edits.back().kind == Edit::Kind::kPointers && edits.back().begin == pointer.declaration.begin;
    if (!continues) add(pointer.declaration, {0, 0, Edit::Kind::kPointers, {}, {}, {}});
    stream_.edits[pointer.declaration.file].back().names.push_back(entry);
  }

  const sema::NameTable& names_;
  const source::SourceManager& sources_;
  LoweredStream stream_;
};

}  // namespace

std::string LoweredName::define() const { return array ? fmt::format("#define {}(i) {}({}+(i))", name, letter, number) : fmt::format("#define {} {}{}", name, letter, number); }
std::string LoweredName::variable() const { return fmt::format("{}{}", letter, number); }

LoweredStream lower_declarations(const std::vector<ir::Unit>& units, const sema::NameTable& names, const source::SourceManager& sources) {
  return DeclarationLowering(names, sources).run(units);
}

}  // namespace pmac::compiler
