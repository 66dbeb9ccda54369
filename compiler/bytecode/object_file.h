// The object file (.pmx): a module as FlatBuffers, in size-prefixed chunks behind a versioned header.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "compiler/bytecode/bytecode.h"

namespace pmac::bytecode {

/// Why an object file was refused; a sentence for the user.
struct ObjectFileError { std::string message; };

/// Takes the bytes of an object file piece by piece.
using ByteSink = std::function<void(std::span<const std::uint8_t>)>;

/// Writes the module as an object file, a chunk at a time. Deterministic: equal modules give equal bytes.
void save(const Module& module, const ByteSink& sink);
/// The same as one piece.
std::vector<std::uint8_t> save(const Module& module);

/// The module of an object file. Refuses other formats, other versions, truncated and damaged files (every chunk carries
/// a checksum and is verified as FlatBuffers) and modules that verify() refuses. Never reads outside `bytes`.
std::variant<Module, ObjectFileError> load(std::span<const std::uint8_t> bytes);

/// True if the bytes begin like an object file, whole or not.
bool looks_like_object_file(std::span<const std::uint8_t> bytes);

}  // namespace pmac::bytecode
