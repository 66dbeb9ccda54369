// Framing of an object file, everything little-endian:
//
//     header   magic (8 bytes)  format version (4)  vocabulary (4)
//     chunk    size of payload (4)  CRC-32 of size and payload (4)  payload: one Chunk of object_file.fbs
//     ...      the last chunk holds End; nothing follows it
//
// The magic begins with a byte above 127 and holds CR LF and LF, so that a file mangled by a text transfer is noticed.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace pmac::bytecode {

inline constexpr std::uint8_t kMagic[8] = {0x89, 'P', 'M', 'X', '\r', '\n', 0x1a, '\n'};
inline constexpr std::uint32_t kFormatVersion = 2;
inline constexpr std::size_t kHeaderSize = 16;
inline constexpr std::size_t kChunkHeaderSize = 8;
inline constexpr std::size_t kChunkEntries = 65536;          // entries of one table in one chunk, at most
inline constexpr std::size_t kChunkTextBytes = 1u << 20;     // a chunk with more text than this is closed

/// CRC-32 (IEEE 802.3, also that of ZIP archives), continued from `crc` (0 to begin).
std::uint32_t crc32(std::span<const std::uint8_t> bytes, std::uint32_t crc = 0);

/// Stands for the rows of opcode.def, function.def and element.def: numbers in a file mean the same rows only if equal.
std::uint32_t vocabulary_checksum();

void append_header(std::vector<std::uint8_t>& out);
/// What stands in front of a payload.
std::vector<std::uint8_t> chunk_header(std::span<const std::uint8_t> payload);
void append_chunk(std::vector<std::uint8_t>& out, std::span<const std::uint8_t> payload);

/// Reads the frames of an object file; never outside the bytes given.
class ChunkReader {
 public:
  explicit ChunkReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  /// Checks the header and steps over it. Returns why the file is refused, or empty.
  std::string read_header();
  /// Payload of the next chunk with its checksum verified, or nullopt and error().
  std::optional<std::span<const std::uint8_t>> next();
  bool at_end() const { return offset_ == bytes_.size(); }
  const std::string& error() const { return error_; }

 private:
  std::optional<std::span<const std::uint8_t>> refuse(const char* why);

  std::span<const std::uint8_t> bytes_;
  std::size_t offset_ = 0;
  std::string error_;
};

}  // namespace pmac::bytecode
