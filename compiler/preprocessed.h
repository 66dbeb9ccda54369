// What pmacc -E changes in the text of a load stream: where declarations stand and what they become; private to this folder.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "compiler/ir/ir.h"
#include "compiler/sema/names.h"

namespace pmac::compiler {

/// A name and the variable behind it.
struct LoweredName {
  std::string name;
  char letter = 'P';
  std::int64_t number = 0;
  bool array = false;
  std::int64_t pointers = 1;       // how many a ptr declaration of an array defines
  std::string define() const;      // #define Name P8192, #define Name(i) P(8192+(i))
  std::string variable() const;    // P8192
};

/// A change of the text at bytes [begin, end) of a file; nothing is replaced where they are equal.
struct Edit {
  enum class Kind : std::uint8_t { kDeclaration, kPointers, kLines, kInline };
  std::uint32_t begin = 0, end = 0;
  Kind kind = Kind::kLines;
  std::vector<LoweredName> names;        // of kDeclaration and kPointers, in order
  std::vector<std::string> fallbacks;    // of kDeclaration: initialisers as the compiler understood them, empty: none
  std::vector<std::string> lines;        // of kLines; of kInline: one, put before what follows on the line
};

/// Edits by file, ascending by begin.
using Edits = std::map<std::int32_t, std::vector<Edit>>;

struct LoweredStream {
  Edits edits;
  std::set<std::string, std::less<>> names;                          // that are macros in the result
  std::map<std::string, LoweredName> arrays;            // array names that mean the same everywhere
};

/// Where the declarations of checked units stand, and what becomes of them.
LoweredStream lower_declarations(const std::vector<ir::Unit>& units, const sema::NameTable& names, const source::SourceManager& sources);

}  // namespace pmac::compiler
