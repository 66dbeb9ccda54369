// Addresses: what &P100, &Table(0), &Sys.Cdata[40] and "text" are while a function, send or cmd works on them. They travel in
// registers as numbers and mean something only to the frame that made them. Layout of the number, exact in a double:
// (kind + 1) * 2^44 + end * 2^22 + first.
#pragma once

#include <cstdint>
#include <optional>

#include "compiler/bytecode/bytecode.h"

namespace pmac::runtime {

struct MemoryAddress {
  enum class Kind : std::uint8_t { kP, kQ, kM, kI, kL, kR, kC, kD, kBytes, kText, kCount };  // the variable classes come first
  Kind kind = Kind::kP;
  std::uint32_t first = 0;   // variable number, byte offset into the user buffer, or number of the text in the module
  std::uint32_t end = 0;     // the array ends before this number; 0: as far as the class or buffer reaches
  bool is_variable() const { return kind < Kind::kBytes; }
  bytecode::VariableClass variable_class() const { return static_cast<bytecode::VariableClass>(kind); }
};

double number_of(const MemoryAddress& address);
/// nullopt where the number is no address.
std::optional<MemoryAddress> address_from(double number);

}  // namespace pmac::runtime
