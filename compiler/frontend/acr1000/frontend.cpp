#include "compiler/frontend/acr1000/frontend.h"

#include <fmt/format.h>

#include "compiler/frontend/acr1000/file_reader.h"
#include "compiler/frontend/acr1000/parse.h"

namespace pmac::compiler::acr1000 {
namespace {

/// Lines that are for the host and not for a card.
bool is_host_line(std::string_view text) {
  return text.starts_with(';') || text.starts_with("SYSTEM ") || text.starts_with("AXIS ") || text.starts_with("HEX ");
}

}  // namespace

System Frontend::read(const std::vector<File>& files) {
  FileReader reader(sources_, diagnostics_, settings_);
  for (const File& file : files) reader.read(file);
  return reader.finish();
}

ir::Unit Frontend::read_line(const File& line) {
  CardReader reader(sources_, diagnostics_, settings_, 0, "X", true);
  for_each_line(sources_, sources_.add_file(line.name, line.text), [&](const source::Span& one) { reader.take(one); });
  return reader.finish();
}

std::vector<std::string> Frontend::renumbered(const File& program) {
  CardReader reader(sources_, diagnostics_, settings_, 0, "X", false);
  const std::int32_t file = sources_.add_file(program.name, program.text);
  for_each_line(sources_, file, [&](const source::Span& one) { reader.take(one); });
  return renumber(sources_, reader.lines(), {file, 0, 0, -1}, diagnostics_);
}

std::string Frontend::tokens(const File& file) {
  std::string out;
  const std::int32_t index = sources_.add_file(file.name, file.text);
  for_each_line(sources_, index, [&](const source::Span& line) {
    if (is_host_line(sources_.text(line))) return;
    std::vector<Token> tokens;
    lex_line(sources_, line, tokens, diagnostics_);
    for (const Token& token : tokens) {
      const source::LineColumn at = sources_.line_column(token.span.file, token.span.begin);
      out += fmt::format("{}:{} {} {}\n", at.line, at.column, token_type_name(token.type), token.text);
    }
  });
  return out;
}

std::string Frontend::tree(const File& file) {
  std::string out;
  const std::int32_t index = sources_.add_file(file.name, file.text);
  for_each_line(sources_, index, [&](const source::Span& line) {
    if (!is_host_line(sources_.text(line))) out += print_tree(*parse_line(sources_, line, diagnostics_));
  });
  return out;
}

}  // namespace pmac::compiler::acr1000
