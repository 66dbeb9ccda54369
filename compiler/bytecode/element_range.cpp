#include "compiler/bytecode/element_range.h"

#include <limits>

namespace pmac::bytecode {

ElementRange element_range(ElementId id) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  switch (id) {
#define RANGE(Id, least, most) \
  case ElementId::k##Id: return {least, most};
#include "compiler/bytecode/element_range.def"
#undef RANGE
    default: break;
  }
  if (element_info(id).type == ElementType::kBit) return {0, 1};
  return {-kNone, kNone};
}

}  // namespace pmac::bytecode
