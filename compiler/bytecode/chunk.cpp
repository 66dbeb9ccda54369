#include "compiler/bytecode/chunk.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "compiler/bytecode/bytecode.h"
#include "compiler/bytecode/control.h"

namespace pmac::bytecode {
namespace {

constexpr std::array<std::uint32_t, 256> make_crc_table() {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t i = 0; i < 256; ++i) {
    std::uint32_t value = i;
    for (int bit = 0; bit < 8; ++bit) value = (value >> 1) ^ ((value & 1u) ? 0xedb88320u : 0u);
    table[i] = value;
  }
  return table;
}

constexpr auto kCrcTable = make_crc_table();

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
  for (const std::uint8_t byte : bytes) crc = (crc >> 8) ^ kCrcTable[(crc ^ byte) & 0xffu];
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

void append_chunk(std::vector<std::uint8_t>& out, std::span<const std::uint8_t> payload) {
  std::vector<std::uint8_t> size;
  append_u32(size, static_cast<std::uint32_t>(payload.size()));
  out.insert(out.end(), size.begin(), size.end());
  append_u32(out, crc32(payload, crc32(size)));
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
