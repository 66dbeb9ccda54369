#include "runtime/io/pointer_table.h"

#include <fmt/format.h>

namespace pmac::runtime {

PointerTable::PointerTable() : entries_(bytecode::kMCount) {}

void PointerTable::define(int number, const bytecode::PointerDefinition& definition, const ElementAddress& element) {
  PointerEntry& entry = at(number);
  entry = {definition, 0, element};
  entry.definition.first_m = entry.definition.last_m = number;
}

std::string definition_text(const bytecode::PointerDefinition& definition, const std::string& element) {
  using bytecode::PointerKind;
  const char sign = definition.is_signed ? 's' : 'u';
  const bool whole_word = definition.start_bit == 0 && definition.width == 32;
  const std::string field = fmt::format(".{}.{}", definition.start_bit, definition.width);
  switch (definition.kind) {
    case PointerKind::kSelf: return definition.has_field ? fmt::format("*{}.{}", definition.is_signed ? 'i' : 'u', definition.width) : "*";
    case PointerKind::kIo: return fmt::format("{}.io:${:X}{}", sign, definition.address, field);
    case PointerKind::kUserInteger: return fmt::format("{}.user:{}{}", sign, definition.address, whole_word ? "" : field);
    case PointerKind::kUserFloat: return fmt::format("f.user:{}", definition.address);
    case PointerKind::kUserDouble: return fmt::format("d.user:{}", definition.address);
    case PointerKind::kElement: return definition.has_field ? element + field : element;
    case PointerKind::kCount: break;
  }
  return "?";
}

}  // namespace pmac::runtime
