#include "compiler/bytecode/chunk.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "compiler/bytecode/bytecode.h"
#include "compiler/bytecode/control.h"

namespace pmac::bytecode {
namespace {

using CrcTables = std::array<std::array<std::uint32_t, 256>, 8>;

/// For eight bytes a step ("slicing by 8").
constexpr CrcTables make_crc_tables() {
  CrcTables tables{};
  for (std::uint32_t i = 0; i < 256; ++i) {
    std::uint32_t value = i;
    for (int bit = 0; bit < 8; ++bit) value = (value >> 1) ^ ((value & 1u) ? 0xedb88320u : 0u);
    tables[0][i] = value;
  }
  for (std::size_t k = 1; k < 8; ++k)
    for (std::size_t i = 0; i < 256; ++i) tables[k][i] = (tables[k - 1][i] >> 8) ^ tables[0][tables[k - 1][i] & 0xffu];
  return tables;
}

constexpr CrcTables kCrcTables = make_crc_tables();

void append_u32(std::vector<std::uint8_t>& out, std::uint32_t value) {
  for (int shift = 0; shift < 32; shift += 8) out.push_back(static_cast<std::uint8_t>(value >> shift));
}

std::uint32_t read_u32(std::span<const std::uint8_t> bytes, std::size_t offset) {
  std::uint32_t value = 0;
  for (std::size_t i = 4; i-- > 0;) value = (value << 8) | bytes[offset + i];
  return value;
}

std::uint32_t add_text(std::uint32_t crc, std::string_view text) {
  return crc32({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, crc);
}

}  // namespace

std::uint32_t crc32(std::span<const std::uint8_t> bytes, std::uint32_t crc) {
  crc = ~crc;
  std::size_t i = 0;
  for (; i + 8 <= bytes.size(); i += 8) {
    const std::uint8_t* b = bytes.data() + i;
    crc = kCrcTables[7][(crc ^ b[0]) & 0xffu] ^ kCrcTables[6][((crc >> 8) ^ b[1]) & 0xffu] ^ kCrcTables[5][((crc >> 16) ^ b[2]) & 0xffu] ^
          kCrcTables[4][((crc >> 24) ^ b[3]) & 0xffu] ^ kCrcTables[3][b[4]] ^ kCrcTables[2][b[5]] ^ kCrcTables[1][b[6]] ^ kCrcTables[0][b[7]];
  }
  for (; i < bytes.size(); ++i) crc = (crc >> 8) ^ kCrcTables[0][(crc ^ bytes[i]) & 0xffu];
  return ~crc;
}

std::uint32_t vocabulary_checksum() {
  std::string text;
#define OPCODE(Name, name, format, meaning) text += #Name "/" #format ";";
#include "compiler/bytecode/opcode.def"
#undef OPCODE
#define FUNCTION(Name, name, signature, meaning) text += name "/" signature ";";
#include "compiler/bytecode/function.def"
#undef FUNCTION
#define ELEMENT(Id, name, count0, count1, count2, Type, default_value, unit, Access, Simulation, meaning) \
  text += name "/" #count0 "/" #count1 "/" #count2 ";";
#include "compiler/bytecode/element.def"
#undef ELEMENT
  for (int verb = 0; verb < static_cast<int>(ControlVerb::kCount); ++verb) {
    text += control_verb_name(static_cast<ControlVerb>(verb));
  }
  return add_text(0, text);
}

void append_header(std::vector<std::uint8_t>& out) {
  out.insert(out.end(), std::begin(kMagic), std::end(kMagic));
  append_u32(out, kFormatVersion);
  append_u32(out, vocabulary_checksum());
}

std::vector<std::uint8_t> chunk_header(std::span<const std::uint8_t> payload) {
  std::vector<std::uint8_t> header;
  append_u32(header, static_cast<std::uint32_t>(payload.size()));
  append_u32(header, crc32(payload, crc32(header)));
  return header;
}

void append_chunk(std::vector<std::uint8_t>& out, std::span<const std::uint8_t> payload) {
  const std::vector<std::uint8_t> header = chunk_header(payload);
  out.insert(out.end(), header.begin(), header.end());
  out.insert(out.end(), payload.begin(), payload.end());
}

std::string ChunkReader::read_header() {
  if (bytes_.size() < kHeaderSize || !std::equal(std::begin(kMagic), std::end(kMagic), bytes_.begin())) {
    return "not an object file";
  }
  const std::uint32_t version = read_u32(bytes_, 8);
  if (version != kFormatVersion) {
    return "object file of format version " + std::to_string(version) + "; this tool reads version " +
           std::to_string(kFormatVersion) + ", compile the program again";
  }
  if (read_u32(bytes_, 12) != vocabulary_checksum()) {
    return "object file of another release of the compiler; compile the program again";
  }
  offset_ = kHeaderSize;
  return {};
}

std::optional<std::span<const std::uint8_t>> ChunkReader::refuse(const char* why) {
  error_ = std::string("object file ") + why + " at byte " + std::to_string(offset_);
  return std::nullopt;
}

std::optional<std::span<const std::uint8_t>> ChunkReader::next() {
  if (bytes_.size() - offset_ < kChunkHeaderSize) return refuse("ends too early");
  const std::size_t size = read_u32(bytes_, offset_);
  if (size > bytes_.size() - offset_ - kChunkHeaderSize) return refuse("is truncated or damaged");
  const auto payload = bytes_.subspan(offset_ + kChunkHeaderSize, size);
  const std::uint32_t checksum = crc32(payload, crc32(bytes_.subspan(offset_, 4)));
  if (checksum != read_u32(bytes_, offset_ + 4)) return refuse("is damaged (wrong checksum)");
  offset_ += kChunkHeaderSize + size;
  return payload;
}

}  // namespace pmac::bytecode
