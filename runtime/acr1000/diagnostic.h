// Ids of what can be wrong while cards run, made from the rows of diagnostic.def, and where it happened.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "compiler/bytecode/bytecode.h"

namespace pmac::acr1000 {

enum class DiagnosticId : std::uint8_t {
#define DIAGNOSTIC(Name, id, is_error, meaning) Name,
#include "runtime/acr1000/diagnostic.def"
#undef DIAGNOSTIC
};

struct DiagnosticRow { std::string_view id; bool is_error; std::string_view meaning; };
const DiagnosticRow& row_of(DiagnosticId id);

/// Place of a command: in the file, and the number of its stored line; -1: a command without a number.
struct Place {
  bytecode::SourceLine source;
  int line_number = -1;
  bool operator==(const Place&) const = default;
};

/// "line 60", "file line 12" for a command without a number, "the host" for one that stands in no file.
std::string text_of(const Place& place);

/// What is wrong, without where.
struct Finding { DiagnosticId id{}; std::string detail; };

}  // namespace pmac::acr1000
