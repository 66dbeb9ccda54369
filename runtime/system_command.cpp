// Commands of the controller itself: what it is, its answers, its buffers, saving and resetting. Source: Software Reference Manual
// p62-76. Commands that the simulation has no meaning for are refused.
#include <algorithm>
#include <charconv>
#include <sstream>

#include <fmt/format.h>

#include "compiler/bytecode/element.h"
#include "runtime/answer.h"
#include "runtime/backup.h"
#include "runtime/listing.h"

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

std::string list_buffer(const SystemCall& call) { return list(call.s, call.thread.coord, call.words); }

std::string back_up(const SystemCall& call) {
  std::string what;
  for (std::size_t i = 1; i < call.words.size(); ++i) what += call.words[i];
  return backup(call.s, call.thread, what);
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
  if (!all && !named && !call.word(1).empty()) return fmt::format("error #21: ILLEGAL PARAMETER: undefine {}; it takes all, or nothing", call.word(1));
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

// --- what it is, and what is addressed -------------------------------------------------------------------------------------------

constexpr const char* kReleaseDate = "11/22/2026";  // of the version that vers answers

/// Simulated time since the start: hours, minutes, seconds.
std::string clock_text(double time_ms) {
  const auto seconds = static_cast<std::int64_t>(time_ms / 1000);
  return fmt::format("{:02}:{:02}:{:02}", seconds / 3600, seconds / 60 % 60, seconds % 60);
}

std::string addressed(const SystemCall& call, char sign, int number) {
  return echoes_without(call.s, kNoAddressSigns) ? fmt::format("{}", number) : fmt::format("{}{}", sign, number);
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
    {"echo", echo}, {"list", list_buffer}, {"backup", back_up}, {"buffer", list_buffers}, {"size", size_of_buffers}, {"undefine", undefine},
    {"define", rotary}, {"delete", rotary},
    {"save", save}, {"fsave", save}, {"$$$", reset}, {"$$$***", reset}, {"reboot", reset},
    {"vers", [](const SystemCall& call) { return answer(call, "0.1.0"); }},
    {"type", [](const SystemCall& call) { return answer(call, "pmac-run"); }},
    {"cpu", [](const SystemCall& call) { return answer(call, "simulated"); }},
    {"cid", [](const SystemCall& call) { return answer(call, "0"); }},
    {"date", [](const SystemCall& call) { return answer(call, kReleaseDate); }},
    {"time", [](const SystemCall& call) { return answer(call, clock_text(call.s.now_ms)); }},
    {"#", [](const SystemCall& call) { return answer(call, addressed(call, '#', call.thread.motor)); }},
    {"&", [](const SystemCall& call) { return answer(call, addressed(call, '&', call.thread.coord)); }},
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
