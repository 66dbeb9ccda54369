// Fuzz target: bytes to the loader of object files. They are refused, or give a module that verify() accepts and that runs without harm.
// The bytes are tried as they are, and with the checksums of header and chunks put right, so that changes reach what lies behind those.
#include <algorithm>
#include <span>
#include <vector>

#include "compiler/bytecode/chunk.h"
#include "compiler/bytecode/object_file.h"
#include "compiler/compiler.h"
#include "runtime/tool/load.h"
#include "tests/fuzz/small_machine.h"
#include "tests/fuzz/target.h"

using namespace pmac;

namespace {

using Bytes = std::vector<std::uint8_t>;

std::size_t size_at(const Bytes& bytes, std::size_t at) {
  return bytes[at] | (std::size_t{bytes[at + 1]} << 8) | (std::size_t{bytes[at + 2]} << 16) | (std::size_t{bytes[at + 3]} << 24);
}

/// The chunks behind a header of this release, each with its checksum; a size that goes beyond the end is cut to it.
Bytes with_right_checksums(const Bytes& bytes) {
  Bytes right;
  bytecode::append_header(right);
  for (std::size_t at = bytecode::kHeaderSize; at + bytecode::kChunkHeaderSize <= bytes.size();) {
    const std::size_t begin = at + bytecode::kChunkHeaderSize;
    const std::size_t size = std::min(size_at(bytes, at), bytes.size() - begin);
    bytecode::append_chunk(right, std::span(bytes).subspan(begin, size));
    at = begin + size;
  }
  return right;
}

void try_to_run(const Bytes& bytes) {
  auto loaded = bytecode::load(bytes);
  if (const auto* refused = std::get_if<bytecode::ObjectFileError>(&loaded)) return fuzz::check(!refused->message.empty(), "a refusal has a message");
  auto& module = std::get<bytecode::Module>(loaded);
  fuzz::check(bytecode::verify(module).empty(), "what is loaded is verified");
  compiler::Session session;
  session.adopt(module);
  fuzz::SmallMachine small({}, tool::online_compiler(session));
  small.machine().load(std::move(module));
  small.machine().command("&1 b1r");
  small.machine().command("enable plc 1");
  small.run();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const Bytes bytes(data, data + size);
  try_to_run(bytes);
  try_to_run(with_right_checksums(bytes));
  return 0;
}
