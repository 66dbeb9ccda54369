// list: the source lines of buffers, and of the program that a coordinate system executes or was aborted in. Source: Software Reference
// Manual p67; how many lines list pc answers: the Turbo manuals.
#include "runtime/listing.h"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>

namespace pmac::runtime {
namespace {

using Table = std::map<std::uint32_t, ProgramHandle>;

std::optional<std::uint32_t> number_in(const std::string& text) {
  std::uint32_t value = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || read.ec != std::errc() || read.ptr != text.data() + text.size()) return std::nullopt;
  return value;
}

/// By number, or by the name that the buffer was opened with.
ProgramHandle in_table(const Table& table, const std::string& wanted) {
  if (const auto number = number_in(wanted)) {
    const auto found = table.find(*number);
    return found == table.end() ? ProgramHandle{} : found->second;
  }
  const auto named = std::find_if(table.begin(), table.end(), [&](const auto& entry) { return entry.second.program->name == wanted; });
  return named == table.end() ? ProgramHandle{} : named->second;
}

/// kind: prog, subprog, plc, forward, inverse. wanted: number or name; empty for the addressed coordinate system.
ProgramHandle buffer(Machine::State& s, int addressed_coord, const std::string& kind, const std::string& wanted) {
  if (kind == "prog") return in_table(s.progs, wanted);
  if (kind == "subprog") return in_table(s.subprogs, wanted);
  if (kind == "plc") return in_table(s.plc_programs, wanted);
  const auto number = wanted.empty() ? std::optional<std::uint32_t>(static_cast<std::uint32_t>(addressed_coord)) : number_in(wanted);
  const bool kinematic = (kind == "forward" || kind == "inverse") && number && *number < s.coords.size();
  if (!kinematic) return {};
  const CoordSystem& coord = s.coord(static_cast<int>(*number));
  return kind == "forward" ? coord.forward : coord.inverse;
}

std::optional<std::string> source_line(const Machine::State& s, bytecode::SourceLine source) {
  if (!s.options.source_text || source.file < 0) return std::nullopt;
  return s.options.source_text(s.files[static_cast<std::size_t>(source.file)], source.line);
}

/// Answers the lines of the program from one on that hold statements, as many as are wanted. False: there is no source.
bool list_lines(Machine::State& s, const bytecode::Program& program, int first, std::uint32_t most) {
  int last = program.source.line;
  for (const bytecode::LineEntry& line : program.lines)
    if (line.source.file == program.source.file) last = std::max(last, line.source.line);
  bool any = false;
  for (int line = first; line <= last && most > 0; ++line) {
    const auto text = source_line(s, {program.source.file, line, 1});
    if (!text || *text == "close") continue;
    s.answer(*text);
    any = true;
    --most;
  }
  return any;
}

/// The lines between open and close, as far as they hold statements; without the source, its instructions.
void list_program(Machine::State& s, const ProgramHandle& handle) {
  const bytecode::Program& program = *handle.program;
  if (list_lines(s, program, program.source.line + 1, 0xffffffffu) || program.lines.empty()) return;
  bytecode::Module alone = *handle.module;
  alone.programs = {program};
  alone.load_order.clear();
  s.answer(disassemble(alone));
}

/// list pc: where the program of the addressed coordinate system calculates; list apc: where it was when it was aborted, or is now.
/// One line, or with a count (pc,5) so many, or with a comma (pc,) all that follow.
std::string list_place(Machine::State& s, int addressed_coord, const std::string& what, const std::string& count) {
  const CoordSystem& coord = s.coord(addressed_coord);
  const bool wants_aborted = what == "apc";
  CoordSystem::Stand stand = coord.aborted();
  if (coord.program_active()) {
    const bool calculates = !wants_aborted && coord.runner().thread.active();
    stand = {calculates ? coord.runner().thread.program() : coord.runner().thread.top_program(), wants_aborted ? coord.executing_source(s.now_ms) : coord.line_at(s.now_ms)};
  } else if (!wants_aborted || !stand.program) {
    return fmt::format("error #22: PROGRAM NOT IN BUFFER: no program {} in coordinate system {}", wants_aborted ? "is active or was aborted" : "is active", addressed_coord);
  }
  const auto lines = count.empty() ? std::optional<std::uint32_t>(1) : count == "," ? std::optional<std::uint32_t>(0xffffffffu) : number_in(count.substr(1));
  if (!lines) return "error #21: ILLEGAL PARAMETER: list pc,{lines}";
  const bool in_program = stand.source.file == stand.program.program->source.file;
  if (in_program && list_lines(s, *stand.program.program, stand.source.line, *lines)) return {};
  s.answer(source_line(s, stand.source).value_or(s.place(stand.source)));
  return {};
}

}  // namespace

std::string list(Machine::State& s, int addressed_coord, const std::vector<std::string>& words) {
  const auto word = [&](std::size_t i) { return i < words.size() ? words[i] : std::string(); };
  if (word(1) == "pc" || word(1) == "apc") return list_place(s, addressed_coord, word(1), word(2));
  const bool numbered = word(1) == "prog" || word(1) == "subprog" || word(1) == "plc";
  if (word(1).empty() || (numbered && word(2).empty())) return "error #21: ILLEGAL PARAMETER: list takes a buffer, as in list prog 5, list plc Cooling, list forward, list pc";
  const ProgramHandle handle = buffer(s, addressed_coord, word(1), word(2));
  if (!handle) return fmt::format("error #22: PROGRAM NOT IN BUFFER: there is no {} {}", word(1), word(2).empty() ? fmt::format("of coordinate system {}", addressed_coord) : word(2));
  list_program(s, handle);
  return {};
}

}  // namespace pmac::runtime
