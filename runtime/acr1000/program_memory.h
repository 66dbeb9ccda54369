// Where the stored program of a card is kept while it is typed: the console implements it. A card that runs files needs none.
#pragma once

#include <string>

#include "runtime/interpreter/interpreter.h"

namespace pmac::acr1000 {

class ProgramMemory {
 public:
  virtual ~ProgramMemory() = default;
  /// The stored program as it is now, compiled; nothing where it is empty.
  virtual runtime::ProgramHandle program() = 0;
  /// Its lines in order, each with CR LF.
  virtual std::string listing() = 0;
  virtual void erase() = 0;
  /// 10, 20, 30, ...: what is to be said about it, each line with CR LF.
  virtual std::string renumber() = 0;
};

}  // namespace pmac::acr1000
