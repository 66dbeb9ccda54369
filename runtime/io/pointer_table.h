// What every M variable stands for. Without a definition it stands for itself and behaves as a global double. Reading and
// writing through the definition is the owner's business, since elements belong to the machine: self in `value`, io and user
// kinds in IoSpace, elements with read_bit_field() and write_bit_field().
#pragma once

#include <string>
#include <vector>

#include "compiler/bytecode/bytecode.h"
#include "runtime/interpreter/interpreter.h"
#include "runtime/io/bit_field.h"

namespace pmac::runtime {

struct PointerEntry {
  bytecode::PointerDefinition definition;  // kSelf by default
  double value = 0;                        // of kSelf
  ElementAddress element;                  // of kElement
};

class PointerTable {
 public:
  PointerTable();

  /// number: 0 .. kMCount - 1.
  PointerEntry& at(int number) { return entries_[static_cast<std::size_t>(number)]; }
  const PointerEntry& at(int number) const { return entries_[static_cast<std::size_t>(number)]; }

  /// M{number}->definition; element: the address of kElement. The value of a variable that stood for itself is lost, as it
  /// is 0 when the variable becomes one of its own again.
  void define(int number, const bytecode::PointerDefinition& definition, const ElementAddress& element = {});

 private:
  std::vector<PointerEntry> entries_;
};

/// What stands behind the arrow of the definition: "*", "u.io:$A0000C.12.1", "d.user:32". element: name of the element of kElement.
std::string definition_text(const bytecode::PointerDefinition& definition, const std::string& element);

}  // namespace pmac::runtime
