// The data-structure elements, made from the rows of element.def.
#pragma once

#include "compiler/bytecode/bytecode.h"

namespace pmac::bytecode {

enum class ElementId : std::uint16_t {
#define ELEMENT(Id, name, count0, count1, count2, Type, default_value, unit, Access, Simulation, meaning) k##Id,
#include "compiler/bytecode/element.def"
#undef ELEMENT
  kCount
};

enum class ElementType : std::uint8_t { kDouble, kFloat, kInteger, kMask, kBit, kAddress, kSymbol, kStructure, kCount };
enum class ElementAccess : std::uint8_t { kSaved, kWork, kStatus };
enum class ElementSimulation : std::uint8_t { kActs, kStored, kUnknown };
struct ElementInfo {
  std::string_view name;                 // "Motor[].JogSpeed"
  int index_counts[kMaxElementIndices];  // 0: no such index
  ElementType type;
  double default_value;
  std::string_view unit;
  ElementAccess access;
  ElementSimulation simulation;
  std::string_view meaning;
  int index_count() const;               // how many indices the name has
  /// How many values there are, over all indices.
  std::int64_t size() const;
};
const ElementInfo& element_info(ElementId id);
/// The element of a name such as "motor[].jogspeed" (indices removed, any case), or kNoElement. Names of boards that are another
/// name for a structure (PowerBrick[], Acc24E3[]) are understood.
ElementId find_element(std::string_view pattern);
/// The saved element that an I variable is another name for, and its first index; kNoElement for a plain variable.
struct IVariable { ElementId id = kNoElement; std::uint32_t index = 0; };
IVariable i_variable(int number);
std::string_view element_type_name(ElementType type);
std::string_view element_access_name(ElementAccess access);
std::string_view element_simulation_name(ElementSimulation simulation);

// Addresses as numbers, exact in a double: (element + 1) * 2^40 + place * 2^16 + byte offset, where place counts the indices of
// the element, the last one fastest.
inline constexpr double kAddressOfElement = 0x1p40, kAddressOfPlace = 0x1p16;
constexpr double address_of(ElementId id, std::uint64_t place = 0) {
  return (static_cast<double>(id) + 1) * kAddressOfElement + static_cast<double>(place) * kAddressOfPlace;
}
/// Where the shared memory begins: what address elements hold as long as they point at nothing.
inline constexpr double kPushm = address_of(ElementId::kSysPushm);

}  // namespace pmac::bytecode
