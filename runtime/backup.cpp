// backup answers saved elements, axis definitions and pointers in the form of saved configurations: loaded into a simulation with the
// factory's defaults they give the same set-up. Forms of the operand: templates of public configurations (sys., motor[0].., mdefs).
#include "runtime/backup.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <limits>

#include <fmt/format.h>

#include "compiler/bytecode/element.h"
#include "runtime/answer.h"
#include "runtime/value_text.h"

namespace pmac::runtime {
namespace {

using bytecode::ElementId;
using bytecode::ElementType;

constexpr std::int64_t kMostPlaces = 1024;  // of an element under one first index; larger tables answer what was assigned

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

/// Digits that give the value back exactly, in the element's own form where that is exact.
std::string exact_text(ElementType type, double value) {
  if (type == ElementType::kFloat && static_cast<double>(static_cast<float>(value)) != value) {
    const std::string text = float_text(value);
    return std::strtod(text.c_str(), nullptr) == value ? text : double_text(value);
  }
  if (type == ElementType::kMask && !(value >= 0 && value < 0x1p53 && value == static_cast<double>(static_cast<std::uint64_t>(value)))) return double_text(value);
  return value_text(type, value);
}

void answer_element(Machine::State& s, const ElementAddress& address, double value) {
  s.answer(fmt::format("{}={}", element_text(address), exact_text(element_info(address.id).type, value)));
}

void answer_axes(Machine::State& s) {
  for (const Motor& m : s.motors)
    if (m.coord >= 0) s.answer(fmt::format("&{}#{}->{}", m.coord, m.number, axis_definition_text(s, m)));
}

void answer_pointers(Machine::State& s) {
  for (int m = 0; m < bytecode::kMCount; ++m)
    if (s.pointers.at(m).definition.kind != bytecode::PointerKind::kSelf) s.answer(fmt::format("M{}->{}", m, pointer_definition_text(s, m)));
}

/// What differs from the factory's; the addresses of the command line stay as they are.
void answer_everything(Machine::State& s, const Thread& thread) {
  for (const auto& [address, value] : s.elements.saved()) answer_element(s, address, value);
  answer_axes(s);
  answer_pointers(s);
  s.answer(fmt::format("&{}#{}", thread.coord, thread.motor));
}

/// A structure and which of its first indices: "motor[0].." is all from 0 on, "motor[3]." one, "sys." and "gate3" all.
struct Wanted { std::string structure; std::uint32_t first = 0, last = std::numeric_limits<std::uint32_t>::max(); };

std::optional<Wanted> parse(const std::string& what) {
  Wanted wanted;
  const std::size_t end = what.find_first_of("[.");
  wanted.structure = what.substr(0, end);
  if (end == std::string::npos || what[end] == '.') return what.find_first_not_of('.', std::min(end, what.size())) == std::string::npos ? std::optional(wanted) : std::nullopt;
  const std::size_t close = what.find(']', end);
  if (close == std::string::npos) return std::nullopt;
  const auto read = std::from_chars(what.data() + end + 1, what.data() + close, wanted.first);
  if (read.ec != std::errc() || read.ptr != what.data() + close) return std::nullopt;
  const std::string rest = what.substr(close + 1);
  if (rest != ".." && rest != "." && !rest.empty()) return std::nullopt;
  if (rest != "..") wanted.last = wanted.first;
  return wanted;
}

bool belongs_to(std::string_view element, const std::string& structure) {
  const std::string name = lower(std::string(element));
  return name.starts_with(structure) && name.size() > structure.size() && (name[structure.size()] == '.' || name[structure.size()] == '[');
}

/// Every place of the element under its first index, defaults too.
void answer_places(Machine::State& s, ElementId id, std::uint32_t first) {
  const auto& counts = element_info(id).index_counts;
  const auto most = [&](int i) { return static_cast<std::uint32_t>(std::max(counts[i], 1)); };
  for (std::uint32_t i = 0; i < most(1); ++i)
    for (std::uint32_t j = 0; j < most(2); ++j) answer_element(s, {id, {first, i, j}}, s.elements.get({id, {first, i, j}}));
}

bool answer_structure(Machine::State& s, const Wanted& wanted) {
  bool any = false;
  const auto assigned = s.elements.saved();
  for (int e = 0; e < static_cast<int>(ElementId::kCount); ++e) {
    const auto id = static_cast<ElementId>(e);
    const bytecode::ElementInfo& info = element_info(id);
    const bool has_value = info.type != ElementType::kStructure && info.type != ElementType::kSymbol;
    if (info.access != bytecode::ElementAccess::kSaved || !has_value || !belongs_to(info.name, wanted.structure)) continue;
    const auto count = static_cast<std::uint32_t>(std::max(info.index_counts[0], 1));
    any = any || wanted.first < count;
    const bool is_table = info.size() / count > kMostPlaces;
    for (std::uint32_t first = wanted.first; !is_table && first < count && first <= wanted.last; ++first) answer_places(s, id, first);
    for (const auto& [address, value] : assigned)
      if (is_table && address.id == id && address.index[0] >= wanted.first && address.index[0] <= wanted.last) answer_element(s, address, value);
  }
  return any;
}

}  // namespace

std::string backup(Machine::State& s, const Thread& thread, std::string what) {
  what = lower(std::move(what));
  if (what.empty()) return answer_everything(s, thread), "";
  if (what == "mdefs") return answer_pointers(s), "";
  const auto wanted = parse(what);
  if (!wanted || !answer_structure(s, *wanted))
    return fmt::format("error #21: ILLEGAL PARAMETER: backup {}; it takes a structure with saved elements (sys., motor[1]., coord[0]..), mdefs, or nothing", what);
  return {};
}

}  // namespace pmac::runtime
