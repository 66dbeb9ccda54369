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

enum class ElementType : std::uint8_t { kDouble, kInteger, kMask, kBit };
enum class ElementAccess : std::uint8_t { kSaved, kWork, kStatus };
enum class ElementSimulation : std::uint8_t { kActs, kStored };
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
};
const ElementInfo& element_info(ElementId id);
/// The element of a name such as "motor[].jogspeed" (indices removed, any case), or kNoElement.
ElementId find_element(std::string_view pattern);

}  // namespace pmac::bytecode
