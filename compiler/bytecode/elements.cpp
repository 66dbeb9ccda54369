// The data-structure elements: rows, names, and the boards that go by two names.
#include <algorithm>
#include <array>
#include <cctype>
#include <string>
#include <unordered_map>

#include "compiler/bytecode/element.h"

namespace pmac::bytecode {
namespace {

constexpr auto kElementCount = static_cast<std::size_t>(ElementId::kCount);

constexpr std::array<ElementInfo, kElementCount> kElements = {{
#define ELEMENT(Id, name, count0, count1, count2, Type, default_value, unit, Access, Simulation, meaning) \
  {name, {count0, count1, count2}, ElementType::k##Type, default_value, unit, ElementAccess::k##Access,   \
   ElementSimulation::k##Simulation, meaning},
#include "compiler/bytecode/element.def"
#undef ELEMENT
}};

constexpr ElementInfo kNoSuchElement = {
    "?", {0, 0, 0}, ElementType::kDouble, 0, "", ElementAccess::kStatus, ElementSimulation::kStored, "no such element"};

constexpr std::array<std::string_view, static_cast<std::size_t>(ElementType::kCount)> kTypeNames = {
    "double", "float", "integer", "mask", "bit", "address", "symbol", "structure"};
constexpr std::array<std::string_view, 3> kAccessNames = {"saved", "work", "status"};
constexpr std::array<std::string_view, 3> kSimulationNames = {"simulated", "stored", "not computed"};

std::string lower_case(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](unsigned char ch) { return static_cast<char>(std::tolower(ch)); });
  return result;
}

std::unordered_map<std::string, ElementId> make_element_names() {
  std::unordered_map<std::string, ElementId> names;
  for (std::size_t i = 0; i < kElementCount; ++i) names.emplace(lower_case(kElements[i].name), static_cast<ElementId>(i));
  return names;
}

/// Structure names by board name, both in lower case.
std::unordered_map<std::string, std::string> make_boards() {
  std::unordered_map<std::string, std::string> boards;
#define BOARD(name, structure) boards.emplace(lower_case(#name), lower_case(#structure));
#include "compiler/bytecode/element_alias.def"
#undef BOARD
  return boards;
}

/// powerbrick[].chan[].dac[] is gate3[].chan[].dac[].
std::string without_board(std::string name) {
  static const std::unordered_map<std::string, std::string> boards = make_boards();
  const std::size_t end = std::min(name.find_first_of(".["), name.size());
  const auto board = boards.find(name.substr(0, end));
  return board == boards.end() ? name : board->second + name.substr(end);
}

}  // namespace

const ElementInfo& element_info(ElementId id) {
  const auto index = static_cast<std::size_t>(id);
  if (index >= kElementCount) return kNoSuchElement;
  return kElements[index];
}

int ElementInfo::index_count() const {
  int count = 0;
  while (count < kMaxElementIndices && index_counts[count] > 0) ++count;
  return count;
}

std::int64_t ElementInfo::size() const {
  std::int64_t size = 1;
  for (const int count : index_counts) size *= count > 0 ? count : 1;
  return size;
}

ElementId find_element(std::string_view pattern) {
  static const std::unordered_map<std::string, ElementId> names = make_element_names();
  const auto found = names.find(without_board(lower_case(pattern)));
  return found == names.end() ? kNoElement : found->second;
}

IVariable i_variable(int number) {
  const int offset = number % 100;
  const auto motor = static_cast<std::uint32_t>(number / 100), coord = static_cast<std::uint32_t>(number / 100 - 50);
#define MOTOR_I(wanted, Element) if (motor < kMaxMotors && offset == wanted) return {ElementId::k##Element, motor};
#define COORD_I(wanted, Element) if (number >= 5000 && coord < kMaxCoords && offset == wanted) return {ElementId::k##Element, coord};
#define SYSTEM_I(wanted, Element) if (number == wanted) return {ElementId::k##Element, 0};
#include "compiler/bytecode/i_variable.def"
#undef MOTOR_I
#undef COORD_I
#undef SYSTEM_I
  return {};
}

std::string_view element_type_name(ElementType type) { return kTypeNames[static_cast<std::size_t>(type)]; }
std::string_view element_access_name(ElementAccess access) { return kAccessNames[static_cast<std::size_t>(access)]; }
std::string_view element_simulation_name(ElementSimulation simulation) { return kSimulationNames[static_cast<std::size_t>(simulation)]; }

}  // namespace pmac::bytecode
