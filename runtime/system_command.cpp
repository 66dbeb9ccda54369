// Commands of the controller itself: what it is, its answers, its buffers, saving and resetting. Source: Software Reference Manual
// p62-76. Commands that the simulation has no meaning for are refused.
#include <algorithm>
#include <charconv>
#include <sstream>

#include <fmt/format.h>

#include "compiler/bytecode/element.h"
#include "runtime/state.h"

namespace pmac::runtime {
namespace {

using bytecode::ProgramKind;
using Words = std::vector<std::string>;

/// A command, word by word, and who gave it. A handler answers a refusal or empty.
struct SystemCall {
  Machine::State& s;
  Thread& thread;
  Words words;
  std::string word(std::size_t i) const { return i < words.size() ? words[i] : std::string(); }
};

std::optional<std::uint32_t> number_in(const std::string& text) {
  std::uint32_t value = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || read.ec != std::errc() || read.ptr != text.data() + text.size()) return std::nullopt;
  return value;
}

std::string answer(const SystemCall& call, const std::string& text) {
  call.s.answer(text);
  return {};
}

std::string echo(const SystemCall& call) {
  if (call.words.size() == 1) return answer(call, fmt::format("{}", call.s.echo));
  const auto mode = number_in(call.word(1));
  if (!mode || *mode > 15) return "error #21: ILLEGAL PARAMETER: echo takes 0 to 15";
  call.s.echo = static_cast<int>(*mode);
  return {};
}

// --- buffers ------------------------------------------------------------------------------------------------------------------

ProgramHandle in_table(const std::map<std::uint32_t, ProgramHandle>& table, std::uint32_t number) {
  const auto found = table.find(number);
  return found == table.end() ? ProgramHandle{} : found->second;
}

ProgramHandle buffer(const SystemCall& call) {
  const std::string kind = call.word(1);
  const auto number = call.words.size() > 2 ? number_in(call.word(2)) : std::optional<std::uint32_t>(static_cast<std::uint32_t>(call.thread.coord));
  if (!number) return {};
  if (kind == "prog") return in_table(call.s.progs, *number);
  if (kind == "subprog") return in_table(call.s.subprogs, *number);
  if (kind == "plc") return in_table(call.s.plc_programs, *number);
  const bool kinematic = (kind == "forward" || kind == "inverse") && *number < call.s.coords.size();
  if (!kinematic) return {};
  const CoordSystem& coord = call.s.coord(static_cast<int>(*number));
  return kind == "forward" ? coord.forward : coord.inverse;
}

std::optional<std::string> source_line(const SystemCall& call, bytecode::SourceLine source) {
  if (!call.s.options.source_text || source.file < 0) return std::nullopt;
  return call.s.options.source_text(call.s.files[static_cast<std::size_t>(source.file)], source.line);
}

/// The lines between open and close, as far as they hold statements; without the source, its instructions.
std::string list_program(const SystemCall& call, const ProgramHandle& handle) {
  const bytecode::Program& program = *handle.program;
  int last = program.source.line;
  for (const bytecode::LineEntry& line : program.lines)
    if (line.source.file == program.source.file) last = std::max(last, line.source.line);
  bool any = false;
  for (int line = program.source.line + 1; line <= last; ++line) {
    const auto text = source_line(call, {program.source.file, line, 1});
    if (!text || *text == "close") continue;
    call.s.answer(*text);
    any = true;
  }
  if (any || program.lines.empty()) return {};
  bytecode::Module alone = *handle.module;
  alone.programs = {program};
  alone.load_order.clear();
  return answer(call, disassemble(alone));
}

/// list pc: where the program of the addressed coordinate system calculates.
std::string list_counter(const SystemCall& call) {
  const CoordSystem& coord = call.s.coord(call.thread.coord);
  if (!coord.program_active()) return "error #22: PROGRAM NOT IN BUFFER: no program is active in the addressed coordinate system";
  const bytecode::SourceLine at = coord.runner().thread.source();
  return answer(call, source_line(call, at).value_or(call.s.place(at)));
}

std::string list(const SystemCall& call) {
  if (call.word(1) == "pc") return list_counter(call);
  if (call.word(1) == "apc") return "error #20: ILLEGAL CMD: list apc is not simulated; list pc tells where the program calculates";
  const ProgramHandle handle = buffer(call);
  if (!handle) return "error #22: PROGRAM NOT IN BUFFER";
  return list_program(call, handle);
}

/// One line a buffer: kind, number, instructions.
std::string list_buffers(const SystemCall& call) {
  for (const auto* table : {&call.s.progs, &call.s.subprogs, &call.s.plc_programs})
    for (const auto& [number, handle] : *table)
      call.s.answer(fmt::format("{} {} {}", program_kind_name(handle.program->kind), number, handle.program->code.size()));
  return {};
}

std::string size_of_buffers(const SystemCall& call) {
  std::size_t instructions = 0;
  for (const auto* table : {&call.s.progs, &call.s.subprogs, &call.s.plc_programs})
    for (const auto& [number, handle] : *table) instructions += handle.program->code.size();
  return answer(call, fmt::format("{}", instructions * sizeof(bytecode::Instruction)));
}

/// define rotary and delete rotary. A rotary buffer is always there and has room for every line; deleting forgets its lines.
std::string rotary(const SystemCall& call) {
  const bool named = call.words.back().starts_with('&');
  const auto number = named ? number_in(call.words.back().substr(1)) : std::optional<std::uint32_t>(static_cast<std::uint32_t>(call.thread.coord));
  if (!number || *number >= call.s.coords.size()) return "error #23: OUT OF RANGE NUMBER: which coordinate system's rotary buffer";
  CoordSystem& coord = call.s.coord(static_cast<int>(*number));
  if (call.word(0) == "define") return {};
  if (coord.program_active()) return "error #38: PROGRAM RUNNING";
  coord.clear_rotary();
  return {};
}

// --- motors ---------------------------------------------------------------------------------------------------------------------

/// undefine: the addressed coordinate system, or the one that is named; undefine all.
std::string undefine(const SystemCall& call) {
  const bool all = call.word(1) == "all" || call.word(1) == "&*";
  const auto named = call.word(1).starts_with('&') ? number_in(call.word(1).substr(1)) : std::nullopt;
  const int wanted = named ? static_cast<int>(*named) : call.thread.coord;
  for (Motor& m : call.s.motors) {
    if (m.coord < 0 || (!all && m.coord != wanted)) continue;
    bytecode::AxisDefinition null;
    null.kind = bytecode::AxisDefinitionKind::kNull;
    if (const std::string refusal = call.s.coord(m.coord).define(null, m.number); !refusal.empty()) return refusal;
    m.shares_with = -1;
  }
  return {};
}

// --- saving and resetting -----------------------------------------------------------------------------------------------------------

std::string save(const SystemCall& call) {
  call.s.save();
  return {};
}

std::string reset(const SystemCall& call) {
  call.s.request_reset(call.word(0) == "$$$***");
  return {};
}

struct Row { std::string_view word; std::string (*handler)(const SystemCall&); };
constexpr Row kRows[] = {
    {"echo", echo}, {"list", list}, {"buffer", list_buffers}, {"size", size_of_buffers}, {"undefine", undefine},
    {"define", rotary}, {"delete", rotary},
    {"save", save}, {"fsave", save}, {"$$$", reset}, {"$$$***", reset}, {"reboot", reset},
    {"vers", [](const SystemCall& call) { return answer(call, "0.1.0"); }},
    {"type", [](const SystemCall& call) { return answer(call, "pmac-run"); }},
    {"cpu", [](const SystemCall& call) { return answer(call, "simulated"); }},
    {"cid", [](const SystemCall& call) { return answer(call, "0"); }},
    {"#", [](const SystemCall& call) { return answer(call, fmt::format("#{}", call.thread.motor)); }},
    {"&", [](const SystemCall& call) { return answer(call, fmt::format("&{}", call.thread.coord)); }},
};

}  // namespace

std::string execute_system_command(Machine::State& s, Thread& thread, std::string_view text) {
  std::istringstream stream{std::string(text)};
  SystemCall call{s, thread, {}};
  for (std::string word; stream >> word;) call.words.push_back(word);
  const auto* row = std::find_if(std::begin(kRows), std::end(kRows), [&](const Row& r) { return r.word == call.word(0); });
  if (row == std::end(kRows)) return fmt::format("error #20: ILLEGAL CMD: {} is not simulated", text);
  return row->handler(call);
}

}  // namespace pmac::runtime
