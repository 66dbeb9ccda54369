#include "runtime/io/pointer_table.h"

namespace pmac::runtime {

PointerTable::PointerTable() : entries_(bytecode::kMCount) {}

void PointerTable::define(int number, const bytecode::PointerDefinition& definition, const ElementAddress& element) {
  PointerEntry& entry = at(number);
  entry = {definition, 0, element};
  entry.definition.first_m = entry.definition.last_m = number;
}

}  // namespace pmac::runtime
