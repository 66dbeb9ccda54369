// The simulated I/O cards and the user memory: what M variables of the io and user kinds read and write. Cards are a sparse map
// from address to 32-bit word; a word that was never written reads 0. Knows nothing of time: the caller stamps the changes.
//
// The card of the examples sits at $A00000: four words, +0 +4 +8 +C, each with 8 points in bits 8 to 15, so that bit b of the
// word r is point 8 r + (b - 8).
#pragma once

#include <string>
#include <unordered_map>

#include "compiler/bytecode/bytecode.h"
#include "runtime/io/user_memory.h"

namespace pmac::runtime {

class IoSpace {
 public:
  /// Value that an M variable of this definition has; 0 for kinds that are not in I/O or user memory.
  double read(const bytecode::PointerDefinition& definition) const;
  /// Stores through the definition: bit fields keep the other bits of the word. True if the stored bits changed.
  bool write(const bytecode::PointerDefinition& definition, double value);

  std::uint32_t word(std::uint32_t address) const;
  /// Sets a whole word, as a stimulus from outside does. True if it changed.
  bool set_word(std::uint32_t address, std::uint32_t word);

  const UserMemory& user() const { return user_; }
  UserMemory& user() { return user_; }

 private:
  std::unordered_map<std::uint32_t, std::uint32_t> words_;
  UserMemory user_;
};

/// Why an M variable cannot be defined so (outside user memory, no such bits), a sentence without full stop, or empty.
std::string refusal_of(const bytecode::PointerDefinition& definition);

}  // namespace pmac::runtime
